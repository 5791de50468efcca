"""What is compared at last is run by its laws: which candidates, and that each stays itself."""

from __future__ import annotations

from dataclasses import replace
from typing import cast

from tests.diagnose.answer.test_verdict import eroded

from hfanalysis.diagnose.naming.own_laws import by_their_laws
from hfanalysis.inference.candidate import Bench, Candidate


class Raising:
    """A bench by which every candidate gains, once, and which remembers whom it was asked of."""

    def __init__(self, gain: float) -> None:
        self.gain, self.asked = gain, list[float]()

    def by_its_laws(self, found: Candidate) -> Candidate:
        self.asked.append(found.log_evidence)
        return replace(found, log_evidence=found.log_evidence + self.gain)


def at(*evidences: float) -> list[Candidate]:
    """Candidates of the same name."""
    return [replace(eroded().singles[0], log_evidence=evidence) for evidence in evidences]


def test_two_of_one_name_each_stay_themselves() -> None:
    bench = Raising(0.0)
    found = by_their_laws(at(0.0, 7.0, 3.0, -50.0), 10.0, cast(Bench, bench))
    assert [c.log_evidence for c in found] == [0.0, 7.0, 3.0, -50.0]
    assert sorted(bench.asked) == [0.0, 3.0, 7.0]


def test_those_that_come_near_by_what_the_best_loses_are_asked_as_well() -> None:
    bench = Raising(-8.0)
    found = by_their_laws(at(-40.0, 20.0, 5.0, -30.0), 10.0, cast(Bench, bench))
    assert [c.log_evidence for c in found] == [-48.0, 12.0, -3.0, -30.0]
    assert bench.asked == [-40.0, 20.0, 5.0]
