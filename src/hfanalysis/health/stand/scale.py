"""A factor between this test and the others of its stand: of thrust over p_c, and of impulse over propellant.

Engines of a stand change, so neither says much alone. A channel's gain against its raw signal changes too, with
amplifiers; but where the log has raw signals, a gain that differs by just the factor in question says which it is.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import exp, log, pi, sqrt

import numpy as np

from hfanalysis.health.coarse import Coarse
from hfanalysis.health.seen import SeenTest, Sister
from hfanalysis.products.health import Finding
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.signals import MAD_TO_STD
from hfanalysis.sentences import joined, text

RAW = ("voltage", "current", "dimensionless")
"""Dimensions of a raw signal that a channel in engineering units is made from."""
BETWEEN_TESTS = 0.15
"""Relative deviation of either ratio between tests of a stand [-]: throats wear and are drilled up, fires burn better
or worse. Evidence: HF2.3, 2.4 and 3.3 of the McGill stand agree within 5 %, HF3.4 is 30 % off."""
OF_THIS_ONE = 0.5
"""Part of that deviation that many other tests leave [-]: this test may itself be the one with another engine."""
OFF = log(1.5)
"""Logarithm of a factor from which on it is no other engine's but a scale's [-]. Source: a gain, a unit, a bridge."""
SURE, SURE_WITH_RAW = 3.0, 2.0
"""Deviations that a factor has to be off one [-]; fewer where a raw signal's gain differs by the same."""
SAME = 0.15
"""Relative difference within which a gain's factor is that of the ratios [-]."""
RISES = {"thrust": 50.0, "p_chamber": 1.0e5}
"""Rise in the firing [N, Pa] from which on the two are compared."""


@dataclass(frozen=True)
class Off:
    """Logarithm of a ratio of this test over that of others, its deviation, and in words."""

    value: float
    std: float
    words: str


def find(test: SeenTest) -> Iterator[Finding]:
    """Where both ratios together are off by more than tests of a stand differ."""
    if any(test.get(name) is None for name in RISES) or not test.sisters:
        return
    mine = Sister(test.definition, {name: seen.coarse for name, seen in test.channels.items()})
    found = [o for o in (_by_pressure(mine, test.sisters), _by_mass(mine, test.sisters)) if o is not None]
    if not found:
        return
    weights = np.array([1.0 / o.std**2 for o in found])
    off, std = float(weights @ [o.value for o in found] / weights.sum()), 1.0 / sqrt(float(weights.sum()))
    raw = _gain_like(test, mine, off)
    if abs(off) > max(OFF, (SURE if raw is None else SURE_WITH_RAW) * std):
        yield _finding(test, found, off, std, raw)


def _by_pressure(mine: Sister, others: tuple[Sister, ...]) -> Off | None:
    return _against(mine, others, _thrust_over_pressure, "thrust over p_c")


def _by_mass(mine: Sister, others: tuple[Sister, ...]) -> Off | None:
    return _against(mine, others, _impulse_over_mass, "impulse over propellant")


def _against(mine: Sister, others: tuple[Sister, ...], ratio, what: str) -> Off | None:  # type: ignore[no-untyped-def]
    pairs = [(a, b) for other in others for a, b in [ratio(mine, other)] if a is not None and b is not None]
    if not pairs:
        return None
    logs = np.array([log(a / b) for a, b in pairs])
    middle = float(np.median(logs))
    scatter = max(BETWEEN_TESTS, float(MAD_TO_STD * np.median(np.abs(logs - middle))))
    std = scatter / sqrt(len(logs)) + OF_THIS_ONE * BETWEEN_TESTS
    words = text(
        "{what} is {times:.3g} times that of {n} other test{s} of the stand", what=what, times=exp(middle),
        n=len(logs), s="" if len(logs) == 1 else "s",
    )  # fmt: skip
    return Off(middle, std, words)


def _thrust_over_pressure(mine: Sister, other: Sister) -> tuple[float | None, float | None]:
    """Rise of the thrust over that of p_c [m^2], over the throat's area where both state theirs."""
    areas = [_throat(s.definition) for s in (mine, other)]
    a, b = (_rises(s.channels) for s in (mine, other))
    if a is None or b is None:
        return None, None
    scale = areas if None not in areas else [1.0, 1.0]
    return a[0] / a[1] / (scale[0] or 1.0), b[0] / b[1] / (scale[1] or 1.0)


def _impulse_over_mass(mine: Sister, other: Sister) -> tuple[float | None, float | None]:
    """Mean rise of the thrust times how long the chamber is live, over what was loaded [m/s]; of fires only."""
    return _specific(mine), _specific(other)


def _specific(test: Sister) -> float | None:
    tank, grain, rises = test.definition.tank, test.definition.grain, _rises(test.channels)
    live = test.channels["p_chamber"].live if "p_chamber" in test.channels else None
    if test.definition.test.kind != "hot_fire" or rises is None or live is None:
        return None
    if tank is None or tank.oxidizer_mass is None:
        return None
    mass = tank.oxidizer_mass.value + (grain.mass.value if grain is not None and grain.mass is not None else 0.0)
    return rises[0] * (live[1] - live[0]) / mass


def _throat(definition: TestDefinition) -> float | None:
    radius = definition.nozzle.throat_radius if definition.nozzle else None
    return pi * radius.value**2 if radius is not None else None


def _rises(channels: Mapping[str, Coarse]) -> tuple[float, float] | None:
    found = [channels[n].rise if n in channels else None for n in RISES]
    moved = [r for r, least in zip(found, RISES.values(), strict=True) if r is not None and r > least]
    return (moved[0], moved[1]) if len(moved) == 2 else None


def _gain_like(test: SeenTest, mine: Sister, off: float) -> tuple[str, float, str] | None:
    """Channel, factor of its gain against a raw signal, and the sister whose gain differs by about what is off."""
    raws = [n for n in mine.channels if test.channels[n].dimension in RAW and n != "valve"]
    for name in RISES:
        sign = 1.0 if name == "thrust" else -1.0
        for raw in (r for r in raws if _follows(test, name, r)):
            for sister in test.sisters:
                here, there = _gain(mine.channels, name, raw), _gain(sister.channels, name, raw)
                if here and there and abs(log(here / there) - sign * off) < abs(off) * SAME + SAME:
                    return name, here / there, sister.name
    return None


def _follows(test: SeenTest, name: str, raw: str) -> bool:
    """Whether a channel is a straight line in a raw signal, sample by sample."""
    a, b = test.channels[name], test.channels[raw]
    if len(a.said) != len(b.said):
        return False
    good = a.channel.good & b.channel.good
    x, y = b.said[good], a.said[good]
    if len(x) < 20 or np.ptp(x) == 0.0 or np.ptp(y) == 0.0:
        return False
    return float(np.corrcoef(x, y)[0, 1] ** 2) > 0.9999


def _gain(channels: Mapping[str, Coarse], name: str, raw: str) -> float | None:
    if name not in channels or raw not in channels:
        return None
    size, of = (channels[n].peak - channels[n].trough for n in (name, raw))
    return size / of if size > 0.0 and of > 0.0 else None


def _finding(test: SeenTest, found: list[Off], off: float, std: float, raw: tuple[str, float, str] | None) -> Finding:
    channels = (raw[0],) if raw else _blamed(test, found)
    alone = channels[0] if len(channels) == 1 else None
    factor = 1.0 / raw[1] if raw else exp(off if alone == "p_chamber" else -off)
    words = [o.words for o in found]
    if raw:
        words.append(f"its gain against its raw signal is {raw[1]:.4g} times that of {raw[2]}")
    error = "" if raw else f" +/- {100.0 * std:.0f} %"
    spec = test.channels[channels[0]].spec
    return Finding(
        kind="scale", verdict="suspect", channels=channels, evidence=joined("; ", words),
        means=text(
            "another scale than theirs: {who} would have to be multiplied by {factor:.4g}{error}",
            who=alone or "thrust", factor=factor, error=error,
        ),
        cure=f"scale = {spec.scale * factor:.4g}" if alone else None, gain=abs(factor - 1.0),
    )  # fmt: skip


def _blamed(test: SeenTest, found: list[Off]) -> tuple[str, ...]:
    """The channel that other ties point to already; the thrust where both ratios are off alike; else both."""
    for finding in test.found:
        if finding.kind in ("scale", "unit") and len(finding.channels) == 1 and finding.channels[0] in RISES:
            return finding.channels
    alike = len(found) == 2 and all(abs(o.value) > 0.7 * OFF for o in found) and found[0].value * found[1].value > 0.0
    return ("thrust",) if alike else tuple(RISES)
