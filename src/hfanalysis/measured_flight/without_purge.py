"""The firing as a rocket without the stand's purge gas would have had it: from t_purge on, what the tank's vapor gives.

Until t_purge all is as measured. There the tank holds what has not yet flown of the vapor it had at t_v; from there on
it blows down through injector, chamber and nozzle, its thrust and chamber pressure continuous with those measured. How
the vapor flows through the injector and how its pressure falls cannot be told apart by one log: as if incompressible
(the report's law) it asks for one exponent, choked for another, and at an exponent that gases have for another
discharge coefficient. All of them fit the pressures until t_purge, and all are drawn.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from scipy.special import ndtri

from hfanalysis.arrays import Array
from hfanalysis.assembly.burnt_gas import combustion_of
from hfanalysis.assembly.calibrated import ASSUMED_EXPONENT
from hfanalysis.calibrate.measured_pressures import MeasuredPressures
from hfanalysis.calibrate.reducing import EXPONENTS
from hfanalysis.effects.injector_choked_vapor import expanding_flow
from hfanalysis.engine.grain import USUAL_N, Grain, opened, pace_between
from hfanalysis.engine.injector import mass_flows
from hfanalysis.engine.separation import LAWS as NOZZLE_LAWS
from hfanalysis.engine.separation import Law
from hfanalysis.errors import AbsentError
from hfanalysis.flight.curve import accumulated
from hfanalysis.measured_flight.propellant import Propellant, exponent_of
from hfanalysis.measured_flight.vapor_burn import VAPOR_GAMMA, Course, VaporBurn
from hfanalysis.performance.thrust import AT_AMBIENT
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import IDENTIFIED
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.sections import fuel_of
from hfanalysis.record.signals import Signal
from hfanalysis.thermo.combustion import PROPEP_OXIDIZER_ENTHALPY
from hfanalysis.thermo.fuels import Fuel
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.units import Value

VAPORS = INCOMPRESSIBLE, CHOKED, CHOKED_GAS = range(3)
"""How the vapor passes the injector: as the report has it; choked, with the liquid's coefficient; choked, with the
coefficient that an exponent as gases have it asks for."""

READ = 0.3
"""[s] before t_purge, or after t_v, over which the log is read there: no more than half of the time between them."""

LEAST_PHASE = 0.1
"""[s] of vapor before t_purge from which on its fall tells an exponent. Evidence: the pressure falls by some per cent
in it, a few times what a gauge is off."""

FREE_EXPONENT = 0.1
"""Relative standard deviation of the vapor's exponent [-] where the calibration states none."""

NO_REGRESSION = 1e-12
"""a [SI] of a fuel that does not burn. Source: by definition, next to nothing."""

UNKNOWN = "without it what the tank would have given without purge gas cannot be told"


@dataclass(frozen=True)
class FuelLaw:
    """r = rate (G/flux)^n: ``n`` [-]; the ``rate`` [m/s] at the ``flux`` [kg/(m^2 s)] where it is known best, None
    where only how much fuel has burnt is known."""

    n: Value
    rate: Value | None = None
    flux: float = 1.0

    @classmethod
    def of(cls, definition: TestDefinition, calibration: Calibration) -> FuelLaw:
        """As calibrated; where that found none, what fuels have."""
        n, _ = exponent_of(definition, calibration)
        grain, found, rate = definition.grain, calibration.alone("n"), calibration.regression_rate_reference
        if grain is not None and grain.n is not None:
            return cls(Value(n, grain.n.std or 0.0))
        flux = calibration.regression.reference_flux
        if found.value != n or rate.value is None or flux is None or flux.value is None:
            return cls(Value(n, USUAL_N[1]))
        std = found.std or 0.0 if found.verdict == IDENTIFIED else USUAL_N[1]
        return cls(Value(n, std), Value(rate.value, rate.std), flux.value)


@dataclass(frozen=True)
class Known:
    """What the log and test.toml say of the vapor phase [SI]; the times after the opening [s]."""

    t_v: float
    t_purge: float
    t_purge_std: float
    pressures: MeasuredPressures
    thrust: Signal
    volume: float
    area: float
    exponent: Value | None
    held: bool
    fuel: FuelLaw
    grain: Grain
    throat: float
    leave: float
    ambient: float
    burnt: Propellant
    properties: str
    made_of: Fuel


@dataclass(frozen=True)
class Draw:
    """In what one of the possible tails differs: law of the vapor and of the nozzle; standard deviations from the value
    of t_purge, of the vapor's exponent, of the fuel's and of its rate; the exponent that gases have [-]."""

    vapor: int = CHOKED_GAS
    nozzle: Law = "one-dimensional"
    purge: float = 0.0
    exponent: float = 0.0
    fuel: float = 0.0
    rate: float = 0.0
    gas: float = ASSUMED_EXPONENT[0]

    SPREAD: ClassVar[tuple[str, ...]] = ("purge", "exponent", "fuel", "rate", "gas")


@dataclass(frozen=True)
class Tail:
    """From ``start`` [s after opening] on without purge gas: its course, thrust as the cell would have had it."""

    start: float
    course: Course
    fuel: Array
    pressure: float
    exponent: float

    @property
    def time(self) -> Array:
        """[s after opening], (n,)."""
        return np.asarray(self.start + self.course.time)

    def burnt_out(self, ambient: float) -> float:
        """When the chamber is at ambient pressure [s after opening] as logs have it, ``ambient`` [Pa]."""
        spent = np.flatnonzero(self.course.chamber < (1.0 + AT_AMBIENT) * ambient)
        return float(self.time[spent[0]] if spent.size else self.time[-1])


def known(
    log: TestLog,
    segments: Segments | None,
    calibration: Calibration | None,
    definition: TestDefinition,
    thrust: Signal,
    load: Propellant,
    burn_end: float,
) -> Known | None:
    """What is needed to fly without purge gas; None where there is none to leave out.

    ``thrust`` [N] as corrected, ``load``: the propellant. Raises AbsentError with what is missing.
    """
    t_purge = segments.time("t_purge") if segments is not None else None
    if segments is None or t_purge is None or t_purge >= burn_end:
        return None
    t_v = segments.time("t_v")
    if segments.supercharged or t_v is None or t_purge < t_v:
        raise AbsentError("nitrogen enters before the liquid is gone: it belongs to the engine as it was fired")
    if calibration is None or not (calibration.alone("C_i").value or 0.0) > 0.0:
        raise AbsentError(f"no C_i is known; {UNKNOWN}")
    area = definition.injector.area if definition.injector is not None else None
    nozzle, grain = definition.nozzle, definition.grain
    stated = {
        "[tank] volume": definition.tank and definition.tank.volume,
        "[injector] holes and hole_area": area,
        "[nozzle] throat_radius": nozzle and nozzle.throat_radius,
        "[nozzle] exit_radius": nozzle and nozzle.exit_radius,
        "[grain] mass": grain and grain.mass,
        "[grain] length": grain and grain.length,
        "[grain] density": grain and grain.density,
        "[grain] outer_radius": grain and grain.outer_radius,
    }
    missing = [name for name, value in stated.items() if not isinstance(value, Value)]
    if missing:
        raise AbsentError(f"{', '.join(missing)} not given; {UNKNOWN}")
    volume, holes, throat, leave, _, length, density, outer = (
        value.value for value in stated.values() if isinstance(value, Value)
    )
    m, effective = calibration.alone("m"), (calibration.alone("C_i").value or 0.0) * holes
    line = 2.0 * (calibration.alone("K_loss").value or 0.0) * effective**2  # its loss over the injector's own
    pressures = MeasuredPressures.of(log, segments, definition, burn_end, line / (1.0 + line))
    return Known(
        t_v, t_purge, segments.t_purge.std or 0.0, pressures, thrust, volume, effective,
        None if m.value is None else Value(m.value, m.std), m.verdict == "stated",
        FuelLaw.of(definition, calibration), Grain(length, outer, density, 1.0, 0.5),
        np.pi * throat**2, np.pi * leave**2, definition.ambient_pressure.value, load, definition.model.properties,
        fuel_of(definition.fuel),
    )  # fmt: skip


def tail(found: Known, draw: Draw) -> Tail:
    """One possible course from t_purge on. Raises AbsentError where the vapor cannot have flowed so."""
    t_purge = max(found.t_purge + draw.purge * found.t_purge_std, found.t_v)
    width = min(READ, 0.5 * (found.t_purge - found.t_v))
    at_purge = _read(found, t_purge, -width)
    source = saturation(found.properties)
    temperature = float(source.temperature(np.clip(_read(found, found.t_v, width)[0], *source.pressure_range)))
    full = found.volume * float(source.vapor_density(temperature))
    pressure = min(at_purge[0], 0.999 * _read(found, found.t_v, width)[0])
    share, gone = _flown(found, t_purge, draw.vapor != INCOMPRESSIBLE)
    mass, exponent, factor = _vapor(found, draw, full, np.log(pressure / _read(found, found.t_v, width)[0]), gone)
    radius, a, n = _fuel(found, t_purge, draw)
    begun = VaporBurn(
        mass, pressure, temperature * (mass / full) ** (exponent - 1.0), exponent, factor * found.area, share,
        float(draw.vapor != INCOMPRESSIBLE), a, n, radius, found.grain.outer_radius, found.grain.length,
        found.grain.density, found.volume, found.throat, found.leave, found.ambient,
        float(NOZZLE_LAWS.index(draw.nozzle)), PROPEP_OXIDIZER_ENTHALPY,
    )  # fmt: skip
    gas = combustion_of(found.made_of).kernel
    chamber = at_purge[1]
    if chamber > found.ambient:  # the gas is as hot as the chamber pressure says
        enters, leaves = begun.inflow(gas, chamber)
        begun = replace(begun, efficiency=(leaves / enters) ** 2 if enters > 0.0 else 1.0)
    course = begun.run(gas)
    scale = max(at_purge[2], 0.0) / course.thrust[0] if course.thrust[0] > 0.0 else 0.0
    course = replace(course, thrust=scale * course.thrust)
    return Tail(t_purge, course, np.asarray([found.grain.fuel(r) for r in course.radius]), pressure, exponent)


def _read(found: Known, instant: float, width: float) -> tuple[float, float, float]:
    """Tank and chamber pressure [Pa] and thrust [N] at an ``instant`` [s], by lines over ``width`` [s] after it
    (negative: before it)."""
    low, high = sorted((instant, instant + width))
    p, force = found.pressures, found.thrust.between(low, high)
    some = (p.time >= low) & (p.time <= high)
    if some.sum() < 8 or force.time.size < 4:
        return tuple(float(np.interp(instant, t, x)) for t, x in _series(found))  # type: ignore[return-value]
    lines = ((p.time[some], p.tank[some]), (p.time[some], p.chamber[some]), (force.time, force.value))
    tank, chamber, thrust = (float(np.polyval(np.polyfit(t - instant, x, 1), 0.0)) for t, x in lines)
    return tank, chamber, thrust


def _series(found: Known) -> Iterator[tuple[Array, Array]]:
    yield found.pressures.time, found.pressures.tank
    yield found.pressures.time, found.pressures.chamber
    yield found.thrust.time, found.thrust.value


def _flown(found: Known, t_purge: float, choked: bool) -> tuple[float, float]:
    """The injector's share of the pressure drop, and int mdot dt / (2 sqrt(M)) [kg^0.5] from t_v to t_purge.

    mdot = C A sqrt(2 (M / V) dp) psi makes d sqrt(M) / dt = -C A sqrt(dp / (2 V)) psi.
    """
    p = found.pressures
    time = np.linspace(found.t_v, max(t_purge, found.t_v + 1e-6), 201)
    tank, run, chamber = (np.interp(time, p.time, x) for x in (p.tank, p.run, p.chamber))
    share = float(np.clip((run - chamber).mean() / max((tank - chamber).mean(), 1.0), 0.05, 1.0))
    flow = mass_flows(found.area, 1.0 / found.volume, share * np.maximum(tank - chamber, 0.0))
    if choked:
        flow *= [expanding_flow(r, VAPOR_GAMMA) for r in chamber / np.maximum(tank, 1.0)]
    return share, 0.5 * float(accumulated(time, flow)[-1])


def _vapor(found: Known, draw: Draw, full: float, fallen: float, gone: float) -> tuple[float, float, float]:
    """Mass [kg] in the tank at t_purge, exponent [-], and factor [-] on the injector's area.

    ``full``: mass [kg] at t_v; ``fallen``: logarithm of what its pressure has fallen to; ``gone`` as :func:`_flown`.
    Raises AbsentError where no gas has such an exponent.
    """
    short = found.t_purge - found.t_v < LEAST_PHASE
    if draw.vapor == CHOKED_GAS or short:
        exponent = draw.gas
        mass = full * np.exp(fallen / exponent)
        factor = 1.0 if short or gone <= 0.0 else (np.sqrt(full) - np.sqrt(mass)) / gone
        return float(mass), exponent, float(factor)
    root = np.sqrt(full) - gone
    exponent = fallen / (2.0 * np.log(root) - np.log(full)) if root > 0.0 and gone > 0.0 else np.nan
    if draw.vapor == INCOMPRESSIBLE and found.exponent is not None:
        exponent = found.exponent.value if draw.exponent == 0.0 or found.held else exponent
    std = found.exponent.std if found.exponent is not None else None
    relative = std / found.exponent.value if found.exponent is not None and std is not None else FREE_EXPONENT
    exponent *= 1.0 + draw.exponent * min(relative, 0.3)
    if not EXPONENTS[0] < exponent < EXPONENTS[1]:
        raise AbsentError("no exponent of the vapor lets its pressure fall as it does from t_v to t_purge")
    return float(max(root, 0.05 * np.sqrt(full)) ** 2), float(exponent), 1.0


def _fuel(found: Known, t_purge: float, draw: Draw) -> tuple[float, float, float]:
    """Port radius [m] at t_purge, and a and n of the fuel: as calibrated, else so that what has burnt has burnt."""
    load, law = found.burnt, found.fuel
    n = float(np.clip(law.n.value + draw.fuel * (law.n.std or 0.0), 0.0, 1.0))
    flow = np.maximum(-np.gradient(load.oxidizer, load.time), 0.0)
    first, last = (found.grain.port_radius(float(load.fuel[i])) for i in (0, -1))
    over = accumulated(load.time, np.where(load.fuel > load.fuel[-1], flow / np.pi, 0.0) ** n)
    if law.rate is not None:
        a = (law.rate.value + draw.rate * (law.rate.std or 0.0)) / law.flux**n
    elif over[-1] > 0.0 and last > first:
        a = pace_between(first, last, 1.0, n) / float(over[-1])
    else:
        return first, NO_REGRESSION, n
    radius = float(opened(first, a, n, float(np.interp(t_purge, load.time, over))))
    return min(radius, found.grain.outer_radius), max(float(a), NO_REGRESSION), n


def draws(found: Known, nozzle: tuple[Law, ...], count: int, seed: int) -> Iterator[tuple[int, Tail]]:
    """``count`` possible tails with their numbers, each law of vapor and ``nozzle`` (that of the stand's thrust) as
    often as the others; those that cannot be are left out."""
    spread = _spread(len(Draw.SPREAD), -(-count // len(VAPORS)), seed)
    for i in range(count):
        law = nozzle[(i // len(VAPORS)) % len(nozzle)]
        off = dict(zip(Draw.SPREAD, spread[i // len(VAPORS)].tolist(), strict=True))
        gas = ASSUMED_EXPONENT[0] + ASSUMED_EXPONENT[1] * off.pop("gas")
        with suppress(AbsentError):
            yield i, tail(found, Draw(VAPORS[i % len(VAPORS)], law, gas=gas, **off))


def _spread(columns: int, rows: int, seed: int) -> Array:
    """Standard deviations from the value, (rows, columns): each column goes evenly through the normal distribution
    (the middles of a Latin hypercube), since few rows drawn freely may all lie on one side."""
    rng = np.random.default_rng([seed, 20])
    places = [(rng.permutation(rows) + 0.5) / rows for _ in range(columns)]
    return np.asarray(ndtri(np.stack(places, axis=1)))
