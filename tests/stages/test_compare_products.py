"""Products of two versions are compared number by number, and what moved is seen."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from benchmarks.compare_products import main

QUANTITY = {"value": 0.75, "std": 0.01, "ci95": [0.73, 0.77], "unit": "", "verdict": "identified"}


def _written(folder: Path, *, change: Callable[[dict[str, Any]], None] | None = None, history: float = 0.0) -> Path:
    product: dict[str, Any] = {
        "m": dict(QUANTITY),
        "burn_time": {"value": 17.0, "std": None},
        "effects": [{"name": "leak", "size": 1.0}, {"name": "tank_heat", "size": 2.0}],
        "provenance": {"code": str(folder)},
    }
    if change:
        change(product)
    (folder / "HF5" / ".state").mkdir(parents=True)
    (folder / "HF5" / ".state" / "calibrate.json").write_text(json.dumps({"at": str(folder)}))
    (folder / "HF5" / "calibration.json").write_text(json.dumps(product))
    with h5py.File(folder / "HF5" / "performance.h5", "w") as file:
        file.attrs["provenance"] = str(folder)
        file["p_tank"] = np.array([0.0, 2e6, 5e6]) + history
        file["flow"] = np.array([1.0, 1.0]) + history
        file["flow_low95"], file["flow_high95"] = np.array([0.9, 0.9]), np.array([1.1, 1.1])
    return folder


def _compared(
    tmp_path: Path, *options: str, change: Callable[[dict[str, Any]], None] | None = None, **made: float
) -> int:
    before, after = _written(tmp_path / "before"), _written(tmp_path / "after", change=change, **made)
    return main([str(before), str(after), *options])


def test_the_same_numbers_of_other_code_are_no_difference(tmp_path: Path) -> None:
    assert _compared(tmp_path, "--moves") == 0


@pytest.mark.parametrize(("share", "differs"), [(0.9e-2, 0), (1.1e-2, 1)])
def test_a_quantity_may_move_by_a_hundredth_of_its_std(tmp_path: Path, share: float, differs: int) -> None:
    def moved(product: dict[str, Any]) -> None:
        product["m"]["value"] += share * QUANTITY["std"]  # type: ignore[operator]

    assert _compared(tmp_path, change=moved) == differs


@pytest.mark.parametrize(("relative", "options", "differs"), [(9e-7, (), 0), (2e-6, (), 1), (9e-7, ("--moves",), 1)])
def test_one_without_std_may_not(tmp_path: Path, relative: float, options: tuple[str, ...], differs: int) -> None:
    def moved(product: dict[str, Any]) -> None:
        product["burn_time"]["value"] *= 1.0 + relative

    assert _compared(tmp_path, *options, change=moved) == differs


@pytest.mark.parametrize(("history", "differs"), [(4e-4, 0), (6e-4, 1)])
def test_a_history_with_a_band_may_move_by_a_hundredth_of_its_std(tmp_path: Path, history: float, differs: int) -> None:
    """The flow's band is 0.1 to either side, its standard deviation 0.051; of a pressure's 50 bar both are nothing."""
    assert _compared(tmp_path, history=history) == differs


@pytest.mark.parametrize(
    "change",
    [
        lambda product: product["m"].pop("ci95"),
        lambda product: product["m"].update(value=None),
        lambda product: product["m"].update(verdict="unphysical"),
        lambda product: product.update(new=1.0),
        lambda product: product["effects"].pop(),
    ],
)
def test_what_is_missing_new_null_or_said_otherwise_is_a_difference(tmp_path: Path, change: Any) -> None:
    assert _compared(tmp_path, change=change) == 1


def test_words_may_differ_where_numbers_alone_are_asked_for(tmp_path: Path) -> None:
    assert _compared(tmp_path, "--numbers-only", change=lambda product: product["m"].update(verdict="doubted")) == 0


def test_the_order_of_named_parts_is_no_difference(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert _compared(tmp_path, change=lambda product: product["effects"].reverse()) == 0
    assert "/burn_time" not in capsys.readouterr().out


def test_a_key_is_named_with_both_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _compared(tmp_path, change=lambda product: product["effects"][1].update(size=3.0))
    assert "/effects/tank_heat/size: 0.33 relative, 2 -> 3" in capsys.readouterr().out


def test_a_product_of_one_side_only_is_a_difference(tmp_path: Path) -> None:
    before, after = _written(tmp_path / "before"), _written(tmp_path / "after")
    (after / "HF5" / "performance.h5").unlink()
    assert main([str(before), str(after)]) == 1
