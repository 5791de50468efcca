"""What is left of the propellant over the burn: oxidizer from the calibrated tank, fuel by the grain's regression.

The oxidizer leaves as the injector's equation has it on the measured pressures; without a calibration, as the tank's
load cell shows it or, failing that, as thrust does. The fuel follows G^n of that flow, scaled so that what was seen to
burn has burnt: with r^(2n) dr ~ mdot^n dt the port radius has a closed form, and the coefficient a is not needed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.calibrate.loaded_mass import load_cell_mass
from hfanalysis.calibrate.measured_pressures import MeasuredPressures
from hfanalysis.engine.grain import Grain, opened, pace_between
from hfanalysis.engine.injector import mass_flow, mass_flows
from hfanalysis.engine.tank import SPECIFIC_NITROGEN, liquid_of
from hfanalysis.errors import AbsentError
from hfanalysis.flight.curve import accumulated
from hfanalysis.measured_flight.thrust import MeasuredThrust
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.thermo.nitrous import saturation as saturation_of
from hfanalysis.units import Value

PARAFFIN_EXPONENT = 0.5
"""Exponent of the regression [-] where neither test.toml nor a calibration has one. Source: published values for
paraffin lie about it."""

UNSTATED = 0.01
"""Relative standard deviation [-] of a mass that is stated without one."""

POINTS = 1001
"""Times of the masses over the burn."""


@dataclass(frozen=True)
class Propellant:
    """Masses [kg] at ``time`` [s after opening]: oxidizer, of which liquid, and fuel; ``of_ratio`` of the flows.

    ``temperature`` of the tank [K], NaN where it is not known; ``loaded_std``: of the loaded masses together [kg].
    ``how``: where oxidizer and fuel come from, in words.
    """

    time: Array
    oxidizer: Array
    liquid: Array
    temperature: Array
    fuel: Array
    of_ratio: Array
    loaded_std: float
    stated_std: bool
    how: Mapping[str, str]

    @property
    def total(self) -> Array:
        """Oxidizer and fuel [kg], (n,)."""
        return np.asarray(self.oxidizer + self.fuel)


@dataclass(frozen=True)
class Oxidizer:
    """Oxidizer [kg] over time, of which liquid [kg]; the tank's temperature [K]; in words where it comes from."""

    mass: Array
    liquid: Array
    temperature: Array
    how: str


def propellant(
    log: TestLog,
    segments: Segments | None,
    calibration: Calibration | None,
    definition: TestDefinition,
    thrust: MeasuredThrust,
) -> Propellant:
    """The propellant over the burn. Raises AbsentError where a loaded mass is not known."""
    loaded, grain = _loaded(log, segments, calibration, definition), definition.grain
    if grain is None or grain.mass is None:
        raise AbsentError("[grain] mass is not given: the rocket's mass is not known")
    time = np.linspace(0.0, thrust.burn_time, POINTS)
    tank = _oxidizer(log, segments, calibration, definition, thrust, time, loaded.value)
    observed = definition.observed
    rest = observed.oxidizer_mass_after if observed is not None else None
    mass = tank.mass if rest is None else _ending_at(tank.mass, rest.value)
    flow = np.maximum(-np.gradient(mass, time), 0.0)
    fuel_out = segments.time("t_fuel_gone") if segments is not None else None
    burning = flow if fuel_out is None else np.where(time <= fuel_out, flow, 0.0)
    fuel, how_fuel = _fuel(definition, calibration, time, burning)
    fuel_flow = np.maximum(-np.gradient(fuel, time), 0.0)
    floor = 1e-3 * max(float(fuel_flow.max()), 1e-9)
    ratio = np.clip(flow / np.maximum(fuel_flow, floor), 0.4, 200.0)
    stated = loaded.std is not None and grain.mass.std is not None
    how = {"oxidizer": tank.how + _after(rest, "oxidizer"), "fuel": how_fuel}
    spread, liquid = float(np.hypot(_std(loaded), _std(grain.mass))), np.minimum(tank.liquid, mass)
    return Propellant(time, mass, liquid, tank.temperature, fuel, ratio, spread, stated, how)


def _loaded(
    log: TestLog, segments: Segments | None, calibration: Calibration | None, definition: TestDefinition
) -> Value:
    """The loaded oxidizer [kg]: stated, or the load cell's quiet reading, or what the calibration worked with."""
    if definition.tank is not None and definition.tank.oxidizer_mass is not None:
        return definition.tank.oxidizer_mass
    cell = load_cell_mass(log, segments) if segments is not None else None
    if cell is not None:
        return Value(*cell)
    found = calibration.oxidizer_mass if calibration is not None else None
    if found is None or found.value is None:
        raise AbsentError("[tank] oxidizer_mass is not given and no load cell shows it: the rocket's mass is not known")
    return Value(found.value, found.std)


def _std(mass: Value) -> float:
    return mass.std if mass.std is not None else UNSTATED * mass.value


def _after(rest: Value | None, what: str) -> str:
    return "" if rest is None else f"; scaled to the {rest.value:.3f} kg of [observed] {what}_mass_after"


def _ending_at(mass: Array, rest: float) -> Array:
    """The same course, scaled so that it ends at ``rest`` [kg]."""
    gone, wanted = float(mass[0] - mass[-1]), float(mass[0]) - rest
    scaled: Array = mass[0] - (mass[0] - mass) * (wanted / gone if gone > 0.0 else 1.0)
    return scaled


def _oxidizer(
    log: TestLog,
    segments: Segments | None,
    calibration: Calibration | None,
    definition: TestDefinition,
    thrust: MeasuredThrust,
    time: Array,
    loaded: float,
) -> Oxidizer:
    tank, injector = definition.tank, definition.injector
    known = tank is not None and tank.volume is not None and injector is not None and injector.area is not None
    if known and calibration is not None and segments is not None and calibration.alone("C_i").value:
        return _through_injector(log, segments, calibration, definition, time, loaded)
    unknown = np.full(time.size, np.nan)
    cell = log.get("m_tank")
    if cell is not None and segments is not None and not Signal.of(cell).dead:
        mass = _by_load_cell(Signal.of(cell).shifted(segments.t_open.value or 0.0), time, loaded)
        return Oxidizer(mass, mass, unknown, "the tank's load cell, from the loaded mass down")
    impulse = accumulated(thrust.time, thrust.thrust)
    share = np.maximum.accumulate(np.clip(np.interp(time, thrust.time, impulse) / impulse[-1], 0.0, 1.0))
    mass = loaded * (1.0 - share)
    return Oxidizer(mass, mass, unknown, "all of the loaded mass, used up as the impulse builds up")


def _by_load_cell(cell: Signal, time: Array, loaded: float) -> Array:
    """Running means of the cell, never rising, shifted to the loaded mass at the opening."""
    smooth = np.interp(time, cell.time, cell.smooth(0.5))
    falling = np.minimum.accumulate(smooth)
    return np.asarray(np.maximum(loaded + falling - falling[0], 0.0), dtype=np.float64)


def _through_injector(
    log: TestLog,
    segments: Segments,
    calibration: Calibration,
    definition: TestDefinition,
    time: Array,
    loaded: float,
) -> Oxidizer:
    """What the injector passes at the measured pressures: of liquid until t_v, then of what is in the tank."""
    assert definition.tank is not None
    assert definition.tank.volume is not None
    assert definition.injector is not None
    assert definition.injector.area is not None
    discharge = calibration.alone("C_i").value  # which empties the tank of what was weighed
    assert discharge is not None
    volume, area = definition.tank.volume.value, discharge * definition.injector.area.value
    source = saturation_of(definition.model.properties)
    line = 2.0 * (calibration.alone("K_loss").value or 0.0) * area**2  # its loss over the injector's own
    histories = MeasuredPressures.of(log, segments, definition, float(time[-1]), line / (1.0 + line))
    t_v = segments.time("t_v") or float(time[-1])
    temperature = np.interp(time, histories.time, histories.tank_temperature(source))
    drop = np.interp(time, histories.time, np.maximum(histories.run - histories.chamber, 0.0))
    wet = time < t_v
    liquid_flow = np.where(wet, mass_flows(area, source.liquid_density(temperature), drop), 0.0)
    mass = np.maximum(loaded - accumulated(time, liquid_flow), 0.0)
    last = int(wet.sum()) - 1
    nitrogen = _nitrogen_density(np.interp(time, histories.time, histories.tank), mass[last], volume, last, temperature)
    mass[last:] = _gas(time[last:], mass[last], volume, area, drop[last:], nitrogen[last:])
    v_l, v_v = source.liquid_volume(temperature)[0], source.vapor_volume(temperature)[0]
    liquid = np.where(wet, np.clip(liquid_of(volume, mass, v_l, v_v), 0.0, mass), 0.0)
    how = "the injector's equation on the measured pressures with the calibrated C_i, from the loaded mass down"
    return Oxidizer(mass, liquid, np.where(wet, temperature, temperature[last]), how)


def _nitrogen_density(tank: Array, left: float, volume: float, last: int, temperature: Array) -> Array:
    """Of the purge gas in the tank [kg/m^3]: the pressure that the emptying vapor, held at t_v's, does not explain."""
    share = tank / tank[last]
    excess = np.maximum(share - np.minimum.accumulate(share), 0.0) * tank[last]
    return np.asarray(excess / (SPECIFIC_NITROGEN * temperature[last]))


def _gas(time: Array, start: float, volume: float, area: float, drop: Array, nitrogen: Array) -> Array:
    """Oxidizer [kg] while the tank holds gas: its share of what the injector passes."""
    mass = np.empty_like(time)
    mass[0] = start
    for i in range(1, time.size):
        density = mass[i - 1] / volume + nitrogen[i]
        flow = mass_flow(area, density, drop[i]) * (mass[i - 1] / volume) / density if density > 0.0 else 0.0
        mass[i] = max(mass[i - 1] - flow * (time[i] - time[i - 1]), 0.0)
    return mass


def _fuel(definition: TestDefinition, calibration: Calibration | None, time: Array, flow: Array) -> tuple[Array, str]:
    """Fuel left [kg] over time, and how it was found."""
    grain, observed = definition.grain, definition.observed
    assert grain is not None
    assert grain.mass is not None
    rest = observed.fuel_mass_after if observed is not None else None
    end = rest.value if rest is not None else 0.0
    n, of = exponent_of(definition, calibration)
    share = accumulated(time, flow**n)
    share = share / share[-1] if share[-1] > 0.0 else time / time[-1]
    words = f"burnt as G^{n:.3g} ({of}), " + (f"{end:.3f} kg left as seen" if rest is not None else "all of it")
    if grain.length is None or grain.density is None or grain.outer_radius is None:
        return grain.mass.value - (grain.mass.value - end) * share, f"{words}; the port's growth is not known"
    body = Grain(grain.length.value, grain.outer_radius.value, grain.density.value, 1.0, n)
    first, last = body.port_radius(grain.mass.value), body.port_radius(end)
    radius = opened(first, body.a, n, share * pace_between(first, last, body.a, n))
    return np.maximum(body.fuel(radius), 0.0), words


def exponent_of(definition: TestDefinition, calibration: Calibration | None) -> tuple[float, str]:
    """The exponent [-] of the regression, and where it is from."""
    grain = definition.grain
    if grain is not None and grain.n is not None:
        return grain.n.value, "[grain] n"
    found = calibration.alone("n").value if calibration is not None else None
    if found is not None and 0.0 < found <= 2.0:
        return found, "calibrated n"
    return PARAFFIN_EXPONENT, "no n is known: taken as for paraffin"
