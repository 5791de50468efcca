"""The picture of a number of many tests in order."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from hfanalysis.campaign.individuals import individuals
from hfanalysis.quantity import Quantity


def course(values: list[float]) -> dict[str, Quantity]:
    return {f"T{i}": Quantity(value, "", 0.002, (value - 0.004, value + 0.004)) for i, value in enumerate(values)}


def test_each_test_has_its_dot_and_the_one_beyond_the_limits_its_name() -> None:
    values = [0.300, 0.302, 0.301, 0.303, 0.300, 0.301, 0.302, 0.300, 0.36, 0.301]
    picture = ET.fromstring(individuals("C_i", course(values)))
    assert len(picture.findall("circle")) == 10
    words = [text.text for text in picture.findall("text")]
    assert "T8" in words
    assert "T3" not in words
    levels = [path for path in picture.findall("path") if path.get("class") == "level"]
    assert len(levels) == 3  # the limits, and the middle of the moves


@pytest.mark.parametrize("values", [[0.3] * 7, [0.3] * 20])
def test_without_limits_there_is_no_picture(values: list[float]) -> None:
    assert individuals("C_i", course(values)) == ""


def test_of_hundreds_it_has_no_bars_and_stays_in_its_frame() -> None:
    rng = np.random.default_rng(2)
    picture = ET.fromstring(individuals("K_loss", course(list(rng.normal(5e8, 1e7, 500)))))
    bars = [path for path in picture.findall("path") if path.get("class") == "line C_i"]
    assert len(bars) == 499  # the moves alone
    assert all(0.0 <= float(dot.get("cx", "-1")) <= 640.0 for dot in picture.findall("circle"))
