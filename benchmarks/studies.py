"""What studies of diagnoses share: one thread, shares in words, and a table between two marks of a page."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path


def one_thread() -> None:
    """Linear algebra on one core, as on the command line; to be called before the stages load numpy."""
    for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(threads, "1")


def percent(share: float | None) -> str:
    """A share as a percentage; a dash where there is none."""
    return "-" if share is None else f"{100.0 * share:.0f} %"


def put(page: Path, name: str, lines: Iterable[str]) -> None:
    """Write lines between the page's marks of that name."""
    begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    text = page.read_text(encoding="utf-8")
    head, tail = text.split(begin)[0], text.split(end)[1]
    page.write_text(f"{head}{begin}\n" + "\n".join(lines) + f"\n{end}{tail}", encoding="utf-8")
