"""From a test's name to the context its stages work with."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hfanalysis.progress import Progress, silent
from hfanalysis.record.definition import find_definition, load_definition
from hfanalysis.stages.base import Context

RAW, PROCESSED = "raw_tests", "processed"

FIRING = "segment.firing"
"""The parameter that takes another firing of the log for one run, whose products have a folder of their own."""


def open_test(
    root: Path,
    test_id: str,
    out: Path | None = None,
    *,
    progress: Progress = silent,
    settings: Mapping[str, Any] | None = None,
) -> Context:
    """The context of one test, its ``test.toml`` read and validated.

    Args:
        root: folder that holds ``raw_tests/`` (and ``processed/``, unless ``out`` is given).
        test_id: the test's name.
        out: folder to write ``TEST/`` to, instead of ``root/processed``.
        progress: told what is being done.
        settings: parameters by ``"stage.name"``; with another firing of the log the products go to ``TEST.firing-N/``.

    Raises:
        InputError: no such test, or its definition is at fault.
    """
    definition = load_definition(find_definition(root, test_id))
    firing = (settings or {}).get(FIRING)
    folder = (out if out is not None else root / PROCESSED) / (f"{test_id}.firing-{firing}" if firing else test_id)
    return Context(root, definition, folder, progress, settings or {})
