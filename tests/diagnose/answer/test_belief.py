"""How probable an effect has to be for what is said of it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from hfanalysis.diagnose.answer import verdict
from hfanalysis.diagnose.answer.verdict import _chosen, _claimed
from hfanalysis.diagnose.naming.naming import Naming
from hfanalysis.inference.candidate import Candidate


@pytest.mark.parametrize(
    ("none", "evidence", "label"),
    [
        (0.13, 12.0, "tank_heat"),
        (0.17, 12.0, "none"),
        (0.25, 12.0, "none"),
        (0.05, 2.0, "none"),
        (0.02, 12.0, "tank_heat"),
    ],
)
def test_an_effect_is_claimed_where_at_most_one_in_seven_such_claims_is_a_wrong_alarm(
    none: float, evidence: float, label: str
) -> None:
    """And where it has evidence of its own."""
    posterior = {"none": none, "tank_heat": 0.9 - none, "n2_purge": 0.1}
    assert _claimed(posterior, {"none": 0.0, "tank_heat": evidence, "n2_purge": 1.0}) == label


@pytest.mark.parametrize(("alone", "names"), [(0.22, ("tank_heat", "n2_purge")), (0.38, ("tank_heat",))])
def test_a_second_effect_is_claimed_unless_one_alone_has_a_third_of_the_probability(
    alone: float, names: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    fit: Any = None
    single, pair = Candidate(("tank_heat",), fit, 10.0), Candidate(("tank_heat", "n2_purge"), fit, 11.0)
    monkeypatch.setattr(verdict, "weights_of", lambda named, _: [alone, 1.0 - alone])
    monkeypatch.setattr(verdict, "left_by_laws", lambda *_: 0.0)  # errors of the first's law aside
    named = SimpleNamespace(leftover=1.0)
    found = SimpleNamespace(singles=(single,), sets=(pair,), base=None, named=named)
    assert _chosen(cast(Naming, found), "tank_heat").names == names
