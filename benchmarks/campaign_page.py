"""The page of a campaign of a thousand tests: how soon it is made and open in Chromium, sorted and filtered.

python -m benchmarks.campaign_page [--tests 1000] [--own 8] [--out FILE]

``--own`` tests are generated (HF5 at 20 Hz, each with noise of its own) and calibrated; the others are these under
other names, each with constants off by chance, on three stands.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from dataclasses import replace
from datetime import date, timedelta
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.archive import generate
from benchmarks.studies import one_thread
from tests.report.browser import CHROMIUM, browser

STANDS = 3


def campaign_of(root: Path, own: int, count: int) -> tuple[Any, float]:
    """``count`` tests on three stands, ``own`` of them calibrated below ``root``, the others these off by chance; and
    the seconds that it takes to say what they say together."""
    from hfanalysis.campaign.product import row_of, stand_row
    from hfanalysis.campaign.side_by_side import Ended
    from hfanalysis.products.campaign import Campaign
    from hfanalysis.stages.open_test import open_test
    from hfanalysis.stages.runner import run_to

    folder, names, rng = root / "processed", [f"G{i:03d}" for i in range(own)], np.random.default_rng(57)
    for seed, name in enumerate(names):
        generate(root, name, seed)
        run_to("validate", open_test(root, name))
        print(f"\r{seed + 1} of {own} tests generated", end="", file=sys.stderr)
    made = [row_of(open_test(root, name).definition, folder / name, Ended(0, "")) for name in names]
    rows = {f"T{i:04d}": another(made[i % own], i, rng) for i in range(count)}
    for i, name in enumerate(rows):
        (folder / name).symlink_to(folder / names[i % own])
    begun = time.perf_counter()
    by_stand = {f"stand {i}": {t: r for t, r in rows.items() if r.stand == f"stand {i}"} for i in range(STANDS)}
    said = {stand: stand_row(of, folder) for stand, of in by_stand.items() if of}
    return Campaign(tests=rows, stands=said), time.perf_counter() - begun


def another(row: Any, number: int, rng: np.random.Generator) -> Any:
    """A test's row on another day and stand, its numbers off by their deviations."""
    numbers = {"calibration": row.calibration, "performance": row.performance}
    moved = {what: {name: off(quantity, rng) for name, quantity in found.items()} for what, found in numbers.items()}
    return row.but(date=str(date(2026, 1, 1) + timedelta(days=number)), stand=f"stand {number % STANDS}", **moved)


def off(quantity: Any, rng: np.random.Generator) -> Any:
    """A quantity off by its deviation."""
    if quantity.value is None or not quantity.std:
        return quantity
    by = quantity.std * float(rng.standard_normal())
    low, high = quantity.interval or (quantity.value, quantity.value)
    return replace(quantity, value=quantity.value + by, ci95=(low + by, high + by))


def used(path: Path, profile: Path) -> str:
    """How soon the page is open, and what is done with it, in words."""
    with browser(profile) as tab:
        begun = time.perf_counter()
        tab.open(path)
        opened = time.perf_counter() - begun
        spent = {what: 1e3 * tab.ask(TIMED.format(do=do)) for what, do in USED.items()}
        if tab.console:
            raise SystemExit(f"the page complains: {tab.console}")
    return f"open and drawn in {opened:.2f} s; " + ", ".join(f"{what} in {ms:.0f} ms" for what, ms in spent.items())


def main() -> int:
    """Make it, open it, and use it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tests", type=int, default=1000)
    parser.add_argument("--own", type=int, default=8)
    parser.add_argument("--out", type=Path, help="where the page is kept")
    asked = parser.parse_args()
    one_thread()
    from hfanalysis.campaign.page import page

    with tempfile.TemporaryDirectory() as scratch:
        root = Path(scratch)
        product, took = campaign_of(root, asked.own, asked.tests)
        begun = time.perf_counter()
        text = page(product)
        took += time.perf_counter() - begun
        print(f"\n{asked.tests} tests of {STANDS} stands: {len(text) / 1e6:.1f} MB, made in {took:.1f} s")
        path = (asked.out or root / "campaign.html").resolve()
        path.write_text(text, encoding="utf-8")
        print(used(path, root / "profile") if CHROMIUM else "no Chromium: the page was not opened")
    return 0


TIMED = """(async () => {{
  const begun = performance.now();
  {do}
  await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  return (performance.now() - begun) / 1000;
}})()"""
"""Seconds until what was done is drawn."""

HEADS = "[...document.querySelectorAll('#tests th .sort')]"

USED = {
    "sorted by impulse": HEADS + ".find((head) => head.textContent === 'total impulse').click();",
    "sorted by name": HEADS + "[0].click();",
    "filtered": (
        "const field = document.querySelector('.filter input'); field.value = 'T0123';"
        " field.dispatchEvent(new Event('input'));"
    ),
}


if __name__ == "__main__":
    sys.exit(main())
