"""Firings on paper whose thrust holds what the report's model leaves out: the stand's nitrogen, a flow that separates.

The engine is the project's own unsteady one. What it would have done without nitrogen is its run without the effect, so
that the flight of a rocket without a stand is known exactly.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import date
from functools import cache
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from simulated.stand import AMBIENT

from hfanalysis.arrays import Array
from hfanalysis.assembly.engine import combustion_of
from hfanalysis.effects import effect
from hfanalysis.engine.effect import Active
from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.engine.separation import LAWS, Law, thrusts
from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.flight.ascent import Ascent, ascend
from hfanalysis.flight.curve import Curve, accumulated, altitude_gain, even_curve
from hfanalysis.measured_flight.firing import Firing, firing
from hfanalysis.products.calibration import Calibration, RegressionBasis
from hfanalysis.products.segments import EVENTS, Segments
from hfanalysis.quantity import IDENTIFIED, Quantity
from hfanalysis.record.definition import ChannelSpec, FileSpec, LogSpec, Test, TestDefinition
from hfanalysis.record.log import Channel, TestLog
from hfanalysis.record.rocket import Rocket
from hfanalysis.record.sections import (
    Chamber,
    GrainSection,
    Injector,
    Model,
    NozzleSection,
    ObservedSection,
    Purge,
    Site,
    Tank,
)
from hfanalysis.rocket.vehicle import Vehicle
from hfanalysis.thermo.combustion import PROPEP_OXIDIZER_ENTHALPY
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.units import Value

VOLUME, MASS, FUEL = 16.5e-3, 8.35, 1.594
HOLES, HOLE_AREA, C_I, K_LOSS = 22, 3.142e-6, 0.293, 6.4e8
THROAT, EXIT, LENGTH, DENSITY, OUTER = 23.3e-3, 38.1e-3, 0.61, 788.9, 39.497e-3
GROUND, ZERO, RATE = 1402.0, 1.0, 500.0
CRACKING, SUPPLY = 4.27e5, 39e5
RATE_OF_FUEL, FLUX = 1.1e-3, 250.0
SECONDS, SPENT = 25.0, 0.05
ROCKET = Rocket(
    dry_mass=Value(52.5, 0.01),
    drag_coefficient=0.529,
    drag_uncertainty=0.002,
    diameter=Value(157.48e-3),
    launch_angle=Value(np.radians(6.0), 1e-4),
    rail_length=Value(6.05),
    launch_altitude=Value(GROUND),
    wind_speed=Value(0.0, 0.05),
)
"""Of Hot Fire 5's rocket, all but its thrust as good as exactly known."""


@dataclass(frozen=True)
class Truth:
    """What happens [SI]: exponent of the vapor, whether it chokes in the injector, n of the fuel, law of the nozzle,
    whether nitrogen enters."""

    m: float = 1.15
    choked: bool = False
    n: float = 0.45
    nozzle: Law = "one-dimensional"
    purge: bool = True


@dataclass(frozen=True)
class Fired:
    """A firing on paper: what the stand records, what is known of it, and the run without nitrogen."""

    truth: Truth
    log: TestLog
    segments: Segments
    calibration: Calibration
    definition: TestDefinition
    alone: Burn

    def flown(self, **model: Any) -> Firing:
        """As it is analyzed, with what [model] states beside."""
        stated = replace(self.definition, model=Model("corrected", "coolprop", **model))
        return firing(self.log, self.segments, self.calibration, stated)

    def flight(self) -> tuple[Ascent, float]:
        """Of a rocket whose tank has no purge line, and the impulse of its thrust [N s] along it."""
        curve, vehicle = self._curve(), Vehicle(52.5, 0.529, 0.25 * pi * 157.48e-3**2, float(np.radians(6.0)), GROUND)
        up = ascend(curve, vehicle, 6.05)
        burning = up.column("time") <= curve.burn_time
        return up, float(np.trapezoid(up.column("thrust")[burning], up.column("time")[burning]))

    def _curve(self) -> Curve:
        run = self.alone
        time, pressure = run.time, run.output("chamber_pressure")
        load = run.state("tank_mass") + DENSITY * pi * LENGTH * (OUTER**2 - run.state("port_radius") ** 2)
        force = stand_thrust(run, self.truth.nozzle)
        curve = even_curve(time, accumulated(time, force), 52.5 + load, 52.5 + float(load[-1]))
        p, gamma = (np.interp(curve.time, time, x) for x in (pressure, _gamma(run)))
        gain, ambients = altitude_gain(gamma, p, AMBIENT, *AREAS, self.truth.nozzle)
        return replace(curve, gain=gain, ambients=ambients)


AREAS = (pi * THROAT**2, pi * EXIT**2)


def _gamma(run: Burn) -> Array:
    """Of the chamber's gas: nearly constant, and hardly anything depends on it."""
    return np.full(run.time.size, 1.26)


def stand_thrust(run: Burn, law: Law) -> Array:
    """What the stand's cell feels [N]."""
    if law == "one-dimensional":
        return run.output("thrust")
    pressure, gamma = run.output("chamber_pressure"), _gamma(run)
    one, off = (thrusts(LAWS.index(x), gamma, pressure, AMBIENT, *AREAS) for x in LAWS)
    return np.asarray(run.output("thrust") * np.where(one > 0.0, off / np.maximum(one, 1e-9), 1.0))


def _engine(truth: Truth, *effects: Active) -> Engine:
    choked = (effect("injector_choked_vapor").at(weight=1.0),) if truth.choked else ()
    return Engine(
        saturation=saturation("coolprop"), combustion=combustion_of(),
        feed=FeedSystem(VOLUME, C_I * HOLES * HOLE_AREA, K_LOSS), oxidizer_mass=MASS, temperature=298.0,
        polytropic_exponent=truth.m, fuel_mass=FUEL, grain_length=LENGTH, outer_radius=OUTER, fuel_density=DENSITY,
        a=RATE_OF_FUEL / FLUX**truth.n, n=truth.n, dead_volume=1.1e-3, throat_area=AREAS[0], exit_area=AREAS[1],
        ambient_pressure=AMBIENT, oxidizer_enthalpy=PROPEP_OXIDIZER_ENTHALPY, effects=(*choked, *effects),
    )  # fmt: skip


@cache
def fired(truth: Truth, seed: int = 0) -> Fired:
    """The firing, its sensors with a little noise; with a ``seed`` its constants are found as wrongly as they say."""
    purge = effect("n2_purge").at(area=1.2e-5, supply_pressure=SUPPLY, cracking_pressure=CRACKING)
    alone = burn(_engine(truth), SECONDS)
    with_purge = burn(_engine(truth, purge), SECONDS) if truth.purge else alone
    spent = with_purge.output("chamber_pressure") < (1.0 + SPENT) * AMBIENT
    end = float(with_purge.time[spent & (with_purge.time > 1.0)][0]) if spent[-1] else float(with_purge.time[-1])
    assert alone.liquid_out is not None
    falls = alone.output("tank_pressure")
    t_purge = float(np.interp(CRACKING - SUPPLY, -falls, alone.time)) if truth.purge else None
    return Fired(
        truth, _log(with_purge, end, truth, seed), _segments(alone.liquid_out, t_purge, end),
        _calibration(truth, seed), _definition(_fuel_left(with_purge, end)), alone,
    )  # fmt: skip


def _log(run: Burn, end: float, truth: Truth, seed: int) -> TestLog:
    """Until the valve is shut at ``end`` [s], and two seconds after it."""
    rng = np.random.default_rng(seed)
    time = np.arange(-1.0, end + 2.0, 1.0 / RATE)
    series = {
        "p_tank": (run.output("tank_pressure"), run.output("tank_pressure")[0], run.output("tank_pressure")[-1], 1e3),
        "p_run": (run.output("run_pressure"), AMBIENT, run.output("run_pressure")[-1], 1e3),
        "p_chamber": (run.output("chamber_pressure"), AMBIENT, AMBIENT, 1e3),
        "thrust": (stand_thrust(run, truth.nozzle), 0.0, 0.0, ZERO),
    }
    found = {}
    for name, (value, before, after, noise) in series.items():
        clean = np.where(time > end, after, np.interp(time, run.time, value, left=before))
        values, flags = clean + noise * rng.standard_normal(time.size), np.zeros(time.size, dtype=np.uint8)
        unit, accuracy, zero = ("N", 2.0, 1.0) if name == "thrust" else ("Pa", 5e3, 500.0)
        found[name] = Channel(name, unit, time, values, flags, accuracy, True, name, zero_std=zero)
    return TestLog(found)


def _segments(t_v: float, t_purge: float | None, end: float) -> Segments:
    absent = {name: Quantity.absent("this test does not have it") for name in EVENTS if name != "t_fuel_gone"}
    known = {"t_v": Quantity(t_v, "s", 1e-3), "t_end": Quantity(end, "s", 1e-2)}
    if t_purge is not None:
        known["t_purge"] = Quantity(t_purge, "s", 0.02)
    return Segments.of(Quantity(0.0, "s", 1e-4), absent | known, kind="hot_fire")


def _calibration(truth: Truth, seed: int) -> Calibration:
    """What is found where the pressures are good: by the report's law, which a choked vapor does not follow."""
    rng = np.random.default_rng([seed, 7])

    def near(true: float, unit: str, std: float) -> Quantity:
        return Quantity(true + (std * rng.standard_normal() if seed else 0.0), unit, std, verdict=IDENTIFIED)

    found = {
        "C_i": near(C_I, "", 1e-3),
        "K_loss": near(K_LOSS, "1/m^4", 1e6),
        "m": Quantity.absent("as the vapor's law has it") if truth.choked else near(truth.m, "", 0.03),
        "n": near(truth.n, "", 0.03),
        "regression_rate_reference": near(RATE_OF_FUEL, "m/s", 0.02 * RATE_OF_FUEL),
    }
    basis = RegressionBasis(reference_flux=Quantity(FLUX, "kg/(m^2 s)"))
    fields = Calibration.model_fields.items()
    none = {key: Quantity.absent("not asked for") for key, of in fields if of.annotation is Quantity}
    empty: dict[str, Any] = {"rest": None, "C_i_history": None, "tank_history": None, "notes": (), "warnings": ()}
    return Calibration.model_validate({**none, **empty, **found, "regression": basis})


def _fuel_left(run: Burn, end: float) -> float:
    return DENSITY * pi * LENGTH * (OUTER**2 - float(np.interp(end, run.time, run.state("port_radius"))) ** 2)


CELL = ChannelSpec(column="thrust", unit="N", calibrated=date(2024, 5, 2), name="thrust")
"""A load cell that was calibrated in place: what is flown of its thrust is not lost in its gain."""


def _definition(fuel_left: float) -> TestDefinition:
    grain = GrainSection(Value(FUEL, 0.005), Value(LENGTH), Value(DENSITY), Value(OUTER))
    return TestDefinition(
        Test("PURGED", "hot_fire"), LogSpec((FileSpec("log.csv"),)), {"thrust": CELL},  # not read from disk
        tank=Tank(Value(VOLUME), Value(MASS, 0.01)), injector=Injector(HOLES, Value(HOLE_AREA)), grain=grain,
        purge=Purge(Value(CRACKING)), chamber=Chamber(Value(0.218e-3), Value(0.885e-3)),
        nozzle=NozzleSection(Value(THROAT), Value(EXIT)), site=Site(ambient_pressure=Value(AMBIENT, 0.0)),
        observed=ObservedSection(fuel_mass_after=Value(max(fuel_left, 0.0), 0.005)), rocket=ROCKET,
        path=Path("PURGED/test.toml"), sha256="0" * 64,
    )  # fmt: skip
