"""The kinds of unknown, and that a further one is one file more."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.inference import logged, made

from hfanalysis.diagnose.answer.source_places import of_unknown
from hfanalysis.diagnose.answer.words import place_sentence
from hfanalysis.diagnose.naming.plain import plain_sources
from hfanalysis.effects import effect
from hfanalysis.engine.effect import EQUATIONS
from hfanalysis.inference import unknowns
from hfanalysis.inference.candidate import Bench, candidate
from hfanalysis.inference.fitting.fit import fit
from hfanalysis.inference.fitting.form import FINEST
from hfanalysis.inference.unknown import Described, LinearUnknown, has_name

WORN = '''
"""A throat that is wider than stated, as a made-up channel would tell."""

from dataclasses import dataclass

import numpy as np

from hfanalysis.engine.effect import Parameter
from hfanalysis.engine.sites import RATES, THROAT_FACTOR, term
from hfanalysis.inference.fitting.hypothesis import Free
from hfanalysis.inference.places import SourcePlace
from hfanalysis.inference.unknown import Described, History, nameless_effect
from hfanalysis.quantity import Quantity


@term
def _wider(hook, t, env, c, p, x, site, dx):
    if hook == RATES:
        site[THROAT_FACTOR] *= 1.0 + p[0]


EFFECT = nameless_effect("worn", "nozzle", "a worn throat", (Parameter("part", "-", "of its area", 0.05),), term=_wider)


@dataclass(frozen=True)
class WornThroat(Described):
    part: float
    log_evidence: float
    place = SourcePlace("worn throat", "nozzle", "1", 0.05)
    known_by = "wider_by"

    @classmethod
    def in_samples(cls, samples):
        return cls(0.03, 12.0) if "thrust" in samples.signals else None

    def added_to(self, fitted):
        active = EFFECT.at(part=self.part)
        return fitted.hypothesis.with_active(active, (Free("probe_worn.part", self.part, 0.02),)), np.zeros(1)

    def history(self, fitted, observed):
        part, std = fitted.values["probe_worn.part"], fitted.stds["probe_worn.part"]
        time = np.linspace(0.0, observed.last, 50)
        sizes = {"wider_by": Quantity(part, "1", std)}
        return History(self.place, time, np.full(50, part), np.full(50, std), 0.1, sizes)

    @staticmethod
    def words(row, known, where, unit):
        return f"The throat is {100.0 * known.value:.0f} % wider."


UNKNOWN = WornThroat
'''


@pytest.fixture
def with_worn_throat(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A seventh file beside the others."""
    (tmp_path / "worn_throat.py").write_text(WORN)
    monkeypatch.setattr(unknowns, "__path__", [*unknowns.__path__, str(tmp_path)])
    unknowns.kinds.cache_clear()
    yield
    unknowns.kinds.cache_clear()
    sys.modules.pop(f"{unknowns.__name__}.worn_throat", None)


def test_there_are_six_and_no_two_have_words_for_the_same() -> None:
    assert [kind.__module__.rpartition(".")[2] for kind in unknowns.kinds()] == [
        "failing_flow", "late_channel", "pulse", "slow_valve", "smooth_source", "swing",
    ]  # fmt: skip
    known_by = [kind.known_by for kind in unknowns.kinds() if issubclass(kind, Described)]
    assert len(set(known_by)) == len(known_by) == 4
    for kind in unknowns.kinds():
        assert issubclass(kind, LinearUnknown) or kind.place.equation in EQUATIONS


def test_an_unknown_of_one_file_is_seen_fitted_drawn_and_said(with_worn_throat: None) -> None:
    shown = logged.reduced().unknowns
    assert [type(unknown).__name__ for unknown in shown] == ["WornThroat"]
    wider = replace(made.observed(effect("nozzle_throat_erosion").at(rate=1e-4)), unknowns=shown)
    bench = Bench(wider)
    base = candidate((), fit(made.hypothesis(), wider), FINEST)
    (found,) = plain_sources(base, base, bench)
    assert found.names == ("worn throat",)
    assert found.unknown
    assert found.log_evidence > base.log_evidence + 12.0
    assert not [a for a in found.fit.burnt.steps.engine.effects if has_name(a.effect)]
    row = of_unknown(found.history(wider), 1.0, wider.phases)
    assert (row.equation, row.site) == ("nozzle", "worn throat")
    assert np.ptp(row.history.mean) == 0.0
    assert place_sentence(row) == f"The throat is {100.0 * row.wider_by.value:.0f} % wider."
