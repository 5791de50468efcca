"""One file with what a run has found so far, so that it can go on elsewhere and its page be made without running it.

Of every case the answer, the note, and of the product what is scored. It is taken up where a case has no note: what
another version of the package or of its constants found stays in the file and out of the folder, and so does all that
is of another generator.
"""

from __future__ import annotations

import json
import lzma
import os
from collections.abc import Container, Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from simulated.blind.judged import FAILED, Case, by_significance

from .folder import DONE, UNWRITTEN, Folder, Note, write_json

SCORED = ("verdict", "set90", "posterior", "evidences", "unknown_elsewhere", "tried", "leftover", "likeliest_place")
"""Of a product, as it stands."""

DIGITS = 6
"""Significant digits of numbers."""


def essence(product: Mapping[str, Any]) -> dict[str, Any]:
    """What of a product is scored: of the places, the first with its course over time."""
    kept = {name: product[name] for name in SCORED if name in product}
    first, *others = by_significance(product.get("localisation") or []) or [None]
    rows = [] if first is None else [first, *({k: v for k, v in row.items() if k != "history"} for row in others)]
    effects = [{k: row[k] for k in ("name", "probability")} for row in product.get("effects") or []]
    closed = (product.get("gap") or {}).get("closed_fraction")
    if isinstance(kept.get("likeliest_place"), dict):
        kept["likeliest_place"] = {k: v for k, v in kept["likeliest_place"].items() if k != "history"}
    return {**kept, "localisation": rows, "effects": effects, "gap": {"closed_fraction": closed}}


def rounded(value: Any) -> Any:
    """Numbers with DIGITS significant digits, whatever they are in."""
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}")
    if isinstance(value, dict):
        return {k: rounded(v) for k, v in value.items()}
    return [rounded(v) for v in value] if isinstance(value, list) else value


def pack(folder: Folder, path: Path) -> int:
    """Write all that a folder holds into a file, whole; how many cases.

    What the file had of cases that the folder has no note on stays in it. A case that could not be written has no
    answer and is no result: it is tried again wherever the run goes on.
    """
    rows = {row["note"]["id"]: row for row in _rows(path)}
    for name, note in folder.notes().items():
        if note.status == UNWRITTEN:
            continue
        row: dict[str, Any] = {"note": asdict(note), "answer": _read(folder.answers / f"{name}.json")}
        if note.status == DONE:
            row["product"] = essence(_read(folder.product(name)))
        rows[name] = rounded(row)
    text = "".join(json.dumps(rows[name], separators=(",", ":"), sort_keys=True) + "\n" for name in sorted(rows))
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(f".part-{os.getpid()}")
    part.write_bytes(lzma.compress(text.encode(), preset=9))
    os.replace(part, path)
    return len(rows)


def unpack(path: Path, folder: Folder, wanted: Container[str], now: tuple[str, str] | None, generator: str) -> int:
    """Put what a file holds of the ``wanted`` cases into a folder; how many diagnoses.

    What is there already stays, and what another version made is left: ``now`` are the digests of the package and of
    its constants (None: whatever they are), ``generator`` that of what makes the cases. The answers are taken whatever
    has become of the package since.
    """
    taken = 0
    for row in _rows(path):
        note = Note(**row["note"])
        if note.id not in wanted or row["answer"].get("generator") != generator:
            continue
        answer = folder.answers / f"{note.id}.json"
        if not answer.exists():
            write_json(answer, row["answer"])
        if folder.note(note.id) is not None or (now is not None and (note.code, note.probabilities) != now):
            continue
        if note.status == DONE:
            write_json(folder.product(note.id), row["product"])
        folder.write_note(note)
        taken += 1
    return taken


def cases_of(path: Path, wanted: Container[str]) -> dict[str, Case]:
    """The ``wanted`` cases of a file, as it has them."""
    rows = ((row["note"], row) for row in _rows(path))
    return {
        note["id"]: Case(row["answer"], row.get("product", {"verdict": FAILED}))
        for note, row in rows
        if note["id"] in wanted
    }


def _rows(path: Path) -> Iterable[dict[str, Any]]:
    if path.exists():
        for line in lzma.decompress(path.read_bytes()).decode().splitlines():
            yield json.loads(line)


def _read(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found
