"""A base model that no other fit stands above: fitted again from where its children have come to.

A base model in a wrong valley is beaten by each of its children, whatever they are of, for they have come out of it:
that is no evidence for what they add. So the base model is fitted again with the constants of every child that stands
above it, and where one of these fits is deeper it is the base model, from which all is looked for anew. What is named
is fitted again from other constants in the same way.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.naming.base_model import FROM_EXPONENTS, NEARLY, SAME, same_valley
from hfanalysis.inference.candidate import SHORT, Bench, Candidate, attempted, candidate, followed
from hfanalysis.inference.fitting.form import Form
from hfanalysis.inference.fitting.threads import each

DEEPER = 0.5
"""Log evidence [natural log] by which a fit from a child's constants has to stand above the base model to take its
place: fits end within a tenth of that."""

ABOVE = 2.0
"""Log evidence above the base model from which on a child's constants are tried."""

ROUNDS = 2
"""Times that all is looked for anew at most."""


def polished(base: Candidate, children: Iterable[Candidate], bench: Bench) -> Candidate:
    """The base model, or the deepest fit of it from the constants of its ``children``, told as it is."""
    starts = _starts(base, [c for c in children if c.log_evidence > base.log_evidence + ABOVE])
    hypothesis, observed = base.fit.hypothesis, bench.at(base.form)
    fits = each(lambda x: attempted(hypothesis, observed, x, SHORT), starts)
    tried = [candidate((), found, base.form) for found in fits if found is not None]
    return _deeper(base, tried, bench)


def _starts(base: Candidate, children: Sequence[Candidate]) -> list[np.ndarray]:
    """Constants of children (parameters of the base model,), each valley once, that of the best first."""
    size, out = base.fit.x.size, list[np.ndarray]()
    for child in sorted(children, key=lambda c: -c.log_evidence):
        x = child.fit.x[:size]
        if all(np.abs(x - other).max() > SAME for other in (base.fit.x, *out)):
            out.append(x)
    return out


def deepest(named: Candidate, others: Iterable[Candidate], bench: Bench, exponents: bool) -> Candidate:
    """A named explanation, or the deepest fit of it from other constants: those of ``others`` that hold all of its
    effects, and, if asked, other ``exponents`` of the regression law, once all else has followed, and a step coarser.

    As the base model's, its constants have more than one valley, and which one a search comes to the last digits
    decide.
    """
    starts = [partial(_at, named, named.form, x, bench) for x in _shared(named, others)]
    if exponents:
        forms = {named.form, *(named.form.coarser(tank, not tank) for tank in (True, False))}
        from_there = (None, *FROM_EXPONENTS) if "n" in named.fit.hypothesis.names else (None,)
        which = [(form, e) for form in sorted(forms) for e in from_there if form != named.form or e is not None]
        starts += [partial(_at, named, form, named.fit.x, bench, exponent) for form, exponent in which]
    besides = named.log_evidence - candidate(named.names, named.fit, named.form, named.source).log_evidence
    tried = [found for found in each(lambda one: one(), starts) if found is not None]
    return _deeper_or_usual(named, [replace(c, log_evidence=c.log_evidence + besides) for c in tried], bench)


def _deeper_or_usual(named: Candidate, tried: Sequence[Candidate], bench: Bench) -> Candidate:
    """The deepest of a named explanation and what was tried in its place, each brought to its end; of valleys that are
    as deep as it the one whose n is nearest to what is known of fuels, or the last digits would decide."""
    valleys = [named]
    least = max((named, *tried), key=lambda c: c.log_evidence).log_evidence - NEARLY
    for one in sorted(tried, key=lambda c: -c.log_evidence):
        if one.log_evidence > least and not any(same_valley(one.fit, other.fit) for other in valleys):
            valleys.append(bench.told(bench.judged(one)))
    deepest_of = max(valleys, key=lambda c: c.log_evidence)
    alike = [c for c in valleys if c.log_evidence > deepest_of.log_evidence - DEEPER]
    if "n" not in named.fit.hypothesis.names:
        return deepest_of
    place = named.fit.hypothesis.names.index("n")
    return min(alike, key=lambda c: abs(float(c.fit.x[place])))


def _at(named: Candidate, form: Form, x: Array, bench: Bench, exponent: float | None = None) -> Candidate | None:
    """A named explanation fitted at a form from other parameters; if asked, from another exponent of the regression
    law, once all else has followed."""
    made, observed, start = named.fit.hypothesis, bench.at(form), x.copy()
    if exponent is None:
        found = attempted(made, observed, start, SHORT)
    else:
        place = made.names.index("n")
        start[place] = exponent
        found = followed(made, slice(place, place + 1), observed, start)
    return None if found is None else candidate(named.names, found, form, named.source)


def _shared(named: Candidate, others: Iterable[Candidate]) -> list[Array]:
    """Parameters of a named explanation as others have them that hold all of its effects, each valley once."""
    out = list[Array]()
    for other in others:
        at = {name: i for i, name in enumerate(other.fit.hypothesis.names)}
        if other is named or not set(named.fit.hypothesis.names) <= set(at):
            continue
        x = other.fit.x[[at[name] for name in named.fit.hypothesis.names]]
        if all(np.abs(x - known).max() > SAME for known in (named.fit.x, *out)):
            out.append(x)
    return out


def _deeper(found: Candidate, tried: Iterable[Candidate], bench: Bench) -> Candidate:
    """The best of what was tried where it lies deeper than a candidate that is told as it is, or that."""
    best = max(tried, key=lambda c: c.log_evidence, default=found)
    if best.log_evidence <= found.log_evidence + DEEPER:
        return found
    return max(found, bench.told(bench.judged(best)), key=lambda c: c.log_evidence)


class NotConvergedError(AssertionError):
    """A search that did not converge where that must not be: in tests and benchmarks."""


def not_converged(risen: float) -> str | None:
    """Why a search did not converge of which the base model has ``risen`` in log evidence after all had been compared
    with it; None where it did."""
    if risen <= DEEPER:
        return None
    return f"the base model came to lie {risen:.1f} deeper in log evidence after all had been compared with it"


def assert_converged(why: str | None) -> None:
    """Raises NotConvergedError where a search did not converge, for ``why``."""
    if why is not None:
        raise NotConvergedError(why)
