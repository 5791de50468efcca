"""What is named, in valleys of its constants that are as deep as each other."""

from __future__ import annotations

from dataclasses import replace

import pytest
from tests.diagnose.answer.test_verdict import eroded

from hfanalysis.diagnose.naming import polish
from hfanalysis.diagnose.naming.polish import DEEPER
from hfanalysis.inference.candidate import Candidate


def of_n(x: float, deeper: float) -> Candidate:
    """The named explanation with n so many standard deviations of its prior off, so much deeper in log evidence."""
    named = eroded().singles[0]
    place = named.fit.hypothesis.names.index("n")
    moved = named.fit.x.copy()
    moved[place] = x
    moved_fit = replace(named.fit, x=moved, log_evidence=named.fit.log_evidence + deeper)
    return replace(named, fit=moved_fit, log_evidence=named.log_evidence + deeper)


@pytest.mark.parametrize(("deeper", "told"), [(0.0, 0.7), (0.1, 0.7), (-0.1, 0.7), (2.0 * DEEPER, 1.3)])
def test_of_valleys_as_deep_as_each_other_the_usual_is_told(
    deeper: float, told: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench = eroded().bench
    monkeypatch.setattr(bench, "judged", lambda c: c)
    monkeypatch.setattr(bench, "told", lambda c: c)
    for one, other in ((of_n(0.7, 0.0), of_n(1.3, deeper)), (of_n(1.3, deeper), of_n(0.7, 0.0))):
        found = polish._deeper_or_usual(one, [other], bench)
        assert found.fit.x[found.fit.hypothesis.names.index("n")] == told


def test_a_named_explanation_does_not_end_in_a_worse_valley() -> None:
    """Begun from a fit whose n was bent far off, the search comes back to the valley of the whole fit."""
    found = eroded()
    named = found.singles[0]
    again = polish.deepest(of_n(1.5, -40.0), [named], found.bench, exponents=False)
    assert again.log_evidence >= named.log_evidence - DEEPER
