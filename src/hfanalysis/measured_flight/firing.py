"""The firing as the rocket feels it: thrust at altitude and mass on an even clock."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import pi

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly import rocket
from hfanalysis.engine.separation import LAWS, Law
from hfanalysis.errors import AbsentError
from hfanalysis.flight.curve import STEPS, Curve, accumulated, altitude_gain, even_curve
from hfanalysis.measured_flight import without_purge
from hfanalysis.measured_flight.nozzle_law import Followed, followed
from hfanalysis.measured_flight.propellant import Propellant, propellant
from hfanalysis.measured_flight.thrust import MeasuredThrust, measured_thrust
from hfanalysis.measured_flight.without_purge import VAPORS, Draw, Known, Tail, tail
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.sections import fuel_of
from hfanalysis.record.signals import Signal
from hfanalysis.rocket.parachute import Parachute
from hfanalysis.rocket.vehicle import Vehicle
from hfanalysis.thermo import atmosphere, combustion

RAW, CORRECTED = "as measured on the stand", "from the stand's ambient pressure to the altitude's"
AS_MEASURED, WITHOUT_PURGE = "as measured", "without purge gas"
"""Bases of the thrust."""

EQUILIBRIA = 60
"""Equilibria over a burn; the gas changes slowly, and thrust hardly follows its heat capacity ratio."""

LIT = 1.3
"""Chamber over ambient pressure [-] from which on the gas is worth an equilibrium; below, the nearest one holds."""

CURVES = 18
"""Curves drawn of what a thrust's correction may be. Evidence: each law of vapor and nozzle comes three times;
with 12, 24 or 48 of them the ends of HF5's band lie within 80 m, of 840 m."""


@dataclass(frozen=True)
class Firing:
    """What flies: the rocket, its rail [m] and canopies, thrust and mass over the burn, and what they come from.

    ``curve``: as flown; ``curves``: what it may be just as well, where the purge gas's part or the nozzle's law is not
    certain (else the curve alone); ``as_measured``: with the purge gas, by every law of the nozzle that may hold, the
    likelier first. ``gas_mass``: in the chamber [kg] on the curve's
    clock, None where its pressure or size is not known. ``burn_time`` [s]: of the stand, else until the chamber is at
    ambient pressure, after which the curve has some newtons. ``thrust_basis``: AS_MEASURED or WITHOUT_PURGE.
    """

    vehicle: Vehicle
    rail_length: float | None
    canopies: tuple[Parachute, Parachute] | str
    curve: Curve
    thrust: MeasuredThrust
    propellant: Propellant
    gas_mass: Array | None
    thrust_is: str
    notes: tuple[str, ...]
    curves: tuple[Curve, ...]
    as_measured: tuple[Curve, ...]
    burn_time: float
    thrust_basis: str = AS_MEASURED
    warnings: tuple[str, ...] = ()

    @property
    def wet_mass(self) -> float:
        """Of the rocket on its pad [kg]."""
        return self.vehicle.dry_mass + float(self.propellant.total[0])

    @property
    def impulse_stand(self) -> float:
        """Of the thrust that the stand measured [N s]."""
        return float(accumulated(self.thrust.time, self.thrust.thrust)[-1])


@dataclass(frozen=True)
class Course:
    """What a curve is made of: thrust [N] over ``time`` [s], the propellant, and the gas in the chamber."""

    time: Array
    thrust: Array
    load: Propellant
    gas: ChamberGas | None


@dataclass(frozen=True)
class ChamberGas:
    """In the chamber over ``time`` [s]: measured pressure [Pa]; frozen heat capacity ratio and R T [J/kg] at
    equilibrium."""

    time: Array
    pressure: Array
    gamma: Array
    specific_temperature: Array

    def at(self, time: Array) -> ChamberGas:
        """On another clock."""
        return ChamberGas(time, *(np.interp(time, self.time, x) for x in self._columns))

    @property
    def _columns(self) -> tuple[Array, Array, Array]:
        return self.pressure, self.gamma, self.specific_temperature


def firing(
    log: TestLog,
    segments: Segments | None,
    calibration: Calibration | None,
    definition: TestDefinition,
    raw_thrust: bool = False,
    seed: int = 1,
) -> Firing:
    """Assemble what flies. Raises AbsentError where the test lacks what a flight needs, with the reason.

    ``raw_thrust``: the thrust of the stand as it is, purge gas and all, as the report flies it; ``seed``: of what is
    drawn.
    """
    vehicle = rocket.vehicle(definition.rocket, definition.folder, launch_altitude(definition))
    if not isinstance(vehicle, Vehicle):
        raise AbsentError(f"test {definition.test.id}: there is nothing to fly: {vehicle}")
    assert definition.rocket is not None
    vehicle = _on_the_day(vehicle, definition)
    thrust = measured_thrust(log, segments, definition)
    load = propellant(log, segments, calibration, definition, thrust)
    clock = np.linspace(0.0, thrust.burn_time, STEPS + 1)
    stand = Course(thrust.time, thrust.thrust, load, _chamber_gas(clock, log, segments, definition, load))
    said = "raw thrust was asked for" if raw_thrust else _no_correction(stand.gas, definition)
    nozzle = None if said else _nozzle_law(stand, definition, thrust.bias_std)
    build = _Builder(vehicle.dry_mass, thrust.burn_time, definition, nozzle)
    purge, missing = _purge(log, segments, calibration, definition, stand) if not raw_thrust else (None, "")
    after = None if purge is None else tail(purge, Draw(nozzle=build.law))
    flown = stand if after is None else _flown(stand, after)
    measured = tuple(build.curve(stand, law) for law in build.possible)
    curve = measured[0] if purge is None else build.curve(flown)
    time = curve.time
    return Firing(
        vehicle,
        definition.rocket.guided_length,
        rocket.parachutes(definition.rocket),
        curve,
        thrust,
        flown.load,
        None if flown.gas is None else _gas_mass(time, flown.gas.at(time), definition, flown.load),
        RAW if said else CORRECTED,
        tuple(_notes(thrust, said, purge, nozzle, build.carried(flown.load), flown.load)),
        measured if purge is None else tuple(_drawn(build, stand, purge, seed)) or (curve,),
        measured,
        curve.burn_time if after is None else after.burnt_out(definition.ambient_pressure.value),
        AS_MEASURED if purge is None else WITHOUT_PURGE,
        (f"the purge gas's part of the thrust is flown: {missing}",) if missing else (),
    )


def _on_the_day(vehicle: Vehicle, definition: TestDefinition) -> Vehicle:
    """In the air of the launch's day, where it is stated."""
    site, ground = definition.site, vehicle.launch_altitude
    warm, pressure = (site.launch_temperature, site.launch_pressure) if site is not None else (None, None)
    return replace(
        vehicle,
        warmer=warm.value - atmosphere.temperature(ground) if warm is not None else 0.0,
        pressure_share=pressure.value / atmosphere.pressure(ground) if pressure is not None else 1.0,
    )


@dataclass(frozen=True)
class _Builder:
    """Makes curves of courses: ``dry_mass`` [kg] of the rocket; ``longest`` burn [s], that of the stand; the nozzle's
    law, None where none corrects."""

    dry_mass: float
    longest: float
    definition: TestDefinition
    nozzle: Followed | None

    @property
    def law(self) -> Law:
        """Of the nozzle."""
        return self.nozzle.law if self.nozzle is not None else "one-dimensional"

    @property
    def possible(self) -> tuple[Law, ...]:
        """The laws that may hold, the likelier first: both where they differ."""
        others = LAWS if self.nozzle is not None and self.nozzle.matters else ()
        return (self.law, *(law for law in others if law != self.law))

    def carried(self, load: Propellant) -> float:
        """Propellant that coasts [kg]."""
        return 0.0 if self.definition.model.conventions == "report" else float(load.total[-1])

    def curve(self, course: Course, law: Law | None = None) -> Curve:
        """Thrust and mass on an even clock, with the nozzle's gain where it corrects."""
        end = float(course.time[-1])
        # samples may be further apart than the curve's steps: what is linear between them stays so
        time = np.union1d(course.time, np.linspace(0.0, end, 2 * STEPS + 1))
        impulse = accumulated(time, np.interp(time, course.time, course.thrust))
        mass = self.dry_mass + np.interp(time, course.load.time, course.load.total)
        steps = max(round(STEPS * end / self.longest), 2)
        curve = even_curve(time, impulse, mass, self.dry_mass + self.carried(course.load), steps)
        if course.gas is None or self.nozzle is None:
            return curve
        used = law or self.law
        curve = replace(curve, law=LAWS.index(used))
        return _at_altitude(curve, course.gas.at(curve.time), self.definition, used)


def _purge(
    log: TestLog, segments: Segments | None, calibration: Calibration | None, definition: TestDefinition, stand: Course
) -> tuple[Known | None, str]:
    """What is known of the firing without purge gas, None where there is none to leave out; why it cannot be told."""
    signal = Signal("thrust", stand.time, stand.thrust, 0.0, float(np.median(np.diff(stand.time))))
    try:
        known = without_purge.known(log, segments, calibration, definition, signal, stand.load, float(stand.time[-1]))
        if known is not None:
            tail(known, Draw())
    except AbsentError as error:
        return None, str(error)
    return known, ""


def _flown(stand: Course, after: Tail) -> Course:
    """As measured until purge gas enters, then as the tank would have given."""
    before, new = stand.time < after.start, after.course
    load = stand.load
    until = load.time < after.start
    oxidizer, fuel = (
        np.minimum.accumulate(np.concatenate((old[until], tail)))
        for old, tail in ((load.oxidizer, new.mass), (load.fuel, after.fuel))
    )
    time, none = np.concatenate((load.time[until], after.time)), np.zeros(after.time.size)
    # the vapor's temperature counts only for the liquid's volume, of which there is none
    liquid, temperature = (
        np.concatenate((old[until], x))
        for old, x in ((load.liquid, none), (load.temperature, none + load.temperature[-1]))
    )
    ratio = np.concatenate((load.of_ratio[until], np.clip(new.flow / np.maximum(new.fuel_flow, 1e-9), 0.4, 200.0)))
    how = {**load.how, "oxidizer": f"{load.how['oxidizer']}; from the purge on as the vapor alone empties the tank"}
    load = replace(
        load, time=time, oxidizer=oxidizer, liquid=np.minimum(liquid, oxidizer), temperature=temperature, fuel=fuel,
        of_ratio=ratio, how=how,
    )  # fmt: skip
    gas = stand.gas
    if gas is not None:
        burning = gas.time < after.start
        columns = zip((gas.time, *gas._columns), (after.time, new.chamber, new.gamma, new.rt), strict=True)
        gas = ChamberGas(*(np.concatenate((old[burning], tail)) for old, tail in columns))
    return Course(
        np.concatenate((stand.time[before], after.time)),
        np.concatenate((stand.thrust[before], new.thrust)),
        load,
        gas,
    )


def _drawn(build: _Builder, stand: Course, purge: Known, seed: int) -> Iterator[Curve]:
    """Curves that may hold as well as the one flown."""
    nozzle = build.nozzle
    at_stand = build.possible if nozzle is not None and not nozzle.known else (build.law,)
    for i, after in without_purge.draws(purge, at_stand, CURVES, seed):
        law = build.possible[(i // len(VAPORS)) % len(build.possible)]
        curve = build.curve(_flown(stand, after), law)
        yield replace(curve, law=i % len(VAPORS) + len(VAPORS) * curve.law)


def _nozzle_law(stand: Course, definition: TestDefinition, thrust_std: float) -> Followed:
    """By which law of the nozzle the thrust is taken to altitude."""
    assert stand.gas is not None
    usual: Law = "one-dimensional" if definition.model.conventions == "report" else "separated"
    gas = stand.gas
    force = np.interp(gas.time, stand.time, stand.thrust)
    ambient = definition.ambient_pressure.value
    return followed(
        (gas.pressure, gas.gamma, force), ambient, _areas(definition), thrust_std, definition.model.nozzle, usual
    )


def _areas(definition: TestDefinition) -> tuple[float, float]:
    """Of throat and exit [m^2]."""
    nozzle = definition.nozzle
    assert nozzle is not None
    assert nozzle.throat_radius is not None
    assert nozzle.exit_radius is not None
    return pi * nozzle.throat_radius.value**2, pi * nozzle.exit_radius.value**2


def _notes(
    thrust: MeasuredThrust, raw: str, purge: Known | None, nozzle: Followed | None, carried: float, load: Propellant
) -> Iterator[str]:
    yield from thrust.notes
    if raw:
        yield f"thrust as measured on the stand: {raw}"
    if purge is not None:
        yield (
            f"from {purge.t_purge:.2f} s on the stand's purge gas fed the burn: what flies is what the tank's vapor "
            "would have given without it"
        )
    if nozzle is not None:
        both = "; the band holds both laws" if nozzle.matters else ""
        yield f"to altitude by the {nozzle.law} law of the nozzle: {nozzle.why}{both}"
    yield _coasting(carried, load)


def _coasting(carried: float, load: Propellant) -> str:
    left = float(load.total[-1])
    coasts = "with" if carried else "without"
    return f"{left:.2f} kg of propellant are left after the burn; the rocket coasts {coasts} them"


def launch_altitude(definition: TestDefinition) -> float:
    """Of the launch [m]: the rocket's, else the stand's, else that of the ambient pressure."""
    if definition.rocket is not None and definition.rocket.launch_altitude is not None:
        return definition.rocket.launch_altitude.value
    if definition.site is not None and definition.site.altitude is not None:
        return definition.site.altitude.value
    return atmosphere.altitude_of(definition.ambient_pressure.value)


def _no_correction(gas: ChamberGas | None, definition: TestDefinition) -> str:
    """Why the thrust cannot be taken to altitude; empty where it can."""
    nozzle = definition.nozzle
    if nozzle is None or nozzle.throat_radius is None or nozzle.exit_radius is None:
        return "[nozzle] throat_radius and exit_radius are not both given"
    return "the log has no live p_chamber" if gas is None else ""


def _at_altitude(curve: Curve, gas: ChamberGas, definition: TestDefinition, law: Law) -> Curve:
    """The curve with the nozzle's gain by ambient pressure."""
    stand = definition.ambient_pressure.value
    gain, ambients = altitude_gain(gas.gamma, gas.pressure, stand, *_areas(definition), law)
    return replace(curve, gain=gain, ambients=ambients)


def _chamber_gas(
    time: Array, log: TestLog, segments: Segments | None, definition: TestDefinition, load: Propellant
) -> ChamberGas | None:
    """At the O/F of the flows, as the quasi-steady chamber has it; None without a live chamber pressure."""
    channel = log.get("p_chamber")
    if channel is None or segments is None or Signal.of(channel).dead:
        return None
    signal = Signal.of(channel).shifted(segments.t_open.value or 0.0)
    pressure = signal.reduced(float(time[1] - time[0])).at(time)
    ambient = definition.ambient_pressure.value
    combustion.restart()
    fuel = fuel_of(definition.fuel)
    lit = np.flatnonzero(pressure > LIT * ambient)
    chosen = lit[:: max(lit.size // EQUILIBRIA, 1)] if lit.size else np.array([int(np.argmax(pressure))])
    ratio = np.interp(time, load.time, load.of_ratio)
    found = [combustion.equilibrium(max(float(pressure[i]), ambient), float(ratio[i]), fuel=fuel) for i in chosen]
    gamma, rt = np.array([(gas.gamma, gas.gas_constant * gas.temperature) for gas in found]).T
    return ChamberGas(time, pressure, np.interp(time, time[chosen], gamma), np.interp(time, time[chosen], rt))


def _gas_mass(time: Array, gas: ChamberGas, definition: TestDefinition, load: Propellant) -> Array | None:
    """m = p V / (R T) [kg], the port as wide as the fuel left it; None where the chamber's size is not known."""
    grain, chamber = definition.grain, definition.chamber
    if chamber is None or grain is None or grain.density is None or grain.outer_radius is None or grain.length is None:
        return None
    dead = sum(volume.value for volume in (chamber.pre_volume, chamber.post_volume) if volume is not None)
    casing = pi * grain.outer_radius.value**2 * grain.length.value
    volume = dead + casing - np.interp(time, load.time, load.fuel) / grain.density.value
    return np.asarray(np.maximum(gas.pressure, 0.0) * volume / gas.specific_temperature)
