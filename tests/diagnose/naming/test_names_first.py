"""A name before an unknown: no source beside what is named before every effect was tried in its place, at its form."""

from __future__ import annotations

from dataclasses import replace

import pytest
from tests.diagnose.naming.test_naming import catalogue, named

from hfanalysis.diagnose.naming import naming
from hfanalysis.diagnose.naming.freeform import unknown_beside
from hfanalysis.diagnose.naming.several import MOST_EFFECTS
from hfanalysis.inference.candidate import Candidate, more_probable
from hfanalysis.inference.fitting.form import Form

BOTH = ("nozzle_throat_erosion", "tank_heat")


def test_what_a_source_took_for_its_own_gets_its_name() -> None:
    """Of two effects the search came upon one alone; what the other does, a source beside it takes up."""
    found = named("two")
    alone = found.singles[0]
    assert len(alone.names) == 1
    source = unknown_beside(found.base, alone, found.bench)[0]
    assert more_probable(source, alone)
    search = naming.Search(found.bench, catalogue())
    told, further, beside = naming._every_name_first(found.base, alone, list(found.singles), search)
    assert set(told.names) == set(BOTH)
    assert told is further[0]
    assert more_probable(told, source)
    assert not any(more_probable(c, told) for c in beside)


@pytest.mark.parametrize(("gain", "rounds"), [(50.0, MOST_EFFECTS - 1), (-50.0, 1)])
def test_it_goes_on_while_names_do_better_and_no_further_than_sets_go(
    monkeypatch: pytest.MonkeyPatch, gain: float, rounds: int
) -> None:
    found = named("tank_heat")
    (first, *_) = found.singles
    asked = list[Candidate]()

    def beside(base: Candidate, parent: Candidate, bench: object) -> list[Candidate]:
        return [replace(parent, names=(*parent.names, "valve"), log_evidence=parent.log_evidence + 20.0)]

    def in_its_place(source: Candidate, parent: Candidate, *_: object) -> list[Candidate]:
        asked.append(source)
        return [
            replace(parent, names=(*parent.names, f"e{len(asked)}"), log_evidence=parent.log_evidence + 20.0 + gain)
        ]

    monkeypatch.setattr(naming, "unknown_beside", beside)
    monkeypatch.setattr(naming, "sets_in_place_of", in_its_place)
    search = naming.Search(found.bench, catalogue())
    told, further, left = naming._every_name_first(found.base, first, [first], search)
    assert len(asked) == len(further) == rounds
    assert len(told.names) == (1 + rounds if gain > 0.0 else 1)
    assert left[0].names[:-1] == told.names


def test_the_form_is_the_same_from_a_finer_one_as_from_a_coarser_one() -> None:
    """At the finer form nothing is left open that would ask for more, and yet the coarser one is more probable."""
    found = named("tank_heat")
    base, bench = found.base, found.bench
    finer = bench.refitted(base, Form(base.form.tank, base.form.chamber - 1))
    assert finer is not None
    assert more_probable(base, finer)
    assert max(bench.at(finer.form).left_open(finer.fit.residual)) < 1.15
    assert bench.judged(bench.converged(finer)).form == base.form
