"""What the next test should be: how far each would narrow what is not known of an engine.

Engines are drawn over the errors of the constants together, the engine file's [covariance]. Each drawn engine has its
own apogee, and each test that is thought of would measure something else of it: what is measured tells of the apogee as
far as the two go together over the draws (the best linear estimate). Sensors are off by what sensors usually are, and
C_i and the regression rate differ from one test of a stand to the next.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly import engine as build
from hfanalysis.engine.batch import burn_many
from hfanalysis.engine.unsteady import Burn, Engine
from hfanalysis.errors import InputError
from hfanalysis.inference.adopted.effects import Adopted
from hfanalysis.products.engines import NextTest, NextTests, SensorWorth
from hfanalysis.record.engine_file import EngineFile, Needs
from hfanalysis.simulation import flown
from hfanalysis.simulation.errors import off_by
from hfanalysis.simulation.scatter import PRIOR_SCATTER, RATE
from hfanalysis.simulation.spread import factor_of

COMMAND = "hfa next"

DRAWS = 300
"""Engines drawn. Evidence: test_next_test.py: another seed leaves the best test the best."""

SEED = 1

OFTEN = 0.9
"""Share of the draws that have to show a quantity for it to count as measured [-]. Source: by choice, as of bands."""

OWN = ("oxidizer_mass", "volume", "fuel_mass")
"""Names of [covariance] that are of the test that was fired, its load, tank and grain: a further test has its own, as
well known as those."""

SENSORS = {
    "thrust cell": ("impulse", "peak_thrust"),
    "chamber gauge": ("chamber_pressure",),
    "tank gauge": ("t_v", "tank_pressure"),
    "tank's load cell": ("flow",),
    "burn time": ("burn_time",),
}
"""What each sensor gives."""

USUAL = {
    "impulse": 0.01, "peak_thrust": 0.01, "chamber_pressure": 0.01, "t_v": 0.01, "tank_pressure": 0.005, "flow": 0.01,
    "burn_time": 0.02,
}  # fmt: skip
"""Relative standard deviations [-] of what is measured. Source: by choice: accuracies of ordinary sensors
(record/channels.py), and of instants what intervals of replicas come to."""

CHANGES: dict[str, Callable[[Engine], Engine]] = {
    "as before": lambda e: e,
    "a fifth less oxidizer": lambda e: replace(e, oxidizer_mass=0.8 * e.oxidizer_mass),
    "a tenth more oxidizer": lambda e: replace(e, oxidizer_mass=1.1 * e.oxidizer_mass),
    "10 K colder": lambda e: replace(e, temperature=e.temperature - 10.0),
    "10 K warmer": lambda e: replace(e, temperature=e.temperature + 10.0),
    "two thirds of the holes": lambda e: replace(e, feed=replace(e.feed, area=e.feed.area * 2.0 / 3.0)),
    "four thirds of the holes": lambda e: replace(e, feed=replace(e.feed, area=e.feed.area * 4.0 / 3.0)),
    "a throat a tenth smaller (higher back pressure)": lambda e: replace(e, throat_area=0.9 * e.throat_area),
    "a throat a fifth larger (lower back pressure)": lambda e: replace(e, throat_area=1.2 * e.throat_area),
    "a grain a fifth shorter": lambda e: replace(e, grain_length=0.8 * e.grain_length, fuel_mass=0.8 * e.fuel_mass),
}
"""Tests that are thought of, and what of the engine is another then."""


@dataclass(frozen=True)
class Draws:
    """Errors of the constants by name (draws,) [SI]: of the stand, and of each further test's own; relative scatter of
    C_i and of the regression rate in that test (draws,)."""

    stand: dict[str, Array]
    own: dict[str, Array]
    scatter: Array
    count: int

    def row(self, i: int) -> dict[str, float]:
        """What one further test's engine is off by, without the scatter."""
        return {**{k: float(v[i]) for k, v in self.stand.items()}, **{k: float(v[i]) for k, v in self.own.items()}}


def next_tests(file: EngineFile, effects: Adopted, wanted: str | None = None, seed: int = SEED) -> NextTests:
    """The tests of CHANGES by how far they narrow ``wanted``: apogee, total_impulse, or a constant (default: the
    apogee, without a rocket the impulse).

    Raises InputError where the file has no [covariance], or nothing of that name is in it.
    """
    needs = Needs(file, COMMAND)
    drawn = _draws(file, needs, seed)
    engine = replace(build.engine(needs, build.tank(needs)), effects=effects.acting)
    stand = replace(engine, vehicle=None, ambient_pressure=build.ambient_pressure(file))
    target = wanted or ("apogee" if engine.vehicle is not None else "total_impulse")
    values, unit = _targets(file, engine, drawn, target)
    now = float(np.nanstd(values))
    rows, again = [], None
    for name, change in CHANGES.items():
        found = _would_measure(change(stand), stand, drawn)
        if isinstance(found, str):
            rows.append(NextTest(name=name, reason=found))
            continue
        again = again or found
        after = _after(values, found, tuple(SENSORS))
        rows.append(NextTest(name=name, std=after, narrowed=now - after))
    rows.sort(key=lambda row: float("inf") if row.std is None else row.std)
    return NextTests(
        engine=file.engine.id, target=target, unit=unit, value=_value(file, engine, target), std=now,
        tests=tuple(rows), sensors=() if again is None else tuple(_sensors(values, again)),
        assumed={**USUAL, **{f"{name}, from test to test": std for name, std in PRIOR_SCATTER.items()}},
    )  # fmt: skip


def _draws(file: EngineFile, needs: Needs, seed: int) -> Draws:
    errors = needs.value(file.covariance, "covariance", "names")
    names, rng = list(errors.names), np.random.default_rng(seed)
    factor = factor_of(file, errors)
    fired, further = (rng.standard_normal((DRAWS, len(names))) @ factor.T for _ in range(2))
    return Draws(
        {name: fired[:, i] for i, name in enumerate(names) if name not in OWN},
        {name: further[:, i] for i, name in enumerate(names) if name in OWN},
        rng.standard_normal((DRAWS, 2)) * [PRIOR_SCATTER["C_i"], PRIOR_SCATTER[RATE]],
        DRAWS,
    )


def _would_measure(engine: Engine, reference: Engine, drawn: Draws) -> dict[str, Array] | str:
    """Logarithms of what sensors would read of a further test, (draws,) each, NaN where a draw has none; why, where the
    test itself cannot be."""
    made = []
    for i in range(drawn.count):
        off = off_by(engine, drawn.row(i), reference)
        by_flow, by_rate = np.exp(drawn.scatter[i])
        made.append(replace(off, feed=replace(off.feed, area=off.feed.area * float(by_flow)), a=off.a * float(by_rate)))
    itself, *burns = burn_many([engine, *made])
    if isinstance(itself, str):
        return itself
    rows = [_measured(burnt) if isinstance(burnt, Burn) else {} for burnt in burns]
    found = {name: np.log([row.get(name, np.nan) for row in rows]) for name in USUAL}
    return {name: of for name, of in found.items() if np.isfinite(of).mean() >= OFTEN}


def _after(values: Array, found: dict[str, Array], sensors: tuple[str, ...]) -> float:
    """Standard deviation of the target (draws,) once that is measured, with these ``sensors``."""
    seen = [quantity for sensor in sensors for quantity in SENSORS[sensor] if quantity in found]
    if not seen:
        return float(np.nanstd(values))
    table = np.column_stack([values, *(found[name] for name in seen)])
    table = table[np.isfinite(table).all(axis=1)]
    both = np.cov(table, rowvar=False)
    noise = np.diag([USUAL[name] ** 2 for name in seen])
    across = both[0, 1:]
    told = float(across @ np.linalg.solve(both[1:, 1:] + noise, across))
    return float(np.sqrt(max(both[0, 0] - told, 0.0)))


def _sensors(values: Array, again: dict[str, Array]) -> Iterator[SensorWorth]:
    """What the same test ``again`` would tell less without each sensor, the most first."""
    whole = _after(values, again, tuple(SENSORS))
    without = {name: tuple(other for other in SENSORS if other != name) for name in SENSORS}
    worth = {name: _after(values, again, others) - whole for name, others in without.items()}
    for name in sorted(worth, key=lambda name: -worth[name]):
        yield SensorWorth(name=name, worth=max(worth[name], 0.0))


def _measured(burnt: Burn) -> dict[str, float]:
    """What sensors make of a burn [SI]."""
    chamber, thrust = burnt.output("chamber_pressure"), burnt.output("thrust")
    found = {"impulse": float(burnt.state("impulse")[-1]), "peak_thrust": float(thrust.max())}
    end = burnt.burn_time if burnt.liquid_out is None else burnt.liquid_out
    wet = burnt.time <= end
    time = burnt.time[wet]
    found["chamber_pressure"] = float(np.trapezoid(chamber[wet], time) / end)
    found["tank_pressure"] = float(burnt.output("tank_pressure")[wet][-1])
    mass = burnt.state("tank_mass")
    found["flow"] = float((mass[0] - mass[wet][-1]) / end)
    if burnt.liquid_out is not None:
        found["t_v"] = burnt.liquid_out
    if burnt.fuel_out:
        found["burn_time"] = burnt.burn_time
    return found


def _targets(file: EngineFile, engine: Engine, drawn: Draws, target: str) -> tuple[Array, str]:
    """The target of every drawn engine (draws,) and its unit [SI]; NaN where a draw has none."""
    if target in drawn.stand:
        return drawn.stand[target], ""
    if target not in ("apogee", "total_impulse"):
        raise InputError(f"--for {target}: expected apogee, total_impulse or one of {', '.join(drawn.stand)}")
    if target == "apogee" and engine.vehicle is None:
        raise InputError(
            f"--for apogee: {file.path} has no [rocket] that can fly; expected total_impulse or a constant"
        )
    stand = [{name: float(of[i]) for name, of in drawn.stand.items()} for i in range(drawn.count)]
    engines = [off_by(engine, off, engine) for off in stand]
    values = [_target(file, one, burnt, target) for one, burnt in zip(engines, burn_many(engines), strict=True)]
    return np.array(values), "m" if target == "apogee" else "N s"


def _target(file: EngineFile, engine: Engine, burnt: Burn | str, target: str) -> float:
    if isinstance(burnt, str):
        return float("nan")
    if target == "total_impulse":
        return float(burnt.state("impulse")[-1])
    height = flown.apogee(engine, burnt, file.rocket.guided_length if file.rocket else None)
    return float("nan") if height is None else height


def _value(file: EngineFile, engine: Engine, target: str) -> float | None:
    """The target of the engine as it is stated; None for a constant."""
    if target not in ("apogee", "total_impulse"):
        return None
    (burnt,) = burn_many([engine])
    found = _target(file, engine, burnt, target)
    return found if np.isfinite(found) else None
