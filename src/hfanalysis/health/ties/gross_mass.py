"""A tank's cell that weighs more than the oxidizer, or loses another mass than what was loaded."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hfanalysis.health.firing import usable
from hfanalysis.health.seen import Seen, SeenTest
from hfanalysis.health.words import level
from hfanalysis.products.health import Finding
from hfanalysis.sentences import said, text
from hfanalysis.thermo.nitrous import saturation

SURE = 4.0
"""Deviations by which the masses have to differ [-]."""
STATED = 0.05
"""Relative deviation of a stated load whose error is not stated [-]. Source: filled by scale or by time."""
COLDER = 20.0
"""[K] by which the liquid may be colder than its pressure says, so that more of it fits. Evidence: docs of real logs:
bulk liquid 10 to 15 K below the warm layer at the gauge."""
VAPOR = 1.5
"""Times the saturated vapor's density that what is left in a tank may have, nitrogen and mist included [-]."""
DRAINED = 0.65
"""Part of its pressure at rest below which a tank's liquid is gone [-]: saturated liquid alone does not fall so far in
the time of a firing. Source: a full tank of 20 degC runs dry at 60 % of its pressure (report, HF5)."""


@dataclass(frozen=True)
class Weighed:
    """What the cell says before and after the firing, and its error [kg]; what is left in the tank at most [kg]."""

    before: float
    after: float
    error: float
    left: float


def find(test: SeenTest) -> Iterator[Finding]:
    """The cell against the stated load and against what the tank can hold."""
    cell, tank = test.get("m_tank"), test.get("p_tank")
    if cell is None or test.fire is None or any(f.kind in ("sign", "unit") for f in _of_cell(test)):
        return
    weighed = _weighed(test, cell, tank)
    if weighed is None:
        return
    dry = _dry(test, cell, weighed)
    if dry is not None:
        yield dry
    elif (other := _other_load(test, cell, weighed)) is not None:
        yield other


def _of_cell(test: SeenTest) -> list[Finding]:
    return [f for f in test.found if "m_tank" in f.channels]


def _weighed(test: SeenTest, cell: Seen, tank: Seen | None) -> Weighed | None:
    assert test.fire is not None
    rest, trace = cell.coarse.rest, usable(test, cell)
    end = float(trace.time[-1]) if len(trace.time) else -np.inf
    last = trace.between(max(end - 1.0, test.fire[0] + 0.9 * (test.fire[1] - test.fire[0])), end).values
    if rest is None or len(last) < 3 or tank is None or not _drained(test, tank):
        return None
    error = float(np.hypot(cell.channel.accuracy, 2.0 * np.std(last) / np.sqrt(len(last))))
    return Weighed(rest.value, float(np.median(last)), error, _left(test, tank))


def _drained(test: SeenTest, tank: Seen) -> bool:
    rest, last = tank.coarse.rest, tank.coarse.last
    return rest is not None and last is not None and 0.0 < last.value < DRAINED * rest.value


def _left(test: SeenTest, tank: Seen) -> float:
    """Vapor and gas that may still be in the tank [kg]; none where its volume is not stated."""
    volume = test.definition.tank.volume if test.definition.tank else None
    if volume is None or tank.coarse.last is None:
        return 0.0
    nitrous = saturation()
    pressure = max(tank.coarse.last.value, nitrous.pressure_range[0])
    warmth = float(nitrous.temperature(min(pressure, nitrous.pressure_range[1])))
    share = tank.coarse.last.value / pressure
    return VAPOR * share * volume.value * float(nitrous.vapor_density(warmth))


def _most(test: SeenTest) -> float | None:
    """The most that the tank holds [kg], liquid colder than its pressure says."""
    tank, seen = test.definition.tank, test.get("p_tank")
    if tank is None or tank.volume is None or seen is None or seen.coarse.rest is None:
        return None
    nitrous = saturation()
    low, high = nitrous.pressure_range
    warmth = float(nitrous.temperature(min(max(seen.coarse.rest.value, low), high))) - COLDER
    return float(tank.volume.value * nitrous.liquid_density(max(warmth, nitrous.t_min)))


def _stated(test: SeenTest) -> tuple[float, float] | None:
    """The stated load and its deviation [kg]."""
    mass = test.definition.tank.oxidizer_mass if test.definition.tank else None
    if mass is None:
        return None
    return mass.value, mass.std if mass.std is not None else STATED * mass.value


def _dry(test: SeenTest, cell: Seen, w: Weighed) -> Finding | None:
    """More than can be there before, and about as much too much after."""
    most, stated = _most(test), _stated(test)
    limit = min(x for x in (most, stated[0] + SURE * stated[1] if stated else None, np.inf) if x is not None)
    over = w.before - (stated[0] if stated else limit)
    if w.before < limit + SURE * w.error or w.after < w.left + SURE * w.error or not np.isfinite(limit):
        return None
    dry = w.after if stated is None else over
    words = "weighs {before} before the firing and {after} after it, where {what}"
    what = (
        text("{mass} of oxidizer were loaded", mass=said(stated[0], "kg", ".3g")) if stated
        else text("the tank holds {most} at most", most=said(limit, "kg", ".3g"))
    )  # fmt: skip
    evidence = text(words, before=level(w.before, "mass"), after=level(w.after, "mass"), what=what)
    words = "reads {dry} of tank and fittings too: what it loses is right, what it weighs is not"
    means = text(words, dry=said(dry, "kg", ".3g"))
    scale, _ = cell.spec.factor
    cure = f"offset = {cell.spec.offset - dry / scale * cell.spec.scale:.4g}"
    return cell.finding("gross_mass", "suspect", evidence=evidence, means=means, cure=cure, bias=dry)


def _other_load(test: SeenTest, cell: Seen, w: Weighed) -> Finding | None:
    """What it loses against what was loaded."""
    stated, most = _stated(test), _most(test)
    lost = w.before - w.after
    if stated is not None:
        error = SURE * float(np.hypot(w.error, stated[1]))
        if stated[0] - w.left - error <= lost <= stated[0] + error:
            return None
        words = "loses {lost} in the firing, of {load} that were loaded; {left} at most may be left as vapor"
        load = stated[0]
    elif most is not None and lost > most + SURE * w.error:
        words, load = "loses {lost} in the firing, and the tank holds {load} at most", most
    else:
        return None
    evidence = text(
        words, lost=level(lost, "mass"), load=said(load, "kg", ".3g"), left=said(w.left, "kg", ".2g")
    )  # fmt: skip
    means = "the cell bears only a part of the tank or is held by its lines, its scale is off, or the stated load is"
    off = abs(load - lost)
    return cell.finding("gross_mass", "suspect", evidence=evidence, means=means, cure=None, bias=off)
