"""Engines of which areas and volumes are known in part: stated as ranges, they are constants with that prior."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from pathlib import Path

import pytest
from benchmarks.real_logs.ranges import written
from tests.acceptance.test_real_logs import LOGS
from tests.inference.adopted.firing import make_root

from hfanalysis.diagnose.without_law import with_start
from hfanalysis.inference.candidate import Bench
from hfanalysis.inference.half_known import ranges, with_ranges
from hfanalysis.quantity import Quantity
from hfanalysis.record.schema import changed
from hfanalysis.stages.diagnose import subject_of
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to
from hfanalysis.units import Value

THROAT = 23.3e-3
"""The true radius of T1's throat [m]; stated is 24.3 mm, 9 % more of area."""


def stated(root: Path, old: str, new: str) -> None:
    """Change what T1 states."""
    path = root / "raw_tests" / "T1" / "test.toml"
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")


def test_a_throat_stated_as_a_range_is_found_within_it(tmp_path: Path) -> None:
    root = make_root(tmp_path)
    stated(root, '"23.3 mm"', '"24.3 mm +/- 5 %"')
    stated(root, '"0.218 L"', '"0.3 L +/- 50 %"')
    context = run_to("calibrate", open_test(root, "T1"))
    assert any("+/- of [chamber] pre_volume is a range for hfa diagnose" in w for w in context.definition.warnings)
    hypothesis, observed = subject_of(context).compared()
    fitted = Bench(observed).settled(hypothesis)
    assert fitted is not None
    found, std = fitted.fit.values["throat_area"], fitted.fit.stds["throat_area"]
    assert abs(found - pi * THROAT**2) < 2.5 * std
    assert std < 0.3 * 2.0 * 0.05 * found
    assert fitted.leftover < 1.5


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = make_root(tmp_path_factory.mktemp("plain"))
    run_to("calibrate", open_test(root, "T1"))
    return root


def test_only_a_stated_range_is_free_and_volumes_add_up(plain: Path) -> None:
    subject = subject_of(run_to("calibrate", open_test(plain, "T1")))
    definition = subject.definition
    assert ranges(definition) == {}
    chamber, nozzle = definition.chamber, definition.nozzle
    assert chamber is not None
    assert nozzle is not None
    known = changed(
        definition,
        chamber=changed(chamber, pre_volume=Value(2e-4, 3e-5), post_volume=Value(8e-4, 4e-5)),
        nozzle=changed(nozzle, throat_radius=Value(0.02, 1e-3)),
    )
    assert ranges(known) == pytest.approx({"dead_volume": 0.05, "throat_area": 0.1})
    free = {f.name: f for f in with_ranges(subject.hypothesis(), known).free}
    assert free["throat_area"].value(0.0) == pytest.approx(pi * 0.0233**2)
    assert free["throat_area"].value(1.0) == pytest.approx(1.1 * pi * 0.0233**2)


def test_without_a_and_n_a_fit_starts_near_the_calibrated_engine_unless_the_chamber_cannot_be_believed(
    plain: Path,
) -> None:
    subject = subject_of(run_to("calibrate", open_test(plain, "T1")))
    base = subject.calibration
    assert base is not None
    assert with_start(subject) is subject
    none = Quantity.absent("no saturated tank comes down")
    without = replace(subject, calibration=base.but(a=none, n=none))
    started = with_start(without)
    assert started.start is not None
    assert "no saturated tank comes down" in started.notes[-1]
    calibrated = subject.hypothesis().engine
    assert started.start.temperature == pytest.approx(calibrated.temperature, abs=1.5)
    nozzle = subject.definition.nozzle
    assert nozzle is not None
    wide = changed(subject.definition, nozzle=changed(nozzle, throat_radius=Value(0.06), exit_radius=Value(0.1)))
    assert with_start(replace(without, definition=wide)).start is None


@pytest.mark.parametrize(
    ("test", "why"),
    [("MRT-HF3.1", ""), ("MRT-HF3.4", "no saturated tank of 11.40 kg in 15.3 L comes down to 56.3 bar")],
)
def test_a_real_firing_with_ranges_has_an_engine_and_the_base_model_does_not_come_near_it(
    test: str, why: str, tmp_path: Path
) -> None:
    if not (LOGS / test / "log.csv").is_file():
        pytest.skip(f"no log of {test} in {LOGS}")
    written(test, LOGS, tmp_path)
    subject = subject_of(run_to("calibrate", open_test(tmp_path, test)))
    assert why in "".join(subject.notes)
    assert not why or subject.start is not None
    hypothesis, observed = subject.compared()
    assert {"throat_area", "exit_area", "dead_volume"} <= set(hypothesis.names)
    fitted = Bench(observed).compared(hypothesis)
    assert fitted is not None
    assert fitted.leftover > 2.0
