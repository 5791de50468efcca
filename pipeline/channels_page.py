"""Writes the table of docs/channels.md, what is had of a log that lacks channels, by leaving them out: `make readme`.

Each row is HF5's replica, every twentieth row of its log, without what the row names, run from the log to the flight.
"""

from __future__ import annotations

import re
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.flight import Flight
from hfanalysis.products.model import Product
from hfanalysis.products.segments import Segments
from hfanalysis.products.validation import Validation
from hfanalysis.quantity import IDENTIFIED, Quantity
from hfanalysis.stages.base import Context
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to

P = TypeVar("P", bound=Product)
ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "channels.md"
BLOCK = re.compile(r"(<!-- table \(written by `make readme`\) -->\n).*?(<!-- end of table -->)", re.DOTALL)

EVERY = 20
"""Rows of the log from one that is kept to the next: 60 samples a second of a burn that lasts 17 s."""
SETTINGS = {"calibrate.samples": 60, "flight.flights": 10, "flight.gust_seeds": 1, "flight.winds": [2.0]}

ALL = ("p_tank", "p_run", "p_chamber", "p_purge", "thrust", "m_tank")
MASS = 'oxidizer_mass = "8.350 +/- 0.010 kg"'
BURN = '[observed]\nburn_time = "17.0 s"\n'


@dataclass(frozen=True)
class Case:
    """A row: the channels that are left out, and what is stated instead of something else."""

    name: str
    without: tuple[str, ...] = ()
    instead: tuple[tuple[str, str], ...] = ()


CASES = (
    Case("all"),
    Case("no p_run", ("p_run",)),
    Case("no p_run, [feed] K_loss stated", ("p_run",), (("[grain]", '[feed]\nK_loss = "5.6e8 1/m^4"\n[grain]'),)),
    Case("no p_purge", ("p_purge",)),
    Case("no m_tank", ("m_tank",)),
    Case("no m_tank, no [tank] oxidizer_mass; ullage stated", ("m_tank",), ((MASS, "ullage = 0.63"),)),
    Case("no m_tank, no [tank] oxidizer_mass; [injector] C_i stated", ("m_tank",),
         ((MASS, ""), ("holes = 22", 'holes = 22\nC_i = "0.29 +/- 0.01"'))),
    Case("no m_tank, no [tank] oxidizer_mass", ("m_tank",), ((MASS, ""),)),
    Case("no thrust", ("thrust",)),
    Case("no p_chamber", ("p_chamber",)),
    Case("no p_tank", ("p_tank",)),
    Case("no [observed] burn_time", (), ((BURN, ""),)),
    Case("p_tank and p_chamber only", ("p_run", "p_purge", "thrust", "m_tank")),
    Case("p_chamber and thrust only", ("p_tank", "p_run", "p_purge", "m_tank")),
    Case("thrust only", ("p_tank", "p_run", "p_chamber", "p_purge", "m_tank"), ((BURN, ""),)),
)  # fmt: skip
"""What is left out, by row."""

ANSWERS = ("t_v", "t_purge", "C_i", "m", "K_loss", "a, n", "burn time", "impulse", "Isp", "c*, O/F", "apogee")


def main() -> None:
    PAGE.write_text(anew(PAGE.read_text(encoding="utf-8")), encoding="utf-8")


def anew(page: str) -> str:
    """The page with its table as the code is now."""
    return BLOCK.sub(lambda found: f"{found[1]}{head()}{''.join(map(row, CASES))}{found[2]}", page)


def head() -> str:
    """The table's first two lines."""
    return f"| log | {' | '.join(ANSWERS)} |\n|---|{'---|' * len(ANSWERS)}\n"


def row(case: Case) -> str:
    """A line of the table."""
    had = answers(case)
    return f"| {case.name} | {' | '.join(had[name] for name in ANSWERS)} |\n"


def answers(case: Case) -> dict[str, str]:
    """What is had of a case, by ANSWERS: its verdict, in short; – where there is nothing."""
    with tempfile.TemporaryDirectory() as folder:
        context = _context(case, Path(folder))
        segments = _read(context, "segment", Segments)
        calibration = _read(context, "calibrate", Calibration)
        validation = _read(context, "validate", Validation)
        flight = _read(context, "flight", Flight)
    none = Quantity.absent("no product")
    times = segments.events if segments else {}
    found = calibration.quantities if calibration else {}
    measured = validation.performance.measured if validation else None
    flown = flight.quantities.get("apogee", none) if flight else none
    ratios = validation is not None and "histories" not in validation.absent
    return {
        **{name: _worth(times.get(name, none)) for name in ("t_v", "t_purge")},
        **{name: _worth(found.get(name, none)) for name in ("C_i", "m", "K_loss")},
        "a, n": _worth(found.get("a", none)),
        "burn time": _worth(measured.burn_time if measured else none),
        "impulse": _worth(measured.total_impulse if measured else none),
        "Isp": _worth(measured.specific_impulse if measured else none),
        "c*, O/F": "yes" if ratios else "–",
        "apogee": _worth(flown),
    }


def _worth(quantity: Quantity) -> str:
    if quantity.value is None:
        return "–"
    return "yes" if quantity.verdict in (None, IDENTIFIED) else quantity.verdict


def _context(case: Case, root: Path) -> Context:
    """The test of a case, on disk."""
    source, folder = ROOT / "raw_tests" / "HF5", root / "raw_tests" / "HF5"
    folder.mkdir(parents=True)
    lines = (source / "log.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    (folder / "log.csv").write_text("".join([lines[0], *lines[1::EVERY]]), encoding="utf-8")
    text = (source / "test.toml").read_text(encoding="utf-8")
    for name in case.without:
        text = re.sub(rf"\[channels\.{name}\]\n(?:.+\n)+\n", "", text)
    for old, new in case.instead:
        assert old in text, old
        text = text.replace(old, new)
    (folder / "test.toml").write_text(text, encoding="utf-8")
    return replace(open_test(root, "HF5"), settings=SETTINGS)


def _read(context: Context, stage: str, kind: type[P]) -> P | None:
    try:
        return run_to(stage, context).read(kind)
    except AbsentError:
        return None


if __name__ == "__main__":
    main()
