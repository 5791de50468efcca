"""Sets of effects, and what single effects learn from them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from tests.inference import made

from hfanalysis.diagnose.naming import several
from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.diagnose.naming.search import Search
from hfanalysis.diagnose.naming.several import _loosened, by_what_each_explains, sets_of
from hfanalysis.effects import effect
from hfanalysis.inference.candidate import Bench, Candidate, candidate
from hfanalysis.inference.fitting.fit import fit
from hfanalysis.inference.fitting.form import FINEST

EROSION, LAG = (effect(name) for name in ("nozzle_throat_erosion", "chamber_tap_lag"))


@cache
def bench() -> Bench:
    return Bench(made.observed(EROSION.at(rate=1e-4), LAG.at(lag=0.03)))


def eroding(steps: int, start: tuple[float, ...]) -> Candidate:
    """The throat's erosion alone, fitted for a few steps from some constants."""
    hypothesis = made.hypothesis().with_effect(EROSION)
    x = np.zeros(hypothesis.size)
    x[: len(start)] = start
    return candidate((EROSION.name,), fit(hypothesis, bench().observed, x, steps), FINEST)


def test_a_single_effect_that_was_stuck_goes_on_from_where_a_pair_led() -> None:
    """That the pair is not worth its price makes no difference."""
    search = Search(bench(), Catalogue({e.name: e for e in (EROSION, LAG)}, {}))
    base = candidate((), fit(made.hypothesis(), bench().observed), FINEST)
    best = eroding(25, (*base.fit.x, 0.3))
    stuck = eroding(1, (*base.fit.x, 1.5))
    assert stuck.log_evidence < best.log_evidence - 10.0
    (again,), _ = sets_of(base, [stuck], search)
    (same,), _ = sets_of(base, [best], search)
    assert again.fit.log_evidence == pytest.approx(same.fit.log_evidence, abs=0.5)
    assert again.log_evidence == pytest.approx(same.log_evidence, abs=0.5)


def test_a_set_is_named_for_what_explains_most_whichever_it_was_come_upon_from() -> None:
    one = eroding(1, ())
    erosion, lag = replace(one, log_evidence=75.0), replace(one, names=(LAG.name,), log_evidence=12.0)
    both = replace(one, names=(LAG.name, EROSION.name), log_evidence=79.0)
    assert by_what_each_explains(both, [erosion, lag]).names == (EROSION.name, LAG.name)
    assert by_what_each_explains(both, [lag]).names == (LAG.name, EROSION.name)


def test_what_is_hardly_there_has_no_slack_to_speak_of(monkeypatch: pytest.MonkeyPatch) -> None:
    """What slack brings the first it brings others in proportion: one at nothing stays with the base model."""
    monkeypatch.setattr(several, "slack_gain", lambda *_: 12.0)
    base = replace(eroding(1, ()), names=(), log_evidence=10.0)
    first, half, nothing, worse = (replace(base, log_evidence=e) for e in (50.0, 30.0, 10.0, 5.0))
    loose = [c.log_evidence for c in _loosened([first, half, nothing, worse], base, bench())]
    assert loose == pytest.approx([62.0, 36.0, 10.0, 5.0])
    assert _loosened([], base, bench()) == []
