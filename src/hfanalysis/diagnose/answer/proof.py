"""Proof: does an effect close the gap on data that did not name it?

Four arms. The same data; stretches of it that were held out; another test of the stand with the effect's constants as
found here; and placebos: the best wrong effect, and an unknown source of as much freedom.

Models are fitted at the model-form error that the explanation asks for, those of another test at what each asks for
there; gaps are measured at the finest, where a sensor's offset and gain are all that is taken off.
"""

from __future__ import annotations

from dataclasses import dataclass

from hfanalysis.diagnose.answer.learnt import with_learnt
from hfanalysis.diagnose.naming.naming import Naming
from hfanalysis.engine.effect import Active
from hfanalysis.inference.candidate import Bench, Candidate
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.gap import closed, frozen, held_out, root_mean_square, total_gap
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.products import diagnosis


@dataclass(frozen=True)
class OtherTest:
    """Another test of the same stand: its name, base model and observations."""

    name: str
    hypothesis: Hypothesis
    observed: Observed


@dataclass(frozen=True)
class Proof:
    """Parts of the gap [-] that are closed, by arm; None where an arm could not be had, and why in ``notes``."""

    fractions: dict[str, float | None]
    other: diagnosis.OtherTest | None
    notes: tuple[str, ...]


def prove(found: Naming, chosen: Candidate, other: OtherTest | None, unknown: Active | None = None) -> Proof:
    """All four arms for a set of named effects, on another test with what is ``unknown`` as it was learnt."""
    observed, fitted = found.bench.observed, found.bench.at(chosen.form)
    base, after = found.base.fit, chosen.fit
    before = total_gap(base, observed)
    notes = []
    fractions: dict[str, float | None] = {"same": closed(before, total_gap(after, observed))}
    if fractions["same"] is None:
        notes.append("the gap was within the noise of blocks before: there is no fraction of it to close")
    fractions["held_out"] = held_out(base, after, fitted, observed)
    elsewhere = _elsewhere(chosen, unknown, other) if other is not None else None
    fractions["other_test"] = elsewhere.closed_fraction if elsewhere else None
    if other is None:
        notes.append("there is no other test of this stand to prove it on")
    elif elsewhere is None:
        notes.append(f"{other.name} cannot be modeled with these constants of the effects: nothing is proved on it")
    wrong = _placebo(found, chosen)
    fractions["placebo"] = closed(before, total_gap(wrong.fit, observed)) if wrong else None
    free = next((c for c in found.unknown if len(c.names) == 1), None)
    fractions["placebo_free_form"] = closed(before, total_gap(free.fit, observed)) if free else None
    return Proof(fractions, elsewhere, tuple(notes))


def _placebo(found: Naming, chosen: Candidate) -> Candidate | None:
    """The best single effect that is not among the chosen."""
    wrong = [c for c in found.singles if not set(c.names) & set(chosen.names)]
    return max(wrong, key=lambda c: c.log_evidence, default=None)


def _elsewhere(chosen: Candidate, unknown: Active | None, other: OtherTest) -> diagnosis.OtherTest | None:
    """The other test without and with the effects, their constants frozen and its own free."""
    observed, bench = other.observed, Bench(other.observed)
    made = frozen(other.hypothesis, chosen.fit) if unknown is None else with_learnt(other.hypothesis, chosen, unknown)
    without, explained = (bench.compared(h) for h in (other.hypothesis, made))
    if without is None or explained is None:
        return None
    base, after = without.fit, explained.fit
    gaps = [total_gap(f, observed) for f in (base, after)]
    return diagnosis.OtherTest(
        test=other.name,
        closed_fraction=closed(*gaps),
        before=root_mean_square(base, observed),
        after=root_mean_square(after, observed),
    )
