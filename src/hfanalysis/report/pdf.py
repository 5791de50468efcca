"""The page on paper: printed to PDF by a Chromium without a window."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

from hfanalysis.errors import InputError
from hfanalysis.products.disk import atomic

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")

_OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--no-first-run",
    "--no-pdf-header-footer",
)
_PATIENCE = 120.0
"""[s] after which a browser that hangs is given up."""


def find_browser() -> str:
    """The browser to print with; raises :class:`InputError` naming what is missing."""
    found = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    if found is None:
        raise InputError(
            f"--pdf: no browser to print with; expected one of {', '.join(BROWSERS)} on the PATH "
            "(Debian: apt install chromium), or print report.html from any browser"
        )
    return found


def print_page(page: Path, pdf: Path) -> Path:
    """Print ``page`` to ``pdf``, whole or not at all; raises :class:`InputError` where the browser will not."""
    browser = find_browser()
    with tempfile.TemporaryDirectory() as profile, atomic(pdf) as scratch:
        options = (*_OPTIONS, f"--user-data-dir={profile}", f"--print-to-pdf={scratch.resolve()}")
        why = _run([browser, *options, page.resolve().as_uri()])
        if not scratch.exists():
            raise InputError(f"--pdf: {browser} printed nothing ({why}); expected a Chromium that can print")
    return pdf


def _run(command: list[str]) -> str:
    """Why it may have failed, in the browser's words."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=_PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        return f"no answer within {_PATIENCE:.0f} s"
    except OSError as error:
        return str(error.strerror)
    lines = done.stderr.strip().splitlines()
    return lines[-1] if lines else f"exit status {done.returncode}"
