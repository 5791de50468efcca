"""How near tests that lack an effect come to what ``hfanalysis.diagnose.model_free`` calls a sign of it.

python -m benchmarks.signs DIR ...

DIR holds ``processed/ID/`` and ``answers/ID.json`` of simulated tests (docs/blind.md); those count in which neither
nitrogen nor an effect of the tank's pressure at rest is hidden.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path

from hfanalysis.diagnose.model_free import BAR, opening_of, purge_line_of
from hfanalysis.products.segments import Segments
from hfanalysis.record.log import read_log

SHOWN = {"tank_stratification", "tank_nonequilibrium", "n2_purge", "dissolved_nitrogen"}
"""What the signs are of, or of what they might be."""


def folders(cases: Path) -> Iterator[Path]:
    """Products of the tests that lack these."""
    for answer in sorted((cases / "answers").glob("*.json")):
        hidden = {effect["name"] for effect in json.loads(answer.read_text(encoding="utf-8"))["effects"]}
        made = cases / "processed" / answer.stem
        if not hidden & SHOWN and (made / "ingest.h5").is_file() and (made / "segments.json").is_file():
            yield made


def main(given: list[str]) -> None:
    """Print the largest of each, over all tests."""
    found: dict[str, list[tuple[float, str]]] = {"fall": [], "dip": [], "purge line above the tank": []}
    for made in (made for cases in given for made in folders(Path(cases))):
        log = read_log(made / "ingest.h5")
        segments = Segments.from_json(json.loads((made / "segments.json").read_text(encoding="utf-8")))
        if (opening := opening_of(log, segments)) is not None:
            found["fall"].append((opening.fall / BAR, made.name))
            found["dip"].append((opening.dip / BAR, made.name))
        if (line := purge_line_of(log, segments)) is not None:
            found["purge line above the tank"].append((line.more / BAR, made.name))
    for name, values in found.items():
        size, test = max(values, default=(float("nan"), "-"))
        print(f"{name}: at most {size:.2f} bar ({test}), of {len(values)} tests")


if __name__ == "__main__":
    main(sys.argv[1:])
