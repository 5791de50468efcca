"""Injectors that flash and choke: does a law that knows of it hold the truth, and what does the report's say?

Logs of simulated/feed.py, whose liquid reaches the injector as a boiling mixture and whose vapor chokes there; and the
replicas of the report's hot fires. Writes docs/feed-laws.md.

    python -m benchmarks.feed_laws [--write docs/feed-laws.md]
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from simulated.feed import CASES, Feed, definition_of, emptied, log_of, segments_of  # noqa: E402

from hfanalysis.calibrate.tank import calibrate  # noqa: E402
from hfanalysis.products.calibration import Calibration, TankConstants  # noqa: E402
from hfanalysis.quantity import Quantity  # noqa: E402
from hfanalysis.stages.open_test import open_test  # noqa: E402
from hfanalysis.stages.runner import run_to  # noqa: E402

SAMPLES = 400
HEAD = """# Feed laws: the report's, and what knows that liquid flashes and vapor chokes

Written by `make feed-laws`. What the laws are is in [calibration.md](calibration.md#what-reaches-the-injector).

## Logs whose truth is known

Tanks that empty through injectors which flash and choke (`simulated/feed.py`), sensors off by 0.15 bar (one standard
deviation), holes as stated. 95 % intervals; **bold**: the truth is not in it.

| injector | C_d of the liquid | by its law | C_i as if it were that |
|---|---|---|---|
"""
VAPOR = """
The vapor of the same logs. `m_choked` is for a C_d that is C_i: of the first and the fourth.

| injector | m | C_d of the vapor | `m`, report's law | `m_choked` | `vapor_C_d`, for m of 1.0 to 1.3 |
|---|---|---|---|---|---|
"""
REPLICAS = """
## The replicas of the report's hot fires

The report's numbers stay as they are; beside them:

| | HF4 | HF5 | why it differs |
|---|---|---|---|
"""
WHY = {
    "C_i": "the report's: on the density of the tank's liquid, an effective coefficient",
    "C_d.spi": "the mixture that reaches the injector has half of that density: the holes pass more of what they could",
    "C_d.hem": "in equilibrium the mixture chokes: the holes pass nearly all of it",
    "C_d.dyer": "half-way, as the inlet is saturated (kappa = 1)",
    "inlet.subcooling": "p_run is below saturation of what leaves the tank",
    "inlet.quality": "so much of the liquid has boiled in the line, at constant enthalpy",
    "inlet.density": "in place of the tank's liquid",
    "m": "the report's: vapor that flows as an incompressible fluid",
    "m_choked": "the vapor chokes, at half of that flow: it expands by itself, without tens of kilowatts, and steeper",
    "vapor_C_d": "m and C_d cannot be told apart; with an m of vapor this is its C_d",
}


def main() -> None:
    """Print the page, or write it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", type=Path)
    path = parser.parse_args().write
    page = "".join(_page())
    if path is None:
        print(page)
    else:
        path.write_text(page, encoding="utf-8")


def _page() -> Iterator[str]:
    found = {feed: _calibrated(feed) for feed in CASES}
    yield HEAD
    for feed, told in found.items():
        law = f"{_cell(told.C_d[feed.liquid], feed.C_d)} ({feed.liquid})"
        yield f"| {feed.name} | {feed.C_d:.2f} | {law} | {_cell(told.C_i, feed.C_d)} |\n"
    yield VAPOR
    for feed, told in found.items():
        choked = _cell(told.m_choked, feed.m if feed in (CASES[0], CASES[3]) else None)
        needed = _cell(told.vapor_C_d, feed.vapor_C_d)
        yield f"| {feed.name} | {feed.m:.2f} | {feed.vapor_C_d:.3g} | {_cell(told.m, feed.m)} | {choked} | {needed} |\n"
    yield REPLICAS
    tests = [_replica(name) for name in ("HF4", "HF5")]
    for name, why in WHY.items():
        cells = [_cell(_named(told, name)) for told in tests]
        yield f"| `{name}` | {' | '.join(cells)} | {why} |\n"


def _calibrated(feed: Feed) -> TankConstants:
    true = emptied(feed)
    return calibrate(log_of(feed, true), segments_of(true), definition_of(feed), SAMPLES).constants


def _replica(name: str) -> Calibration:
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        shutil.copytree(ROOT / "raw_tests" / name, root / "raw_tests" / name)
        return run_to("calibrate", open_test(root, name)).read(Calibration)


def _named(told: Calibration, name: str) -> Quantity:
    part, _, key = name.partition(".")
    if part == "C_d":
        return told.C_d[key]
    found = getattr(told.inlet, key) if part == "inlet" else getattr(told, name)
    assert isinstance(found, Quantity)
    return found


def _cell(found: Quantity, truth: float | None = None) -> str:
    """Value and interval; bold where it does not hold the ``truth``."""
    if found.value is None or found.interval is None:
        return "none"
    low, high = found.interval
    text = f"{found.value:.3g} ({low:.3g} to {high:.3g})"
    return text if truth is None or low <= truth <= high else f"**{text}**"


if __name__ == "__main__":
    main()
