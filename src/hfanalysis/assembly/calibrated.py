"""The calibrated engine of a test: what test.toml states and the calibration found, as the unsteady model takes it.

The engine stands at the site and does not fly. Its feed line loses K_loss mdot^2 / rho under either conventions: the
report's constant losses by phase stop the flow before the fuel is gone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from math import pi

import numpy as np

from hfanalysis.assembly.burnt_gas import combustion_of
from hfanalysis.engine.effect import Active
from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.engine.unsteady import Engine, burn
from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import FuelLaw, TankConstants
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.sections import fuel_of
from hfanalysis.roots import root_between
from hfanalysis.sentences import said, text
from hfanalysis.thermo.combustion import FORMATION_OFFSET, PROPEP_OXIDIZER_ENTHALPY
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.thermo.saturation import Property, Saturation

ASSUMED_EXPONENT = (1.15, 0.1)
"""Polytropic exponent of the vapor and its standard deviation [-] where a test does not tell. Evidence: the middle of
what a calibration takes as physical, 1.0 to 1.3 (docs/calibration.md)."""


WITHIN = 1e-4
"""To what a tank's temperature at the start is found [K]: 10 Pa of its pressure. Source: by choice."""

SOON = 6
"""Steps by secants after which it is looked for otherwise. Evidence: near it, three do."""

COLDER = 15.0
"""By how much an effect may let a bulk be colder than its tank's pressure says [K]."""


@dataclass(frozen=True)
class Regression:
    """r = a G^n: ``a`` [m/s (kg/m^2/s)^-n], ``n`` [-]."""

    a: float
    n: float

    @classmethod
    def of(cls, calibration: FuelLaw) -> Regression:
        """As calibration.json has it. Raises AbsentError where it has none."""
        a, n = calibration.a, calibration.n
        if a.value is None or n.value is None:
            raise AbsentError(f"a and n are missing ({a.reason or n.reason})")
        return cls(a.value, n.value)


def engine_of_test(
    definition: TestDefinition,
    calibration: TankConstants,
    temperature: float,
    law: Regression,
    effects: Sequence[Active] = (),
) -> Engine:
    """The engine with its tank at ``temperature`` [K] and the adopted ``effects``.

    Raises AbsentError naming all that test.toml does not state, or
    what the calibration lacks.
    """
    stated = _stated(definition)
    source = saturation(definition.model.properties)
    return Engine(
        saturation=source,
        combustion=combustion_of(fuel_of(definition.fuel)),
        feed=FeedSystem(stated["volume"], effective_area(definition, calibration), loss_factor(calibration)),
        oxidizer_mass=loaded_mass(definition, calibration),
        temperature=temperature,
        polytropic_exponent=exponent(calibration)[0],
        fuel_mass=stated["mass"],
        grain_length=stated["length"],
        outer_radius=stated["outer_radius"],
        fuel_density=stated["density"],
        a=law.a,
        n=law.n,
        dead_volume=stated["pre_volume"] + stated["post_volume"],
        throat_area=pi * stated["throat_radius"] ** 2,
        exit_area=pi * stated["exit_radius"] ** 2,
        ambient_pressure=definition.ambient_pressure.value,
        oxidizer_enthalpy=oxidizer_enthalpy(definition, source, temperature),
        effects=tuple(effects),
    )


NEEDED = {
    "tank": ("volume",),
    "injector": ("area",),
    "grain": ("mass", "length", "density", "outer_radius"),
    "chamber": ("pre_volume", "post_volume"),
    "nozzle": ("throat_radius", "exit_radius"),
}
"""What test.toml has to state for an engine, by section."""


def _stated(definition: TestDefinition) -> dict[str, float]:
    """The values of NEEDED [SI]; raises AbsentError naming all that are missing."""
    found = {k: getattr(getattr(definition, section), k, None) for section, keys in NEEDED.items() for k in keys}
    missing = [f"[{s}] {k}" for s, keys in NEEDED.items() for k in keys if found[k] is None]
    if missing:
        names = ", ".join(missing).replace("[injector] area", "[injector] holes and hole_area")
        raise AbsentError(f"test {definition.test.id}: no engine model to run: test.toml does not state {names}")
    return {k: float(value.value) for k, value in found.items() if value is not None}


def effective_area(definition: TestDefinition, calibration: TankConstants) -> float:
    """C_i N_i A_i [m^2]. Raises AbsentError where C_i or the holes cannot be had, or C_i is not positive."""
    discharge = calibration.C_i
    if discharge.value is None:
        raise AbsentError(f"test {definition.test.id}: no tank model to run: C_i is missing ({discharge.reason})")
    if discharge.value <= 0.0:
        raise AbsentError(f"test {definition.test.id}: no tank model to run: C_i is not positive ({discharge.why})")
    if definition.injector is None or definition.injector.area is None:
        raise AbsentError(f"test {definition.test.id}: no tank model to run: [injector] does not state its holes")
    return discharge.value * definition.injector.area.value


def loss_factor(calibration: TankConstants) -> float:
    """K_loss [1/m^4]; none where it is not known or negative."""
    return max(calibration.K_loss.value or 0.0, 0.0)


def loaded_mass(definition: TestDefinition, calibration: TankConstants) -> float:
    """The oxidizer that the calibration worked with [kg]. Raises AbsentError where it has none."""
    found = calibration.load
    if found.value is None:
        raise AbsentError(f"test {definition.test.id}: the loaded oxidizer is not known ({found.reason})")
    return found.value


def exponent(calibration: TankConstants) -> tuple[float, float]:
    """The vapor's polytropic exponent [-] with its standard deviation: as calibrated, else ASSUMED_EXPONENT."""
    found = calibration.m
    return ASSUMED_EXPONENT if found.value is None else (found.value, found.std or 0.0)


def oxidizer_enthalpy(definition: TestDefinition, source: Saturation, temperature: float) -> float:
    """Of the oxidizer entering the chamber [J/kg]: PROPEP's (report), or the saturated liquid's at its ``temperature``
    [K]."""
    if definition.model.conventions == "report":
        return PROPEP_OXIDIZER_ENTHALPY
    return FORMATION_OFFSET + float(source.energy(Property.LIQUID_ENTHALPY, temperature)[0])


def starting_for(engine: Engine, instant: float, pressure: float) -> Engine:
    """The engine with the tank temperature [K] from which its tank has ``pressure`` [Pa] at ``instant`` [s] after
    ignition.

    The report's extrapolation of phase 2 to the opening (section 4.4). Raises AbsentError where no saturated tank
    with this load does.
    """
    coldest = float(engine.saturation.temperature(pressure))
    low, high = _possible(engine, coldest - (COLDER if engine.effects else 0.0))

    @cache
    def miss(temperature: float) -> float:
        return pressure_at(replace(engine, temperature=temperature), instant) - pressure

    near = min(max(engine.temperature, low), high)
    with suppress(ValueError, AbsentError, RuntimeError):  # a step may lead to a tank that cannot be, or nowhere
        second = near - miss(near) / float(engine.saturation.pressure_slope(near))
        found = _by_secants(miss, near, second)
        if found is not None and low < found < high:
            return replace(engine, temperature=found)
    if not low < high or not miss(low) <= 0.0 <= miss(high):
        raise AbsentError(
            text(
                "no saturated tank of {mass:.2f} kg in {volume:.1f} L comes down to {pressure} at {instant:.2f} s",
                mass=engine.oxidizer_mass,
                volume=engine.feed.volume * 1e3,
                pressure=said(pressure, "bar", ".1f"),
                instant=instant,
            )
        )
    return replace(engine, temperature=root_between(lambda warm, _: miss(warm))(None, low, high, WITHIN))


def _by_secants(miss: Callable[[float], float], first: float, second: float) -> float | None:
    """Where ``miss`` is zero, from two guesses [K]; None where that does not come to an end SOON."""
    at_first, at_second = miss(first), miss(second)
    for _ in range(SOON):
        if at_second == at_first:
            return second if at_second == 0.0 else None
        third = second - at_second * (second - first) / (at_second - at_first)
        if abs(third - second) < WITHIN:
            return third
        first, at_first, second, at_second = second, at_second, third, miss(third)
    return None


def pressure_at(engine: Engine, instant: float) -> float:
    """Modeled tank pressure [Pa] at an ``instant`` [s after ignition].

    Raises AbsentError where the solver does not come that far.
    """
    if instant <= 0.0 and not engine.effects:
        return float(engine.saturation.pressure(engine.temperature))
    try:
        burnt = burn(engine, longest=max(instant, 1e-3))
    except ArithmeticError as error:
        raise AbsentError(f"the tank's pressure at {instant:.2f} s: {error}") from error
    if instant >= burnt.time[-1]:
        return burnt.last("tank_pressure")
    return float(np.interp(instant, burnt.time, burnt.output("tank_pressure")))


def _possible(engine: Engine, coldest: float) -> tuple[float, float]:
    """Temperatures [K] from ``coldest`` up at which the load is liquid and vapor; equal where there are none."""
    source, density = engine.saturation, engine.oxidizer_mass / engine.feed.volume
    grid = np.linspace(coldest, source.t_max - 0.05, 400)
    fits = (source.vapor_density(grid) < density) & (density < source.liquid_density(grid))
    return (float(grid[fits][0]), float(grid[fits][-1])) if fits.any() else (coldest, coldest)
