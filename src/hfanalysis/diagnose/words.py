"""A localisation in words an engineer can act on."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_SITES = {
    "tank_heat": ("the tank receives {size} that the model lacks", "W", 1.0),
    "nitrogen_inflow": ("{size} of nitrogen enter the tank that the model lacks", "g/s", 1e3),
    "tank_leak": ("{size} leave the tank by another way than the injector", "g/s", 1e3),
    "tank_pressure": ("the tank's pressure differs by {size} from that of its bulk in equilibrium", "bar", 1e-5),
    "injector_factor": ("the injector passes {size} more than its equation says", "%", 100.0),
    "feed_loss": ("the feed line loses {size} more than its law says", "bar", 1e-5),
    "regression_factor": ("the fuel regresses {size} faster than a G^n", "%", 100.0),
    "temperature_factor": ("the gas is worth {size} more in R T (twice that of c*) than equilibrium says", "%", 100.0),
    "throat_factor": ("the throat is {size} larger than stated", "%", 100.0),
    "thrust_factor": ("the nozzle gives {size} more thrust than its equations say", "%", 100.0),
}
"""What a source at a site means, the unit in which people read it, and the factor to it from SI."""


def sentence(place: Mapping[str, Any]) -> str:
    """One localisation as a sentence."""
    source = place["source"]
    start, end = place["t_start"]["value"], place["t_end"]["value"]
    text, unit, factor = _meaning(place["site"], source["unit"])
    size = f"{factor * source['value']:.3g} ± {factor * (source['std'] or 0.0):.2g} {unit}"
    when = f"From {start:.1f} to {end:.1f} s (mostly {place['phase']})"
    return f"{when} {text.format(size=size)} [{place['equation']}; ln evidence {place['significance']:.0f}]."


def _meaning(site: str, unit: str) -> tuple[str, str, float]:
    if site in _SITES:
        return _SITES[site]
    shown, factor = ("bar", 1e-5) if unit == "Pa" else (unit, 1.0)
    return f"{site.replace('offset of ', '')} reads {{size}} more than the model can explain", shown, factor


def gap_line(channel: str, gap: Mapping[str, Mapping[str, float]]) -> str:
    """Residual of a channel without and with the sources, and its noise."""
    factor, unit = (1.0, "N") if channel == "thrust" else (1e-5, "bar")
    before, after, noise = (factor * gap[key][channel] for key in ("before", "after", "noise"))
    return f"{channel}: rms {before:.3g} {unit} without, {after:.3g} {unit} with it; noise {noise:.2g} {unit}"
