"""The pictures of README and documentation: `make pictures`. HF5's pressures, and its page as a browser shows it."""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

import hfanalysis
from hfanalysis.report.pdf import find_browser

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
WINDOW = "1200,1000"
"""Width and height of the window [pixels]."""


def main() -> None:
    """Both, from the tests of raw_tests/; products go to a folder of their own."""
    with tempfile.TemporaryDirectory() as out:
        firing = hfanalysis.open("HF5", ROOT, out)
        firing.plot.pressures().savefig(DOCS / "hf5.png", dpi=90, metadata={"Software": None})
        page = firing.run("report").folder / "report.html"
        target = f"--screenshot={DOCS / 'hf5-page.png'}"
        options = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", f"--window-size={WINDOW}"]
        shot = [find_browser(), *options, target, page.resolve().as_uri()]
        subprocess.run(shot, check=True, capture_output=True, timeout=120)


if __name__ == "__main__":
    main()
