"""What kind of run a log holds: a hot fire, a cold flow, a water flow, or a firing that did not light."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from hfanalysis.record.signals import Signal
from hfanalysis.segment.sanity import IN_TANKS
from hfanalysis.sentences import said, text

COLDEST_FIRE = 700.0
"""Apparent c* [m/s] below which nothing burns: cold nitrous oxide gives 250 to 400, poor combustion 1000 and more. The
same holds of thrust over flow. Source: c* = sqrt(R T / W) / Gamma(gamma) of nitrous oxide gas is 273 to 359 m/s at 180
to 300 K (CoolProp), and C_F of a cold jet at most 1.7."""

BRIEFEST_FIRE = 1.0
"""Seconds that a fire lasts at least whose fuel is gone early in the liquid phase; an igniter is out before. Evidence:
test_events.py: a fire that is out early in the liquid phase is one, an igniter is none."""

COLD_PRESSURE_SHARE = 0.18
"""Chamber over run-line pressure, above ambient, below which the flow is cold, where the geometry is unknown."""

THRUST_COEFFICIENT = 1.4
"""F / (p_c A_t) [-] that turns a thrust into the chamber pressure it needs. Source: 1.2 to 1.6 for nozzles of area
ratio 2 to 6 at 10 to 40 bar."""

SILENT = 0.1e5
"""[Pa] A chamber that moves by less than this while the thrust responds does not see the flow: the gauge is dead, or no
pressure builds up."""

FELT = 8.0
"""Standard deviations of its mean by which a thrust has to stand above its rest to speak for a fire."""

FIRE, COLD, WATER = "hot_fire", "cold_flow", "water_flow"


@dataclass(frozen=True)
class Kind:
    """``name``: hot_fire, cold_flow or water_flow; ``why``: from which figure; ``misfire``: stated as a fire, but did
    not light; ``warning``: where the evidence does not agree."""

    name: str
    why: str
    misfire: bool = False
    warning: str = ""


@dataclass(frozen=True)
class Known:
    """What is known to judge by: ``ambient`` [Pa] as the chamber reads it, the oxidizer's mean ``flow`` [kg/s] where
    mass and times give it, ``throat_area`` [m^2]."""

    ambient: float
    flow: float | None
    throat_area: float | None


Verdict = tuple[bool, str]
"""Whether it burns, and from which figure."""


def recognize(signals: Mapping[str, Signal], stated: str, span: tuple[float, float], known: Known) -> Kind:
    """Decide from chamber, thrust and statement over the liquid phase ``span`` [s].

    Each gauge has a say where it responds at all; where the two contradict each other, the statement decides.
    """
    if stated == WATER:
        return Kind(WATER, "as stated")
    chamber, thrust = _by_chamber(signals, span, known), _by_thrust(signals, span, known)
    if chamber is None and thrust is None:
        if (why := _no_nitrous(signals, span)) is not None:
            return Kind(WATER, why)
        return Kind(stated, _why_stated(signals, span))
    if chamber is None or thrust is None or chamber[0] == thrust[0]:
        burning, why = chamber or thrust or (False, "")
        warning = ""
    else:
        burning = stated == FIRE
        why = f"as stated: {chamber[1]}, but {thrust[1]}"
        warning = f"chamber and thrust disagree whether it burns: {chamber[1]}; {thrust[1]}"
    if not burning and (water := _no_nitrous(signals, span)) is not None:
        return Kind(WATER, water)
    return Kind(FIRE if burning else COLD, why, misfire=not burning and stated == FIRE, warning=warning)


def _why_stated(signals: Mapping[str, Signal], span: tuple[float, float]) -> str:
    if "p_chamber" not in signals:
        return "as stated: the log has no chamber pressure to tell by"
    if not np.isfinite(signals["p_chamber"].mean(*_later(span))):
        return "as stated: no good samples of the chamber pressure in the liquid phase"
    return "as stated: the chamber pressure does not move while the thrust does"


def _no_nitrous(signals: Mapping[str, Signal], span: tuple[float, float]) -> str | None:
    """Why what flows is not nitrous oxide: line and tank stand far below the pressure that it has in any tank."""
    pressures = {n: signals[n].mean(*_later(span)) for n in ("p_run", "p_tank") if n in signals}
    found = {name: value for name, value in pressures.items() if np.isfinite(value)}
    if not found or max(found.values()) > IN_TANKS[0]:
        return None
    name, value = max(found.items(), key=lambda item: item[1])
    return text(
        "{name} stands at {value} while it flows, where a tank of nitrous oxide has {least:.0f} bar or more: water",
        name=name,
        value=said(value, "bar", ".1f"),
        least=IN_TANKS[0] / 1e5,
    )


def _by_chamber(signals: Mapping[str, Signal], span: tuple[float, float], known: Known) -> Verdict | None:
    """What the chamber's pressure says; None where there is none or it does not respond though the thrust does.

    The last three fifths of the phase count, or where nothing burns there its fiercest second: fuel may be gone first.
    """
    if "p_chamber" not in signals:
        return None
    chamber, ambient = signals["p_chamber"], known.ambient

    def judged(start: float, end: float) -> Verdict:
        excess = chamber.mean(start, end) - ambient
        if known.flow is not None and known.throat_area is not None:
            return _by_velocity(excess + ambient, known.flow, known.throat_area, excess > 0.9 * ambient)
        if "p_run" in signals:
            return _by_share(excess, signals["p_run"].mean(start, end) - ambient, "chamber")
        return excess > ambient, text("the chamber stands {excess} above ambient", excess=said(excess, "bar", ".1f"))

    if not np.isfinite(chamber.mean(*_later(span))):
        return None
    if "thrust" in signals and _felt(signals["thrust"], span) and abs(chamber.mean(*span) - ambient) < SILENT:
        return None
    return _somewhere(judged, chamber, span)


def _by_thrust(signals: Mapping[str, Signal], span: tuple[float, float], known: Known) -> Verdict | None:
    """What the thrust says, where it responds and the flow, or throat and run line, are known to set it against."""
    if "thrust" not in signals or not _felt(signals["thrust"], span):
        return None
    thrust, rest = signals["thrust"], _rest(signals["thrust"])
    if known.flow is None and (known.throat_area is None or "p_run" not in signals):
        return None

    def judged(start: float, end: float) -> Verdict:
        force = thrust.mean(start, end) - rest
        if known.flow is not None:
            velocity = force / known.flow
            side = "above" if velocity > COLDEST_FIRE else "below"
            of_fire = f"{side} the {COLDEST_FIRE:.0f} m/s of any fire"
            return velocity > COLDEST_FIRE, (
                f"thrust over flow of {velocity:.0f} m/s at {known.flow:.2f} kg/s, {of_fire}"
            )
        needed = force / (THRUST_COEFFICIENT * (known.throat_area or np.inf))
        return _by_share(
            needed, signals["p_run"].mean(start, end) - known.ambient, "the pressure that the thrust needs"
        )

    return _somewhere(judged, thrust, span) if np.isfinite(thrust.mean(*_later(span))) else None


def _later(span: tuple[float, float]) -> tuple[float, float]:
    return span[0] + 0.4 * (span[1] - span[0]), span[1]


def _rest(signal: Signal) -> float:
    quiet = signal.between(-3.0, -0.05).value
    return float(np.median(quiet)) if quiet.size else 0.0


def _felt(thrust: Signal, span: tuple[float, float]) -> bool:
    """Whether the thrust stands clear of its rest over the phase, by its noise and by what is no shaking."""
    part = thrust.between(*span)
    if part.value.size < 4:
        return False
    error = max(thrust.noise, float(part.value.std())) / np.sqrt(part.value.size)
    return bool(float(part.value.mean()) - _rest(thrust) > FELT * error)


def _somewhere(judged: Callable[[float, float], Verdict], signal: Signal, span: tuple[float, float]) -> Verdict:
    burning, why = judged(*_later(span))
    if burning or (brief := _fiercest(signal, span)) is None:
        return burning, why
    burning, of_brief = judged(*brief)
    if burning:
        return True, f"{of_brief}, from {brief[0] - span[0]:.1f} to {brief[1] - span[0]:.1f} s"
    return False, why


def _fiercest(chamber: Signal, span: tuple[float, float]) -> tuple[float, float] | None:
    """Of the stretch of BRIEFEST_FIRE in which the chamber's pressure is held highest, the weaker half; None where the
    span holds none."""
    half = 0.5 * BRIEFEST_FIRE
    begins = np.arange(span[0], span[1] - BRIEFEST_FIRE, 0.2 * half)
    means = np.array([[chamber.mean(t, t + half), chamber.mean(t + half, t + 2.0 * half)] for t in begins])
    held = means.min(axis=1, initial=np.inf) if begins.size else np.empty(0)
    if not np.isfinite(held).any():
        return None
    best = int(np.nanargmax(held))
    begin = float(begins[best]) + half * float(np.argmin(means[best]))
    return begin, begin + half


def _by_velocity(pressure: float, flow: float, throat_area: float, choked: bool) -> Verdict:
    velocity = pressure * throat_area / flow
    side = "above" if velocity > COLDEST_FIRE else "below"
    why = f"apparent c* of {velocity:.0f} m/s at {flow:.2f} kg/s, {side} the {COLDEST_FIRE:.0f} m/s of any fire"
    return velocity > COLDEST_FIRE and choked, why


def _by_share(excess: float, run: float, what: str) -> Verdict:
    share = excess / run if run > 0.0 else 0.0
    side = "above" if share > COLD_PRESSURE_SHARE else "below"
    return (
        share > COLD_PRESSURE_SHARE,
        f"{what} at {100 * share:.0f} % of the run-line pressure, {side} {100 * COLD_PRESSURE_SHARE:.0f} %",
    )
