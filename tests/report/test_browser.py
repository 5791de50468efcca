"""The page in a real browser: it opens offline, complains about nothing, fits a phone, and hostile text stays text.

Skips where there is no Chromium, unless HFA_REQUIRE_BROWSER is set: then its absence is a failure.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import Image
from sample import material

from hfanalysis.report.page import page

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
HOSTILE = '<script>document.title="owned"</script>'
OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
    "--host-resolver-rules=MAP * ~NOTFOUND",
    "--enable-logging=stderr",
    "--virtual-time-budget=2000",
)

Browse = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def browse(tmp_path: Path) -> Browse:
    """Open a page's text in Chromium with further options; returns the finished process."""
    if CHROMIUM is None:
        if os.environ.get("HFA_REQUIRE_BROWSER"):
            pytest.fail("no Chromium here, and HFA_REQUIRE_BROWSER asks for one")
        pytest.skip("no Chromium here")

    def run(text: str, *options: str) -> subprocess.CompletedProcess[str]:
        path = tmp_path / "page.html"
        path.write_text(text, encoding="utf-8")
        command = [str(CHROMIUM), *OPTIONS, f"--user-data-dir={tmp_path / 'profile'}", *options, path.as_uri()]
        return subprocess.run(command, capture_output=True, text=True, timeout=90, check=True)

    return run


def test_the_browser_sees_the_whole_page_and_complains_about_nothing(browse: Browse, tmp_path: Path) -> None:
    done = browse(page(material(tmp_path)), "--dump-dom")
    for heading in ("Verdict", "Pressures", "Phases", "Calibration", "Made from"):
        assert re.search(rf"<h[12-4][^>]*>\s*{heading}", done.stdout), heading
    assert "CONSOLE" not in done.stderr
    assert "ERR_NAME_NOT_RESOLVED" not in done.stderr


def test_hostile_text_is_shown_as_text(browse: Browse, tmp_path: Path) -> None:
    done = browse(page(material(tmp_path, description=f"'{HOSTILE}'")), "--dump-dom")
    assert "<title>owned" not in done.stdout
    assert "&lt;script&gt;document.title" in done.stdout


@pytest.mark.parametrize(("width", "height"), [(1200, 1600), (390, 844)])
def test_a_screen_and_a_phone_show_text_on_a_plain_ground(
    browse: Browse, tmp_path: Path, width: int, height: int
) -> None:
    """A picture with one dominating ground colour, dark text on it, and nothing cut off at the right edge."""
    shot = tmp_path / "page.png"
    browse(page(material(tmp_path)), f"--screenshot={shot}", f"--window-size={width},{height}")
    picture = Image.open(shot).convert("L")
    histogram = picture.histogram()
    assert max(histogram) > 0.3 * width * height
    assert sum(histogram[:90]) > 0.005 * width * height
    edge = picture.crop((picture.width - 2, 0, picture.width, picture.height)).histogram()
    assert sum(edge[:90]) == 0


def test_the_page_prints(browse: Browse, tmp_path: Path) -> None:
    printed = tmp_path / "page.pdf"
    browse(page(material(tmp_path)), f"--print-to-pdf={printed}", "--no-pdf-header-footer")
    assert printed.read_bytes().startswith(b"%PDF")
    assert printed.stat().st_size > 10_000
