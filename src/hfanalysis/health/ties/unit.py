"""Units mistaken for others, by what is known at rest: the air, a tank of nitrous oxide, a load."""

from __future__ import annotations

from collections.abc import Iterator

from hfanalysis.health.factors import Factor, unit_for
from hfanalysis.health.firing import OPEN_TO_AIR
from hfanalysis.health.seen import Seen, SeenTest
from hfanalysis.health.words import level
from hfanalysis.products.health import Finding
from hfanalysis.sentences import text
from hfanalysis.thermo.nitrous import saturation

IN_TANKS = (8e5, 130e5)
"""Pressure [Pa] of any tank of nitrous oxide at rest, supercharged or not. Source: it saturates at 8 to 72 bar from -45
to 36 degC (CoolProp); above, a tank is supercharged."""
USUAL = (15e5, 90e5)
"""Pressure [Pa] that most of them have: a unit has to bring a tank there. Source: -25 degC, to supercharged."""
AIR = 0.25
"""Relative difference from ambient within which a gauge in another unit reads the air [-]: zeros are off, too."""
WARMEST = 318.0
"""[K] of a tank at rest that somebody fills. Source: 45 degC, above nitrous oxide's critical point (36.4 degC)."""
NEAR_SATURATION = 20.0
"""[K] from the temperature that belongs to its pressure within which a tank is in the other unit. Source: warm layers,
bulk liquid and walls differ by 15 K."""
LOAD = 0.12
"""Relative difference within which a cell in another unit weighs what was loaded [-]."""


def find(test: SeenTest) -> Iterator[Finding]:
    """Tank and what shares its unit, gauges in the air, the tank's temperature, the tank's cell."""
    tank = _tank(test)
    if tank is not None:
        yield tank
    for name in OPEN_TO_AIR:
        seen = test.get(name)
        if seen is not None and (found := _air(test, seen, tank)) is not None:
            yield found
    for find_one in (_temperature, _load):
        if (found := find_one(test)) is not None:
            yield found


def _tank(test: SeenTest) -> Finding | None:
    """A tank at a pressure that none has, which another unit explains; a water flow may be fed at any pressure."""
    seen = test.get("p_tank")
    if seen is None or seen.coarse.rest is None or test.fire is None or seen.coarse.rest.value <= 0.0:
        return None
    rest = seen.coarse.rest.value
    if IN_TANKS[0] <= rest <= IN_TANKS[1] or not (test.definition.test.kind == "hot_fire" or _below_its_line(test)):
        return None
    unit = unit_for(Factor(USUAL[0] / rest, USUAL[1] / rest), seen.spec.unit, "pressure")
    if unit is None:
        return None
    evidence = text(
        "stands at {rest} before the firing, where a tank of nitrous oxide has {low} to {high}",
        rest=level(rest, "pressure"), low=level(IN_TANKS[0], "pressure"), high=level(IN_TANKS[1], "pressure"),
    )  # fmt: skip
    return _unit(seen, evidence, unit)


def _below_its_line(test: SeenTest) -> bool:
    run, tank = test.get("p_run"), test.get("p_tank")
    return run is not None and tank is not None and run.coarse.peak > 1.5 * tank.coarse.peak


def _air(test: SeenTest, seen: Seen, tank: Finding | None) -> Finding | None:
    """A gauge that reads the air in another unit: far above ambient by its own, or like the tank's."""
    rest = seen.coarse.rest
    if rest is None or rest.value <= 0.0 or seen.channel.zero_std is not None:
        return None
    # below ambient a zero that is off looks the same: only in the unit that the tank is in already
    over = rest.value > 4.0 * test.ambient
    alike = tank is not None and seen.spec.unit == test.channels["p_tank"].spec.unit
    if not (over or alike):
        return None
    factor = test.ambient / rest.value
    unit = unit_for(Factor(factor * (1.0 - AIR), factor * (1.0 + AIR)), seen.spec.unit, "pressure")
    if unit is None or (over and seen.name == "p_run" and _holds_pressure(test, seen)):
        return None
    words = "reads {rest} at rest, open to the air, which has {ambient}"
    evidence = text(words, rest=level(rest.value, "pressure"), ambient=level(test.ambient, "pressure"))
    return _unit(seen, evidence, unit)


def _holds_pressure(test: SeenTest, run: Seen) -> bool:
    """A line that may be filled up to its valve: as high as its tank."""
    tank = test.get("p_tank")
    return tank is None or tank.coarse.rest is None or run.coarse.peak < 1.5 * tank.coarse.peak


def _temperature(test: SeenTest) -> Finding | None:
    seen, tank = test.get("T_tank"), test.get("p_tank")
    if seen is None or tank is None or seen.coarse.rest is None or tank.coarse.rest is None:
        return None
    rest, nitrous = seen.coarse.rest.value, saturation()
    if rest < WARMEST or not nitrous.pressure_range[0] < tank.coarse.rest.value < nitrous.pressure_range[1]:
        return None
    warmth = float(nitrous.temperature(tank.coarse.rest.value))
    logged = (rest - 273.15) if seen.spec.unit == "degC" else rest
    as_others = {"degF": (logged + 459.67) * 5.0 / 9.0, "K": logged}
    unit = next((u for u, t in as_others.items() if abs(t - warmth) < NEAR_SATURATION and u != seen.spec.unit), None)
    if unit is None:
        return None
    evidence = text(
        "reads {rest} at rest, where nitrous oxide at its pressure has {warmth}", rest=level(rest, "temperature"),
        warmth=level(warmth, "temperature"),
    )  # fmt: skip
    return _unit(seen, evidence, unit)


def _load(test: SeenTest) -> Finding | None:
    """A cell that weighs, and loses, the stated load in another unit."""
    cell, tank = test.get("m_tank"), test.definition.tank
    if cell is None or tank is None or tank.oxidizer_mass is None or cell.coarse.rest is None or test.fire is None:
        return None
    load, rest, last = tank.oxidizer_mass.value, cell.coarse.rest.value, cell.coarse.last
    if rest <= 0.0 or abs(rest / load - 1.0) < 4.0 * LOAD or last is None or last.value > 0.5 * rest:
        return None
    factor = load / rest
    unit = unit_for(Factor(factor * (1.0 - LOAD), factor * (1.0 + LOAD)), cell.spec.unit, "mass", least=1.5)
    if unit is None:
        return None
    words = "weighs {rest} before the firing and {last} after it, where {load} were loaded"
    evidence = text(
        words, rest=level(rest, "mass"), last=level(last.value, "mass"), load=level(load, "mass")
    )  # fmt: skip
    return _unit(cell, evidence, unit)


def _unit(seen: Seen, evidence: str, unit: str) -> Finding:
    scale = seen.spec.scale
    means = f"the log seems to be in {unit}, not in {seen.spec.unit}: every reading is off by that factor"
    cure = f'unit = "{unit}"' + ("" if scale == 1.0 else "\nscale = 1.0")
    return seen.finding("unit", "unusable", evidence=evidence, means=means, cure=cure)
