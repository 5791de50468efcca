"""Plots that stand by themselves look in rsvg, which knows no variables of style sheets, as they do in Chromium.

Skips where one of them is not here, unless HFA_REQUIRE_BROWSER is set: then their absence is a failure.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import matplotlib.image as mpimg
import numpy as np
import pytest
from numpy.typing import NDArray
from tests.report.browser import CHROMIUM, browser

from hfanalysis.charts.colors import COLORS, STYLES
from hfanalysis.charts.style import alone
from hfanalysis.simulation.plots import PlottedCurve, chart

WIDTH, HEIGHT, BLOCK = 960, 320, 8
RSVG = shutil.which("rsvg-convert")


@pytest.fixture
def drawn() -> str:
    """A line, and one within a band."""
    x = np.linspace(0.0, 10.0, 80)
    wave = np.cos(x)
    curves = [PlottedCurve(x, np.sin(x), "one"), PlottedCurve(x, wave, "two", band=(wave - 0.2, wave + 0.2))]
    return chart("Two waves", "time [s]", "height [m]", curves)


def test_its_colors_are_themselves_and_no_variables(drawn: str) -> None:
    assert "var(" not in drawn
    assert ElementTree.fromstring(drawn).tag.endswith("svg")
    for style in STYLES:
        assert f".line{'.' + style}, .level{'.' + style} {{ stroke: {COLORS[style][0]}; }}" in alone()
    assert not re.search(r"body|header|nav", alone())


def seen(path: Path) -> NDArray[np.float64]:
    """The picture in gray, as means of blocks: letters differ from program to program, what is drawn does not."""
    gray = np.asarray(mpimg.imread(path), dtype=float)[:HEIGHT, :WIDTH, :3].mean(axis=2)
    return gray.reshape(HEIGHT // BLOCK, BLOCK, WIDTH // BLOCK, BLOCK).mean(axis=(1, 3))


def test_rsvg_shows_what_chromium_shows(drawn: str, tmp_path: Path) -> None:
    for name, found in (("rsvg-convert", RSVG), ("Chromium", CHROMIUM)):
        if found is None:
            if os.environ.get("HFA_REQUIRE_BROWSER"):
                pytest.fail(f"no {name} here, and HFA_REQUIRE_BROWSER asks for one")
            pytest.skip(f"no {name} here")
    path = tmp_path / "plot.svg"
    path.write_text(drawn, encoding="utf-8")
    subprocess.run([str(RSVG), "-w", str(WIDTH), str(path), "-o", str(tmp_path / "rsvg.png")], check=True)
    with browser(tmp_path / "profile") as page:
        page.open(path, WIDTH, HEIGHT).picture(tmp_path / "chromium.png", whole=False)
    one, other = seen(tmp_path / "rsvg.png"), seen(tmp_path / "chromium.png")
    inside = np.s_[6:33, 8:100]  # the drawing itself, without its letters
    assert np.std(one[inside]) > 0.02  # something is drawn
    assert np.abs(one - other)[inside].max() < 0.08
    assert np.corrcoef(one[inside].ravel(), other[inside].ravel())[0, 1] > 0.98
