"""What four firings of one stand lack, two of them with ranges for what their team does not state: docs/diagnosis.md.

python -m benchmarks.real_logs.ranges [--logs FOLDER] [--write docs/diagnosis.md]
"""

from __future__ import annotations

import argparse
import re
import shutil
import tempfile
from pathlib import Path

from benchmarks.practice import diagnosed
from benchmarks.studies import one_thread, put

STATED = Path(__file__).resolve().parents[2] / "tests" / "acceptance" / "real"
"""What is stated of each log."""

RANGES = """
[chamber]
pre_volume = "0.2 L +/- 50 %"
post_volume = "0.8 L +/- 40 %"
[nozzle]
throat_radius = "18.7 mm +/- 10 %"
exit_radius = "31 mm +/- 15 %"
"""
"""By choice: the throat as stated for a later firing of the stand, the rest as such engines have it."""

INJECTOR = '[injector]\nholes = 22\nhole_diameter = "2.0 mm +/- 10 %"\n'
"""That of the stand's other firings."""

FIRINGS = {
    "MRT-HF2.3": "yes: by hand nitrogen enters at 3.4 s",
    "MRT-HF2.4": "yes: by hand nitrogen enters at 4.5 s, and the liquid at rest is colder than its pressure says; "
    "which of the two it is the pressures do not tell",
    "MRT-HF3.1": "the channels' part, yes: by hand the tank is layered and comes back from below, and nitrogen enters "
    "early; of the cell no more than that its thrust was filed with half its gain",
    "MRT-HF3.4": "the channels' part, yes: by hand the same, and the cell rests 469 N high; no part of the names",
}
"""The firings, and whether we believe what is said."""


SIGNS = re.compile(r"The tank's pressure falls|The purge line falls|Thrust \(zero\)")
"""How sentences begin that are of the channels by themselves."""


def written(name: str, logs: Path, root: Path) -> None:
    """A copy of a firing in ``root``; HF3 with ranges for what is not stated."""
    folder = root / "raw_tests" / name
    folder.mkdir(parents=True)
    shutil.copy(logs / name / "log.csv", folder)
    text = (STATED / name / "test.toml").read_text(encoding="utf-8")
    if name.startswith("MRT-HF3"):
        text = re.sub(r'(oxidizer_mass = "11.. kg)"', r'\1 +/- 5 %"', text)
        text = re.sub(r"\[nozzle\]\n.*\n", "", text) + RANGES
        text += "" if "[injector]" in text else INJECTOR
    (folder / "test.toml").write_text(text, encoding="utf-8")


def row(name: str, logs: Path) -> str:
    """What is said of a firing, in Markdown."""
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        written(name, logs, root)
        outcome = diagnosed(root, name, root / "scratch")
    product = outcome.product
    odds = {**product["posterior"], **product.get("partners", {})}
    names = ", ".join(f"{name} {p:.2f}" for name, p in odds.items() if p >= 0.05 and name != "none")
    fit = product.get("leftover") if "model_form_error" in product.get("compared", {}) else None
    told = "-" if fit is None else f"{fit:.1f}"
    signs = [s for s in product["sentences"] if SIGNS.match(s)]
    return f"| {name} | {product['verdict']}: {names} | {told} | {' '.join(signs)} | {FIRINGS[name]} |"


def main() -> None:
    """Diagnose the four, and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--logs", type=Path, default=Path("../shared/real_tests"))
    parser.add_argument("--write", type=Path)
    asked = parser.parse_args()
    one_thread()
    lines = [
        "| firing | what it lacks, with its probability | chi-square per observation | the channels by themselves "
        "| believed? |",
        "|---|---|---|---|---|",
        *(row(name, asked.logs) for name in FIRINGS),
    ]
    print("\n".join(lines))
    if asked.write:
        put(asked.write, "firings", lines)


if __name__ == "__main__":
    main()
