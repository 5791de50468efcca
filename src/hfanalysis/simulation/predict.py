"""What a planned test will measure, with bands, from tests that were fired; and how good that was once it has been."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import log

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly import rocket
from hfanalysis.engine.grain import USUAL_N
from hfanalysis.engine.unsteady import Engine
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.measured_flight.firing import launch_altitude
from hfanalysis.products.prediction import Foretold, Origin, Prediction, Score, Scored
from hfanalysis.quantity import NOT_IDENTIFIABLE, Quantity
from hfanalysis.record.planned import PlannedTest
from hfanalysis.rocket.vehicle import Vehicle
from hfanalysis.simulation.foretelling import (
    QUANTITIES,
    Base,
    Change,
    Planned,
    changes,
    outcomes,
    planned,
    scatter_of,
    to_mean,
)
from hfanalysis.version import __version__

BAND = 0.90
"""Share of the draws within a band [-]. Source: by choice, as is usual of forecasts."""

DRAWS = 400
"""Engines drawn. Evidence: test_predicting.py: with another seed the ends of the bands move by less than a seventh of
their width."""

ENOUGH = 0.9
"""Share of the draws that have to have a quantity for a band of it [-]. Source: by choice, as the band's."""

LASTS = 0.5
"""Part of a miss of the model by which it is another in the next test, one standard deviation [-]. Source: by choice;
docs/predict.md has how often bands held on simulated stands."""

DAYS = (5, 10, 15, 20, 25, 30, 35)
"""Temperatures of the tank [degC] at which the prediction is told beside the planned one: from a spring morning to a
desert's noon. Source: by choice; nitrous oxide is critical at 36.4."""

OF_A_DAY = 100
"""Engines drawn at each of them. Source: by choice: a picture asks for less than a number."""

LAST, BARE = "as_last_time", "without_effects"
"""The rivals: what the last test measured, and the model without effects as it is, not moved by what it missed."""


def predict(
    plan: PlannedTest,
    bases: Sequence[Base],
    origins: Mapping[str, Origin],
    temperature: str | None = None,
    draws: int = DRAWS,
    seed: int = 1,
) -> Prediction:
    """Bands of what ``plan`` will measure.

    Every draw takes one of the tests in turn: its constants off by what is known of their errors together, C_i and the
    regression rate moved to the mean of the tests and off by how far tests of one stand differ, the plan's load and
    temperature off by their own. What comes of it is moved by what the model missed in that test. Raises InputError
    where the plan or the tests do not fit.
    """
    _check(plan, bases, origins)
    plans = [planned(plan, base, temperature=temperature) for base in bases]
    misses = [misses_of(base) for base in bases]
    table = _drawn(plan, bases, plans, misses, draws, seed)
    refused = int(np.isnan(table[:, 0]).sum())
    days = {
        str(celsius): _of_a_day(plan, bases, f"{celsius} degC", misses, min(draws, OF_A_DAY), seed) for celsius in DAYS
    }
    file = plans[-1].file
    tank = file.tank
    return Prediction(
        name=plan.test.id,
        tests=tuple(base.name for base in bases),
        temperature=_stated(tank.temperature, "K"),
        oxidizer_mass=_stated(tank.oxidizer_mass, "kg"),
        injector_area=_stated(file.injector.area, "m^2"),
        band=BAND,
        predicted=_bands(table),
        over_temperature=days,
        rivals={LAST: dict(bases[-1].measured), BARE: _without(plan, bases, temperature)},
        scatter=scatter_of(bases),
        misses=_on_average(misses),
        draws=draws,
        refused=refused,
        seed=seed,
        notes=tuple(_notes(plan, bases, plans)),
        plan=plan.sha256,
        made_from=dict(origins),
        hfanalysis=__version__,
    )


def _check(plan: PlannedTest, bases: Sequence[Base], origins: Mapping[str, Origin]) -> None:
    if not bases or len(origins) < len(bases):
        raise InputError(f"{plan.path}: found {len(bases)} tests, some of them twice; expected --from TEST, once each")
    if plan.test.id in origins:
        raise InputError(f"{plan.path}, test.id: {plan.test.id} is among the tests that it would be predicted from")
    if len({base.found.definition.model.conventions for base in bases}) > 1:
        raise InputError(f"{plan.path}: the tests were calibrated under different conventions; expected one")


def _drawn(
    plan: PlannedTest, bases: Sequence[Base], plans: Sequence[Planned], misses: Sequence[Mapping[str, float]],
    draws: int, seed: int,
) -> Array:  # fmt: skip
    """Outcomes of all draws, (draws, quantities), moved by what the model ``misses`` in each test, which has its share
    of the draws."""
    scatter, stands, flying, moved = scatter_of(bases), list[Engine](), list[Engine](), list[Array]()
    counts = [len(range(i, draws, len(bases))) for i in range(len(bases))]
    for i, (base, own, shift) in enumerate(zip(bases, plans, to_mean(bases), strict=True)):
        drawn = list(changes(base, own, scatter, counts[i], seed + i, shift))
        stands += [change.of(own.stand) for change in drawn]
        flying += [change.of(own.flying) for change in drawn if own.flying is not None]
        moved.append(_missed(base, misses[i], drawn))
    table = outcomes(stands, flying, _rail(plan))
    missed = np.repeat([[own.get(name, 0.0) for name in QUANTITIES] for own in misses], counts, axis=0)
    noise = np.random.default_rng([seed, 1]).standard_normal(table.shape)
    return np.asarray(table * np.exp(np.concatenate(moved) + LASTS * missed * noise))


def _missed(base: Base, misses: Mapping[str, float], drawn: Sequence[Change]) -> Array:
    """ln(measured/model) of a test [-], (draws, quantities), by a model with the same errors as each draw: what is off
    in the test that was fired as in the next one is off in no difference between them.

    ``misses``: the same of the model as it is, which stands for a drawn engine that does not run.
    """
    found = _fired(base, drawn)
    out = np.zeros(found.shape)
    for i, name in enumerate(QUANTITIES):
        if name in misses:
            good = np.isfinite(found[:, i]) & (found[:, i] > 0.0)
            measured = log(base.measured[name].value or 1.0)
            out[:, i] = np.where(good, measured - np.log(np.where(good, found[:, i], 1.0)), misses[name])
    return out


def _of_a_day(
    plan: PlannedTest, bases: Sequence[Base], temperature: str, misses: Sequence[Mapping[str, float]], draws: int,
    seed: int,
) -> dict[str, Foretold]:  # fmt: skip
    """Bands with the tank at another temperature; with the reason where the load does not fit it there."""
    try:
        plans = [planned(plan, base, temperature=temperature) for base in bases]
    except InputError as error:
        reason = str(error)
        return {n: Foretold(value=None, low=None, high=None, unit=u, reason=reason) for n, u in QUANTITIES.items()}
    return _bands(_drawn(plan, bases, plans, misses, draws, seed))


def _rail(plan: PlannedTest) -> float | None:
    return plan.rocket.guided_length if plan.rocket is not None else None


def _stated(value: object, unit: str) -> Quantity:
    found, std = getattr(value, "value", None), getattr(value, "std", None)
    return Quantity.absent("not stated") if found is None else Quantity(found, unit, std)


def _bands(table: Array) -> dict[str, Foretold]:
    return {name: _band(table[:, i], unit) for i, (name, unit) in enumerate(QUANTITIES.items())}


def _band(values: Array, unit: str) -> Foretold:
    there = values[np.isfinite(values)]
    if there.size < ENOUGH * values.size or not there.size:
        reason = f"{there.size} of {values.size} drawn engines have one"
        return Foretold(value=None, low=None, high=None, unit=unit, reason=reason)
    low, middle, high = np.quantile(there, (0.5 - 0.5 * BAND, 0.5, 0.5 + 0.5 * BAND))
    return Foretold(value=float(middle), low=float(low), high=float(high), unit=unit)


def misses_of(base: Base) -> dict[str, float]:
    """ln(measured/model) of a test [-], by quantity, as far as it tells it."""
    found = {}
    for name, model in _model(base).items():
        measured = base.measured.get(name)
        if measured is not None and measured.value and measured.value > 0.0 and model > 0.0:
            found[name] = log(measured.value / model)
    return found


def _on_average(misses: Sequence[Mapping[str, float]]) -> dict[str, float]:
    of = {name: [own[name] for own in misses if name in own] for name in QUANTITIES}
    return {name: float(np.mean(values)) for name, values in of.items() if values}


def _model(base: Base) -> dict[str, float]:
    """What the model says of the test itself [SI]."""
    table = _fired(base)[0]
    return {name: float(value) for name, value in zip(QUANTITIES, table, strict=True) if np.isfinite(value)}


def _fired(base: Base, drawn: Sequence[Change] = ()) -> Array:
    """What the model says of the test itself, (1, quantities), or with every one of the ``drawn`` errors."""
    full, definition = base.found.full, base.found.definition
    engine = replace(full.engine, oxidizer_enthalpy=None) if full.follows else full.engine
    engines = [change.of_the_fired(engine) for change in drawn] or [engine]
    stated = definition.rocket
    vehicle = rocket.vehicle(stated, definition.folder, launch_altitude(definition)) if stated is not None else "none"
    flying = [replace(one, vehicle=vehicle) for one in engines] if isinstance(vehicle, Vehicle) else []
    return outcomes(engines, flying, stated.guided_length if stated is not None else None)


def _without(plan: PlannedTest, bases: Sequence[Base], temperature: str | None) -> dict[str, Quantity]:
    """The base model of the plan: the mean of the tests', by their constants without effects."""
    made = [planned(plan, base, False, temperature) for base in bases]
    table = outcomes([m.stand for m in made], [m.flying for m in made if m.flying is not None], _rail(plan))
    found = {}
    for i, (name, unit) in enumerate(QUANTITIES.items()):
        there = table[np.isfinite(table[:, i]), i]
        found[name] = Quantity(float(there.mean()), unit) if there.size else Quantity.absent("the model has none")
    return found


def _notes(plan: PlannedTest, bases: Sequence[Base], plans: Sequence[Planned]) -> list[str]:
    acting = {active.effect.name for own in plans for active in own.stand.effects}
    tank = plans[-1].file.tank
    exact = [key for key in ("oxidizer_mass", "temperature") if getattr(getattr(tank, key), "std", None) is None]
    return [
        "no log of the planned test was read: neither the constants nor the scatter between tests were fitted on it",
        "the apogee is that of the engine as it fires on its stand; of drag, mass and wind the bands have nothing",
        *(
            []
            if acting
            else ["no effect is adopted in these tests: without_effects is the model, not moved by what it missed"]
        ),
        *([f"taken as exact, for no +/- is stated: {', '.join(exact)}"] if exact else []),
        *(f"{base.name}: {name} is {q.verdict}" for base in bases for name, q in _doubted(base).items()),
        *(
            f"{base.name} does not tell a and n apart: predicted with an n of {own.stand.n:.2f}, drawn to "
            f"the {USUAL_N[0]} +/- {USUAL_N[1]} that fuels show"
            for base, own in zip(bases, plans, strict=True)
            if base.found.calibration.n.verdict == NOT_IDENTIFIABLE
        ),
    ]


def _doubted(base: Base) -> dict[str, Quantity]:
    found = {name: getattr(base.found.calibration, name) for name in ("C_i", "K_loss", "m", "a", "n")}
    return {name: q for name, q in found.items() if q.verdict not in (None, "identified", "stated")}


def score(
    frozen: Prediction, digest: str, test: str, raw: Mapping[str, str], measured: Mapping[str, Quantity],
    read: Mapping[str, str],
) -> Score:  # fmt: skip
    """A prediction laid over what was ``measured`` [SI] in ``test``; ``digest``: SHA-256 of its file, ``raw``: those of
    the test's files, ``read``: of its products.

    Raises InputError where one of its logs is among what the prediction was made from, AbsentError where nothing can be
    compared.
    """
    known = {digest: f"{name}'s {file}" for name, own in frozen.made_from.items() for file, digest in own.raw.items()}
    for file, own in raw.items():
        if own in known:
            raise InputError(f"{test}, {file}: is {known[own]}, from which {frozen.name} was predicted; no proof of it")
    scored = {
        name: _scored(foretold, measured.get(name, Quantity.absent("not measured")), frozen, name)
        for name, foretold in frozen.predicted.items()
    }
    told = [found.holds for found in scored.values() if found.holds is not None]
    if not told:
        reasons = "; ".join(f"{name}: {s.measured.reason or s.foretold.reason}" for name, s in scored.items())
        raise AbsentError(f"test {test}: nothing of {frozen.name} can be compared ({reasons})")
    return Score(
        name=frozen.name, test=test, prediction=digest, raw=dict(raw), scored=scored, held=sum(told), of=len(told),
        mean_error=_mean_errors(scored),
        notes=("the error of the log itself is not in a band: a value just outside may be the sensor's",),
        provenance=dict(read),
    )  # fmt: skip


def _scored(foretold: Foretold, measured: Quantity, frozen: Prediction, name: str) -> Scored:
    value, holds = measured.value, None
    if value is not None and foretold.low is not None and foretold.high is not None:
        holds = bool(foretold.low <= value <= foretold.high)
    rivals = {rival: _error(said[name].value if name in said else None, value) for rival, said in frozen.rivals.items()}
    return Scored(measured=measured, foretold=foretold, holds=holds, error=_error(foretold.value, value), rivals=rivals)


def _error(said: float | None, measured: float | None) -> float | None:
    return None if said is None or not measured else said / measured - 1.0


def _mean_errors(scored: Mapping[str, Scored]) -> dict[str, float | None]:
    """Of the prediction and of each rival, over the quantities that all of them have."""
    rows = [{"predicted": s.error, **s.rivals} for s in scored.values()]
    whole = [row for row in rows if all(error is not None for error in row.values())]
    names = rows[0] if rows else {}
    return {n: float(np.mean([abs(row[n] or 0.0) for row in whole])) if whole else None for n in names}
