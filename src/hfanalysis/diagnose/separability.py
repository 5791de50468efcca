"""What can be told apart with the channels of a test, before its residuals are looked at.

The engine is the prior's most probable one. Of the measured values only the noise, the times and the calibrated
constants are used. Everything is linear: S_k is the Fisher information of the strength of effect k after the nuisances,
with their priors, are projected out. An effect of strength p is seen with d' = p sqrt(S_k), and told from a rival l
with d'_{k|l} = p sqrt(S_k (1 - rho_kl^2)). Two things are added to that formula. A rival may also change its shape, the
parameters beside its strength, by their priors; and one that would need a negative strength, where there is none, is no
rival.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.diagnose.added_sensors import Sensor, missing_sensors
from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.engine.effect import Effect
from hfanalysis.engine.sensitivity import run_with_tangents
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.predict import ACCURACY, AFTER, all_slopes, slopes_of, with_spare_fuel
from hfanalysis.inference.observations.observed import Observed

NOMINAL = 10.0
"""d' of the test at which effects are told apart."""

TWINS = 4.0
"""Names that a test of nominal strength leaves closer than this are twins."""

SEEN = 5.0
"""d' from which on an effect counts as seen."""

SINGULAR = 1e-12
"""Relative size below which a direction of a rival's information is none."""

SMALL = 0.01
"""Strength of every effect, in units of the typical one, at which slopes of shapes are taken: at 0 they have none."""


@dataclass(frozen=True)
class Information:
    """Fisher information ``matrix`` (columns, columns) of strengths (and shapes), nuisances projected out, in units of
    what is typical of each.

    ``owners``: the effect of every column; ``shapes`` (columns,): which columns are shapes, with the prior N(0, 1). An
    effect with several strengths counts as all of them at their typical size, independent of one another.
    ``one_sided``: effects whose strength cannot be negative.
    """

    owners: tuple[str, ...]
    matrix: Array
    shapes: NDArray[np.bool_]
    one_sided: frozenset[str] = frozenset()

    def _columns(self, name: str, shapes: bool = False) -> list[int]:
        return [i for i, owner in enumerate(self.owners) if owner == name and (shapes or not self.shapes[i])]

    def detectability(self, name: str) -> float:
        """d' [-] of an effect of typical strength; 0 where the channels do not show it.

        >>> told = Information(("a", "b"), np.array([[100.0, 60.0], [60.0, 100.0]]), np.zeros(2, dtype=bool))
        >>> told.detectability("a")
        10.0
        """
        own = self._columns(name)
        return float(np.sqrt(max(np.trace(self.matrix[np.ix_(own, own)]), 0.0)))

    def correlation(self, one: str, other: str) -> float:
        """rho [-] of the first strengths of two effects; NaN where one of them is not shown."""
        i, j = self._columns(one)[0], self._columns(other)[0]
        size = float(np.sqrt(self.matrix[i, i] * self.matrix[j, j]))
        return float(self.matrix[i, j]) / size if size > 0.0 else float("nan")

    def beside(self, name: str, rival: str) -> float:
        """d' [-] of an effect of typical strength that is left when a rival takes up what it can.

        d'^2 = F_kk - F_kl F_ll^-1 F_lk, the Schur complement in the information.

        >>> told = Information(("a", "b"), np.array([[100.0, 60.0], [60.0, 100.0]]), np.zeros(2, dtype=bool))
        >>> round(told.beside("a", "b"), 9)
        8.0
        """
        own, other = self._columns(name), self._columns(rival, shapes=True)
        cross = self.matrix[np.ix_(own, other)]
        stiff = self.matrix[np.ix_(other, other)] + np.diag(self.shapes[other].astype(float))
        share = np.linalg.pinv(stiff, SINGULAR, hermitian=True) @ cross.T
        if {name, rival} <= self.one_sided and share[0, 0] < 0.0:
            return self.detectability(name)
        return float(np.sqrt(max(np.trace(self.matrix[np.ix_(own, own)] - cross @ share), 0.0)))

    def at_nominal(self, name: str, rival: str) -> float:
        """d'_{k|l} [-] of an effect that is as strong as to be seen with NOMINAL; NaN for one that is not shown at
        all."""
        seen = self.detectability(name)
        return NOMINAL * self.beside(name, rival) / seen if seen > 0.0 else float("nan")

    def apart(self, one: str, other: str) -> float:
        """The lesser of the two d'_{k|l} [-] of a pair at nominal strength."""
        return min(self.at_nominal(one, other), self.at_nominal(other, one))


def projected(slopes: Array, nuisances: int) -> Array:
    """Information (columns, columns) of what follows the nuisances in whitened slopes (observations, columns) with x.

    Every nuisance has the prior N(0, 1), which enters as an observation of its own: so the result is positive
    semidefinite, however large the slopes.
    """
    prior = np.eye(nuisances, slopes.shape[1])
    upper: Array = np.asarray(np.linalg.qr(np.concatenate([slopes, prior]), mode="r"))
    own = upper[nuisances:, nuisances:]
    return np.asarray(own.T @ own)


@dataclass(frozen=True)
class Outlook:
    """What a test can tell: whitened slopes of all it observes, and the rows that further sensors would add.

    ``strongest``: by name, the size [SI] of its first strength beyond which an effect is none; ``effects`` by name.
    Columns of shapes are those of an effect as strong as to be seen with NOMINAL.
    """

    effects: Mapping[str, Effect]
    owners: tuple[str, ...]
    shapes: NDArray[np.bool_]
    nuisances: int
    slopes: Array
    extra: Mapping[Sensor, Array]
    strongest: Mapping[str, float]
    channels: tuple[str, ...]

    @cached_property
    def now(self) -> Information:
        """With the channels that the test has."""
        return self._information(self.slopes)

    def with_sensor(self, sensor: Sensor) -> Information:
        """With one more."""
        return self._information(np.concatenate([self.slopes, self.extra[sensor]]))

    def _information(self, slopes: Array) -> Information:
        one_sided = frozenset(n for n, e in self.effects.items() if e.strengths == 1 and e.strength.low >= 0.0)
        return Information(self.owners, projected(slopes, self.nuisances), self.shapes, one_sided)

    def strength_at(self, name: str, detectability: float) -> float:
        """The first strength [SI] that is seen with a given d' [-]; infinite where nothing is."""
        seen = self.now.detectability(name)
        return detectability / seen * self.effects[name].strength.typical if seen > 0.0 else float("inf")

    def in_reach(self, name: str) -> bool:
        """Whether an effect is seen at all at a strength that it can have."""
        return self.strength_at(name, SEEN) <= self.strongest[name]

    @cached_property
    def visible(self) -> tuple[str, ...]:
        """Effects that are."""
        return tuple(n for n in self.effects if self.in_reach(n))

    @cached_property
    def twins(self) -> dict[tuple[str, str], float]:
        """Pairs of visible effects that a test of nominal strength does not tell apart, with the lesser d'_{k|l} [-],
        the closest first."""
        pairs = [(a, b) for i, a in enumerate(self.visible) for b in self.visible[i + 1 :]]
        close = {pair: d for pair in pairs if (d := self.now.apart(*pair)) < TWINS}
        return dict(sorted(close.items(), key=lambda item: item[1]))

    def twins_with(self, sensor: Sensor) -> dict[tuple[str, str], float]:
        """How far apart (d' [-]) the twins are with one more sensor, at the strengths that were nominal without it."""
        more, found = self.with_sensor(sensor), {}
        for one, other in self.twins:
            both = ((one, other), (other, one))
            found[one, other] = min(NOMINAL * more.beside(a, b) / self.now.detectability(a) for a, b in both)
        return found

    def separated(self, sensor: Sensor) -> dict[tuple[str, str], float]:
        """Twins that are twins no longer with one more sensor, with their d' [-]."""
        return {pair: d for pair, d in self.twins_with(sensor).items() if d >= TWINS}

    def shown(self, sensor: Sensor) -> dict[str, float]:
        """Effects that are seen at their typical strength with one more sensor and not without it: their d' [-]."""
        more = self.with_sensor(sensor)
        found = {n: more.detectability(n) for n in self.effects if self.now.detectability(n) < SEEN}
        return {n: d for n, d in found.items() if d >= SEEN}


def look_ahead(hypothesis: Hypothesis, observed: Observed, catalogue: Catalogue) -> Outlook:
    """The slopes of all effects, from a run of the base model (for shapes one with hardly any of each effect).

    Raises ValueError or ArithmeticError for an engine that cannot be run.
    """
    made, base = _with_all(hypothesis, catalogue), hypothesis.size
    own = made.free[base:]
    strengths = {f"{n}.{p.name}" for n, e in catalogue.effects.items() for p in e.parameters[: e.strengths]}
    shapes = np.array([f.name not in strengths for f in own])
    sensors = missing_sensors(observed)
    nothing = _rows(made, observed, sensors, np.zeros(made.size))
    little = _rows(made, observed, sensors, np.concatenate([np.zeros(base), np.where(shapes, 0.0, SMALL)]))
    pick = np.concatenate([np.zeros(base, dtype=bool), shapes])
    rows = [np.where(pick, some / SMALL, none) for none, some in zip(nothing, little, strict=True)]
    limits = {f.name: max(abs(f.value(f.least)), abs(f.value(f.most))) for f in own}
    plain = Outlook(
        effects=catalogue.effects,
        owners=tuple(f.name.partition(".")[0] for f in own),
        shapes=shapes,
        nuisances=base,
        slopes=rows[0],
        extra=dict(zip(sensors, rows[1:], strict=True)),
        strongest={n: limits[f"{n}.{e.strength.name}"] for n, e in catalogue.effects.items()},
        channels=observed.names,
    )
    return _at_nominal(plain)


def _rows(made: Hypothesis, observed: Observed, sensors: tuple[Sensor, ...], x: Array) -> list[Array]:
    """Whitened slopes with x of what is observed, and of what each sensor would read."""
    engine = with_spare_fuel(made.at(x), observed.fuel_out)
    found = run_with_tangents(engine, made.of_engine, observed.longest + AFTER, ACCURACY, run_on=True)
    jacobian, mine = made.jacobian(x), np.flatnonzero(np.isin(made.names, made.of_engine))
    rows = [all_slopes(made, observed, slopes_of(made, observed, found))]
    for sensor in sensors:
        own = sensor.slopes(made, observed, found)
        rows.append(np.zeros((own.shape[0], made.size)))
        rows[-1][:, mine] = own
    return [row @ jacobian for row in rows]


def _with_all(hypothesis: Hypothesis, catalogue: Catalogue) -> Hypothesis:
    """The base model with every effect; what a test states of one does not move."""
    made = hypothesis
    for name in catalogue.effects:
        made = catalogue.add(made, name)
    return replace(made, free=tuple(f for f in made.free if f.unsure))


def _at_nominal(plain: Outlook) -> Outlook:
    """Shapes change what an effect adds: their columns as for one that is seen with NOMINAL, if it can be so strong."""
    scale = np.ones(plain.slopes.shape[1])
    for i in np.flatnonzero(plain.shapes):
        name = plain.owners[i]
        strength = min(plain.strength_at(name, NOMINAL), plain.strongest[name])
        scale[plain.nuisances + i] = strength / plain.effects[name].strength.typical
    return replace(plain, slopes=plain.slopes * scale, extra={s: rows * scale for s, rows in plain.extra.items()})
