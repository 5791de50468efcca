"""Engines of a planned test, drawn over what is not known of it, and what they would measure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import exp, log
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly import engine as build
from hfanalysis.assembly.calibrated import exponent, loss_factor
from hfanalysis.engine.batch import burn_many
from hfanalysis.engine.effect import Active
from hfanalysis.engine.grain import USUAL_N
from hfanalysis.engine.unsteady import Burn, Engine
from hfanalysis.errors import AbsentError
from hfanalysis.inference.full_run import LONGEST_BURN
from hfanalysis.products.calibration import Calibration, Joint
from hfanalysis.products.prediction import Scatter
from hfanalysis.quantity import NOT_IDENTIFIABLE, Quantity
from hfanalysis.record.engine_file import EngineFile, Needs, engine_of
from hfanalysis.record.planned import PlannedTest
from hfanalysis.simulation import flown
from hfanalysis.simulation.errors import off_by
from hfanalysis.simulation.of_test import OfTest
from hfanalysis.simulation.scatter import PRIOR_FREEDOM, PRIOR_SCATTER, RATE, scatter_among
from hfanalysis.units import Value
from hfanalysis.validate.model_errors import lower_factor, together

COMMAND = "hfa predict"

QUANTITIES = {"total_impulse": "N s", "peak_thrust": "N", "peak_chamber_pressure": "Pa", "t_v": "s", "burn_time": "s",
              "apogee": "m"}  # fmt: skip
"""What is predicted, with units."""

OF_THE_FIRED = ("oxidizer_mass", "volume", "fuel_mass")
"""Names of ``joint`` that are of the test that was fired: what the plan states takes their place."""


@dataclass(frozen=True)
class Base:
    """A test that is predicted from: its engine, its calibration without effects, and what was measured."""

    found: OfTest
    without: Calibration
    measured: Mapping[str, Quantity]

    @property
    def name(self) -> str:
        """The test's."""
        return self.found.definition.test.id


@dataclass(frozen=True)
class Planned:
    """The engines of a planned test by the constants of one test: on its stand, and in its rocket where it has one."""

    stand: Engine
    flying: Engine | None
    file: EngineFile


def planned(plan: PlannedTest, base: Base, effects: bool = True, temperature: str | None = None) -> Planned:
    """The planned geometry, load and ``temperature`` (default: the plan's) with the constants of a test.

    Raises InputError where the plan lacks what the model needs, AbsentError where the test has no n that an engine can
    have.
    """
    calibration = base.found.calibration if effects else base.without
    n = law_of(calibration, together(base.found.full.engine, calibration)).n
    if not 0.0 <= n <= 2.0:
        raise AbsentError(
            f"test {base.name}: it cannot be predicted from: {n:.2f} is its n; an engine has one between 0 and 2"
        )
    acting = base.found.adopted.acting if effects else ()
    content = _content(plan, base, calibration, temperature)
    file = engine_of(content, plan.path, b"")
    there = [replace(_built(file), effects=tuple(acting))]
    if "rocket" in plan.content:
        there.append(replace(_built(engine_of({**content, "rocket": plan.content["rocket"]}, plan.path, b"")),
                             effects=tuple(acting)))  # fmt: skip
    flying = there[-1] if there[-1].vehicle is not None else None
    return Planned(there[0], flying, file)


def _built(file: EngineFile) -> Engine:
    needs = Needs(file, COMMAND)
    return build.engine(needs, build.tank(needs))


@dataclass(frozen=True)
class Law:
    """a [SI] and n [-] that a further test burns by, and the lower factor of the constants' covariance [SI]."""

    a: float
    n: float
    factor: Array


def law_of(calibration: Calibration, joint: Joint) -> Law:
    """As calibrated; of a test that does not tell a and n apart, along the line that it does tell, with the n that
    fuels show, USUAL_N: the rate at the test's own flux stays.

    ``joint``: errors of the constants together. Raises AbsentError where there is no law.
    """
    a, n = calibration.a.value, calibration.n.value
    if a is None or n is None:
        raise AbsentError(f"a and n are missing: {calibration.n.reason or calibration.a.reason}")
    std = np.array(joint.std)
    factor = lower_factor(np.array(joint.correlation).reshape(len(std), -1)) * std[:, None]
    if calibration.n.verdict != NOT_IDENTIFIABLE:
        return Law(a, n, factor)
    covariance = factor @ factor.T
    along = covariance[:, joint.names.index("n")]
    gain = along / (along[joint.names.index("n")] + USUAL_N[1] ** 2)
    covariance -= np.outer(gain, along)
    own = np.sqrt(np.diag(covariance))
    scale = np.where(own > 0.0, own, 1.0)
    moved = gain * (USUAL_N[0] - n)
    return Law(
        a * exp(moved[joint.names.index("ln_a")]),
        n + moved[joint.names.index("n")],
        lower_factor(covariance / np.outer(scale, scale)) * own[:, None],
    )


def _content(plan: PlannedTest, base: Base, calibration: Calibration, temperature: str | None) -> dict[str, Any]:
    """What an engine file of the planned test would state."""
    own = {name: dict(plan.content.get(name, {})) for name in ("tank", "injector", "grain", "chamber", "nozzle")}
    own |= {"fuel": dict(plan.content["fuel"])} if "fuel" in plan.content else {}
    if temperature is not None:
        own["tank"]["temperature"] = temperature
    own["tank"]["polytropic_exponent"] = exponent(calibration)[0]
    own["injector"]["C_i"] = calibration.C_i.value
    law = law_of(calibration, together(base.found.full.engine, calibration))
    own["grain"] |= {"a": law.a, "n": law.n}
    about = base.found.definition.model
    model = {"conventions": about.conventions, "properties": about.properties}
    site = {"site": plan.content["site"]} if "site" in plan.content else {}
    loss = f"{loss_factor(calibration)!r} 1/m^4"
    return {"schema": 1, "engine": {"id": plan.test.id}, "model": model, "feed": {"K_loss": loss}, **own, **site}


def scatter_of(bases: Sequence[Base]) -> dict[str, Scatter]:
    """How far tests of the stand differ in C_i and in the regression rate, one relative standard deviation each.

    What is known of stands at large, PRIOR_SCATTER, counts as PRIOR_FREEDOM tests beside the stand's own k. A further
    test differs from the mean of them by s sqrt(1 + 1/k), which is what is drawn, with Student's distribution.
    """
    return {
        name: scatter_among(PRIOR_SCATTER[name], values)
        for name, values in logs_of([base.found.calibration for base in bases]).items()
    }


def logs_of(found: Sequence[Calibration]) -> dict[str, list[float]]:
    """ln C_i, and ln of the regression rate at one flux, of every test of a stand."""
    fluxes = [c.regression.reference_flux for c in found]
    known = [log(flux.value) for flux in fluxes if flux is not None and flux.value]
    flux = sum(known) / len(known) if known else 0.0
    return {
        "C_i": [log(c.C_i.value or 1.0) for c in found],
        RATE: [log(c.a.value or 1.0) + (c.n.value or 0.0) * flux for c in found],
    }


@dataclass(frozen=True)
class Change:
    """How one drawn engine differs: errors of the constants by name [SI], as of the engine ``measured_on``; factors [-]
    of area, a, throat, exit and fuel; additions to oxidizer [kg] and temperature [K]; effects. ``fired``: the errors of
    the constants together with those of the test that was fired."""

    fired: Mapping[str, float]
    off: Mapping[str, float]
    measured_on: Engine
    area: float
    a: float
    throat: float
    exit: float
    fuel: float
    oxidizer: float
    temperature: float
    effects: tuple[Active, ...]

    def of_the_fired(self, engine: Engine) -> Engine:
        """The engine that was fired, with the same errors of what is known of it."""
        return replace(off_by(engine, self.fired, self.measured_on), effects=self.effects)

    def of(self, engine: Engine) -> Engine:
        """An engine so changed."""
        made = off_by(engine, self.off, self.measured_on)
        return replace(
            made,
            feed=replace(made.feed, area=made.feed.area * self.area),
            a=made.a * self.a,
            throat_area=made.throat_area * self.throat,
            exit_area=max(made.exit_area * self.exit, made.throat_area * self.throat),
            fuel_mass=made.fuel_mass * self.fuel,
            oxidizer_mass=made.oxidizer_mass + self.oxidizer,
            temperature=made.temperature + self.temperature,
            effects=self.effects,
        )


def to_mean(bases: Sequence[Base]) -> list[dict[str, float]]:
    """ln of what takes each test's C_i and regression rate to the mean of all [-], by name."""
    logs = logs_of([base.found.calibration for base in bases])
    return [{name: float(np.mean(own)) - own[i] for name, own in logs.items()} for i in range(len(bases))]


def changes(
    base: Base, plan: Planned, scatter: Mapping[str, Scatter], count: int, seed: int, shift: Mapping[str, float]
) -> Iterator[Change]:
    """``count`` draws over the errors of the test's constants together, the plan's own, effects and scatter; ``shift``:
    as :func:`to_mean` has it of this test."""
    rng = np.random.default_rng(seed)
    joint, engine, file = base.found.joint, base.found.full.engine, plan.file
    factor = law_of(base.found.calibration, joint).factor
    for _ in range(count):
        fired = dict(zip(joint.names, factor @ rng.standard_normal(len(joint.names)), strict=True))
        off = {name: by for name, by in fired.items() if name not in OF_THE_FIRED}
        own_throat = _relative(file.nozzle.throat_radius) * rng.standard_normal()
        if own_throat:
            off.pop("throat_area", None)
        yield Change(
            fired=fired,
            off=off,
            measured_on=engine,
            area=exp(shift["C_i"] + _between(scatter["C_i"], rng) + _stated_off(file.injector.area, rng)),
            a=exp(shift[RATE] + _between(scatter[RATE], rng)),
            throat=exp(2.0 * own_throat),
            exit=exp(2.0 * _stated_off(file.nozzle.exit_radius, rng)),
            fuel=exp(_relative(file.grain.mass) * rng.standard_normal()),
            oxidizer=_std(file.tank.oxidizer_mass) * rng.standard_normal(),
            temperature=_std(file.tank.temperature) * rng.standard_normal(),
            effects=base.found.adopted.drawn(plan.stand.effects, rng),
        )


def _between(scatter: Scatter, rng: np.random.Generator) -> float:
    return float(scatter.drawn * rng.standard_t(scatter.freedom or PRIOR_FREEDOM))


def _stated_off(value: Value | None, rng: np.random.Generator) -> float:
    """By what part of itself a stated value is off; nothing is drawn where it is stated without its error."""
    relative = _relative(value)
    return relative * float(rng.standard_normal()) if relative else 0.0


def _std(value: Value | None) -> float:
    return 0.0 if value is None or value.std is None else value.std


def _relative(value: Value | None) -> float:
    return 0.0 if value is None or value.std is None else value.std / value.value


def outcomes(stands: Sequence[Engine], flying: Sequence[Engine], rail: float | None) -> Array:
    """What each engine would measure, (n, 6) in the order of QUANTITIES; NaN where it cannot be had.

    ``flying``: the same engines in their rocket, none where there is no rocket; ``rail`` [m].
    """
    burns = burn_many(stands, longest=LONGEST_BURN)
    flights = burn_many(flying, longest=LONGEST_BURN) if flying else ["no rocket"] * len(stands)
    apogees = [_apogee(e, b, rail) for e, b in zip(flying or stands, flights, strict=True)]
    return np.array([(*_burnt(b), apogee) for b, apogee in zip(burns, apogees, strict=True)])


def _burnt(burnt: Burn | str) -> tuple[float, ...]:
    if isinstance(burnt, str):
        return (np.nan,) * (len(QUANTITIES) - 1)
    peaks = [float(burnt.output(name).max()) for name in ("thrust", "chamber_pressure")]
    t_v = np.nan if burnt.liquid_out is None else burnt.liquid_out
    return float(burnt.state("impulse")[-1]), *peaks, t_v, burnt.burn_time if burnt.fuel_out else np.nan


def _apogee(engine: Engine, burnt: Burn | str, rail: float | None) -> float:
    if isinstance(burnt, str):
        return float("nan")
    found = flown.apogee(engine, burnt, rail)
    return float("nan") if found is None else found
