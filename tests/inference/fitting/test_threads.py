"""Fits side by side give what they give one after the other."""

from __future__ import annotations

import threading

import pytest
from tests.diagnose.naming.test_naming import HIDDEN, catalogue
from tests.inference import made

from hfanalysis.diagnose.naming.naming import Naming, name_effects
from hfanalysis.inference.fitting import threads
from hfanalysis.inference.fitting.threads import each


def test_results_come_in_the_order_of_the_items(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "processors", lambda: 2)
    second = threading.Event()

    def squared(number: int) -> int:
        if number == 0:
            assert second.wait(10.0)  # the first ends after the second: they run side by side
        elif number == 1:
            second.set()
        return number**2

    assert each(squared, range(5)) == [0, 1, 4, 9, 16]
    assert each(squared, []) == []


def test_what_goes_wrong_in_one_is_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "processors", lambda: 2)
    with pytest.raises(ZeroDivisionError):
        each(lambda n: 1 / n, [1, 0])


def test_a_naming_does_not_depend_on_the_number_of_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    def run(count: int) -> Naming:
        monkeypatch.setattr(threads, "processors", lambda: count)
        tried = catalogue(("nozzle_throat_erosion", "tank_heat"))
        return name_effects(made.hypothesis(), made.observed(*HIDDEN["nozzle_throat_erosion"]), tried)

    one, two = run(1), run(2)
    assert [(c.names, c.log_evidence) for c in one.all] == [(c.names, c.log_evidence) for c in two.all]
