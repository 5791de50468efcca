"""What no name explains, as a table over the state of the engine that it follows best, and a hint at its form.

A table is a smooth curve over a state with a Gaussian prior. States are compared by how probable they make the source's
course, with the covariance that the fit gives it. In one firing most states fall together: several may be alike, and
which it is only a test of another load can tell.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.answer.effect_source import Course
from hfanalysis.diagnose.naming.naming import Naming
from hfanalysis.effects.learnt import KNOTS, STATES, hats, learnt, name_of, state_at, states_of
from hfanalysis.engine.effect import Active
from hfanalysis.inference.candidate import SHORT, Candidate, attempted
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.gap import closed, frozen, total_gap
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.unknown import has_name
from hfanalysis.inference.unknowns.smooth_source import SmoothSource, smooth_prior
from hfanalysis.products.diagnosis import Learnt, PowerLaw
from hfanalysis.quantity import Quantity
from hfanalysis.sentences import text

FOLLOWS = 0.1
"""Part of its largest size by which a source may depart from what a state says of it. Source: that of a shape
(:data:`hfanalysis.inference.unknown.SHAPE` is a third of it at any one place)."""

COHERENT = 1.5
"""Values of a table over which it is coherent."""

ALIKE = 3.0
"""Log of how much more probable another state has to make a course to be told apart. Source: one in twenty."""

HALF = 0.5
"""Part of what a source closes of the gap over time that it has to close over a state to be adopted."""

SEEN, FEWEST = 2.0, 6
"""Standard deviations from which on a source is seen, and instants of it that a hint needs."""

POWERS = 2
"""States in a hint. Source: a third one takes what noise there is."""

STEEPEST = 4.0
"""Power of a state beyond which a hint is none. Source: laws of flow, heat and regression have powers up to 4; what
asks for more follows something else."""

SPREAD = 0.1
"""Of the logarithm of a state, that it has to have to be in a hint."""

ROUGH = 0.25
"""Of the logarithm of a source, that a hint may miss it by."""


@dataclass(frozen=True)
class Over:
    """A table over a ``state`` from ``low`` to ``high`` [SI]: ``values`` and ``bands`` (KNOTS,), and the course's log
    evidence by it."""

    state: str
    low: float
    high: float
    values: Array
    bands: Array
    log_evidence: float


@dataclass(frozen=True)
class Learning:
    """The effect that an unknown is over its state, the product, or why there is none."""

    active: Active | None = None
    product: Learnt | None = None
    reason: str | None = None


def learn(found: Naming, chosen: Candidate) -> Learning:
    """What can be adopted of the unknown in the answer, over the state that it follows best."""
    source = chosen.source
    if source is None:
        return Learning(reason="what was named does not explain the test, and no source was seen beside it")
    if not isinstance(source, SmoothSource):
        return Learning(reason="it is an event at an instant, not a course over a state of the engine")
    if source.place.sensor is not None:
        return Learning(reason=f"it is in what {source.place.sensor} reads: hfa health tells of sensors")
    course = _course_of(source, chosen.fit, found.bench.observed)
    free = closed(*(total_gap(f, found.bench.observed) for f in (found.base.fit, chosen.fit)))
    if not course.tables or free is None:
        return Learning(reason="no channel is off by more than its noise: there is nothing that a table could close")
    shares = {}
    for over in course.alike:  # the likeliest beforehand first; time last: at another load things come at other times
        active = learnt(course.effect(over)).at(strength=1.0, **_numbers(over))
        shares[over.state] = share = _closes(found, chosen, active)
        if share >= HALF * free:
            return Learning(active, _product(course, over, active, share, tuple(shares)))
    best = max(shares, key=lambda state: shares[state])
    closes = f"{max(shares[best], 0.0):.0%} where over time it closes {free:.0%}"
    return Learning(reason=f"it follows no state of the engine: over {STATES[best][2]}, the best, it closes {closes}")


@dataclass(frozen=True)
class _Followed:
    """A source at ``time`` (n,) [s], its ``mean`` and ``std`` (n,) in the unit of its site, the ``states`` (n,) [SI]
    that it may follow, and the tables over them."""

    source: SmoothSource
    time: Array
    mean: Array
    std: Array
    states: Mapping[str, Array]
    tables: tuple[Over, ...]

    @property
    def most(self) -> float:
        """The largest log evidence."""
        return max(over.log_evidence for over in self.tables)

    @property
    def alike(self) -> list[Over]:
        """The tables that are not told apart from the best, the likeliest beforehand first."""
        return [over for over in self.tables if over.log_evidence > self.most - ALIKE]

    def effect(self, over: Over) -> str:
        """The name of the effect that a table is."""
        return name_of(self.source.place.name, over.state, bool(np.isfinite(self.source.splines.liquid_out)))


def _course_of(source: SmoothSource, fitted: Fit, observed: Observed) -> _Followed:
    time = np.linspace(0.0, observed.last, 2 * source.splines.count)
    time = time[time < source.splines.liquid_out]
    mean, slopes, covariance = source.course(fitted, time)
    spread = slopes @ covariance @ slopes.T
    environments = _environments(Course.of(fitted, observed, time))
    states = {
        state: np.array([state_at(state, t, e) for t, e in zip(time, environments, strict=True)])
        for state in states_of(source.place.name)
    }
    tables = (over_state(state, own, mean, spread) for state, own in states.items())
    std = np.sqrt(np.maximum(spread.diagonal(), 0.0))
    return _Followed(source, time, mean, std, states, tuple(over for over in tables if over is not None))


def _product(course: _Followed, over: Over, active: Active, share: float, tried: tuple[str, ...]) -> Learnt:
    return Learnt(
        effect=active.effect.name,
        site=course.source.place.name,
        equation=active.effect.equation,
        state=over.state,
        parameters=quantities(active),
        evidences={one.state: one.log_evidence - course.most for one in course.tables},
        alike=tuple(one.state for one in course.alike if one.state not in tried),
        closed_fraction=share,
        hint=hint(course.states, course.mean, course.std, course.time),
    )


def _environments(course: Course) -> Array:
    """What terms read at the instants of a course (n, ENVIRONMENT), without what is unknown."""
    engine = course.found.hypothesis.at(course.found.x)
    named = replace(engine, effects=tuple(a for a in engine.effects if has_name(a.effect)))
    return course.environments(named)


def over_state(state: str, values: Array, mean: Array, covariance: Array) -> Over | None:
    """The table of a course over a state; None where the state stands still.

    ``values`` (n,) of the state and ``mean`` (n,) of the source [SI], with the source's ``covariance`` (n, n).
    """
    low, high = float(values.min()), float(values.max())
    size = float(np.abs(mean).max())
    if not np.isfinite(values).all() or high - low <= 1e-6 * max(abs(low), abs(high)) or size == 0.0:
        return None
    weights, prior = hats(values, low, high), size**2 * smooth_prior(KNOTS, COHERENT)
    noise = covariance + (FOLLOWS * size) ** 2 * np.eye(mean.size)
    whole = weights @ prior @ weights.T + noise
    gain = prior @ weights.T @ np.linalg.inv(whole)
    spread = prior - gain @ weights @ prior
    evidence = -0.5 * float(mean @ np.linalg.solve(whole, mean)) - 0.5 * float(np.linalg.slogdet(whole)[1])
    return Over(state, low, high, gain @ mean, np.sqrt(np.maximum(spread.diagonal(), 0.0)), evidence)


def _numbers(over: Over) -> dict[str, float]:
    values = {f"value_{k}": float(v) for k, v in enumerate(over.values)}
    return {"low": over.low, "high": over.high, **values, **{f"band_{k}": float(b) for k, b in enumerate(over.bands)}}


def quantities(active: Active) -> dict[str, Quantity]:
    """The parameters as they are adopted: the band is one number, by which all values are off together."""
    units = {p.name: "" if p.unit == "-" else p.unit for p in active.effect.parameters if not p.inner}
    return {n: Quantity(active.named[n], unit, 1.0 if n == "shift" else None) for n, unit in units.items()}


def with_learnt(hypothesis: Hypothesis, chosen: Candidate, active: Active) -> Hypothesis:
    """A hypothesis with what is named beside an unknown, constants as found, and the unknown as it was learnt."""
    named = frozen(hypothesis, chosen.fit)
    return replace(named, engine=replace(named.engine, effects=(*named.engine.effects, active)))


def _closes(found: Naming, chosen: Candidate, active: Active) -> float:
    """The part of the gap [-] that the table closes on the test itself, the base model's constants refitted; 0 where no
    engine runs with it."""
    base, observed = found.base.fit, found.bench.observed
    made = with_learnt(base.hypothesis, chosen, active)
    start = chosen.fit.x[: base.x.size] if chosen.fit.x.size >= base.x.size else base.x
    fitted = attempted(made, found.bench.at(chosen.form), start, SHORT)
    return 0.0 if fitted is None else closed(*(total_gap(f, observed) for f in (base, fitted))) or 0.0


def hint(courses: Mapping[str, Array], mean: Array, std: Array, time: Array) -> PowerLaw | None:
    """The product of powers of a few states that a source goes with, and when; None where it goes with none.

    Forward selection among the logarithms of the states, a power more where it is worth its price (BIC). ``courses``:
    (n,) [SI] by state; ``mean`` and ``std`` (n,) of the source at ``time`` (n,) [s].
    """
    seen = np.abs(mean) > SEEN * std
    sign = np.sign(np.sum(mean[seen]))
    seen &= np.sign(mean) == sign
    if seen.sum() < FEWEST or (np.abs(mean) > SEEN * std).sum() > seen.sum():
        return None
    log_source = np.log(np.abs(mean[seen]))
    weight = 1.0 / np.hypot(std[seen] / np.abs(mean[seen]), FOLLOWS)
    logs = {}
    for name, values in courses.items():
        if name != "time" and (values[seen] > 0.0).all() and np.isfinite(values[seen]).all():
            own = np.log(values[seen])
            if np.ptp(own) > SPREAD:
                logs[name] = own
    chosen: list[str] = []
    power, left = _powers([], log_source, weight)
    price = float(np.log(seen.sum()))
    while len(chosen) < POWERS and len(chosen) < len(logs):
        tried = {n: _powers([logs[c] for c in (*chosen, n)], log_source, weight) for n in logs if n not in chosen}
        name = min(tried, key=lambda n: tried[n][1])
        if left - tried[name][1] < price:
            break
        chosen.append(name)
        power, left = tried[name]
    fitted = power[0] + sum((k * logs[n] for k, n in zip(power[1:], chosen, strict=True)), np.zeros(log_source.size))
    if not chosen or np.abs(power[1:]).max() > STEEPEST or float(np.sqrt(np.mean((log_source - fitted) ** 2))) > ROUGH:
        return None
    start, end = float(time[seen][0]), float(time[seen][-1])
    powers = {name: float(k) for name, k in zip(chosen, power[1:], strict=True)}
    return PowerLaw(
        factor=float(sign * np.exp(power[0])), powers=powers, start=start, end=end, words=_words(powers, start)
    )


def _powers(logs: list[Array], log_source: Array, weight: Array) -> tuple[Array, float]:
    """The constant and the powers, and the weighted squares that they leave."""
    design = np.column_stack([np.ones(log_source.size), *logs])
    found = np.asarray(np.linalg.lstsq(weight[:, None] * design, weight * log_source, rcond=None)[0])
    return found.astype(np.float64), float(np.sum((weight * (log_source - design @ found)) ** 2))


def _words(powers: Mapping[str, float], start: float) -> str:
    of_states = " and ".join(f"{STATES[name][2]} to the power {power:.1f}" for name, power in powers.items())
    return text("it goes with {states} from {start} s on", states=of_states, start=f"{start:.1f}")
