"""The case of a number: always the same stand, format and mutations."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import numpy as np
from benchmarks.fuzz import document, formats
from benchmarks.fuzz.mutators import BYTES, CLOCK, COLUMNS, ROWS, TEXT, TOML, TOML_TEXT, VALUES, Mutator
from benchmarks.fuzz.table import STANDS, Case, base_log

TWICE = 0.2
"""Share of cases that are hit twice."""

GROUPS: dict[str, tuple[float, dict[str, Mutator]]] = {
    "values": (0.30, VALUES),
    "rows": (0.12, ROWS),
    "clock": (0.12, CLOCK),
    "columns": (0.04, COLUMNS),
    "text": (0.10, TEXT),
    "bytes": (0.10, BYTES),
    "toml": (0.19, TOML),
    "toml text": (0.03, TOML_TEXT),
}
"""Groups of mutators: their share of the cases, and who is in them."""


def unspoilt(stand: str, format: str) -> Case:
    """A test as it was before anything happened to it."""
    case = Case(-1, stand, format, base_log(stand), document.base(stand, format))
    return _written(case, [])


def build(number: int, seed: int) -> Case:
    """The case of that number."""
    rng = np.random.default_rng([seed, number])
    stand, format = str(rng.choice(STANDS)), str(rng.choice(formats.NAMES))
    case = Case(number, stand, format, base_log(stand), document.base(stand, format))
    drawn = [_drawn(case, rng) for _ in range(2 if rng.random() < TWICE else 1)]
    for group, name, mutator in drawn:
        case.mutators.append(f"{group}: {name}")
        if group in ("values", "rows", "clock", "columns", "toml"):
            _mutate(mutator, case, rng)
    return _written(case, [(group, mutator, rng) for group, _, mutator in drawn])


def _drawn(case: Case, rng: np.random.Generator) -> tuple[str, str, Mutator]:
    shares = np.array([share for share, _ in GROUPS.values()])
    group = str(rng.choice(list(GROUPS), p=shares / shares.sum()))
    if group == "text" and not formats.is_text(case.format):
        group = "bytes"
    names = list(GROUPS[group][1])
    name = str(rng.choice(names))
    return group, name, GROUPS[group][1][name]


def _written(case: Case, later: list[tuple[str, Mutator, np.random.Generator]]) -> Case:
    case.content = formats.WRITERS[case.format][1](case.log)
    case.text = document.text(case.toml)
    for group, mutator, rng in later:
        if group in ("text", "bytes", "toml text"):
            _mutate(mutator, case, rng)
    return case


def _mutate(mutator: Mutator, case: Case, rng: np.random.Generator) -> None:
    """The second of two may find nothing left that it could hit: an empty log, a section that is gone."""
    with suppress(LookupError, ValueError, ArithmeticError):
        mutator(case, rng)


def put(case: Case, root: Path) -> Path:
    """Write the case as a root with one test; returns the root."""
    folder = root / "raw_tests" / document.ID
    folder.mkdir(parents=True)
    (folder / document.file_of(case.format)).write_bytes(case.content)
    (folder / "test.toml").write_bytes(case.text.encode("latin-1", "replace"))
    return root
