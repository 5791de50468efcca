"""From a test's name to the context its stages work with."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hfanalysis.errors import InputError
from hfanalysis.spelling import near_misses
from hfanalysis.stages.base import Context, Progress, silent
from hfanalysis.testdata.definition import TestDefinition, load_definition

TEST_ID = re.compile(r"\w[\w.+-]*")
"""A test's name is a folder's name: no separators, no spaces, no leading dot or dash."""

RAW, PROCESSED = "raw_tests", "processed"


def check_id(test_id: str) -> str:
    """The name itself, if it can be a test's. Raises InputError."""
    if not TEST_ID.fullmatch(test_id) or ".." in test_id:
        raise InputError(
            f'"{test_id}" is not a test id: expected a folder name below {RAW}/, '
            'made of letters, digits, ".", "_", "+" and "-", beginning with a letter or digit'
        )
    return test_id


def known_tests(root: Path) -> list[str]:
    """The tests below ``root``: folders of raw_tests that hold a test.toml."""
    return sorted(path.parent.name for path in (root / RAW).glob("*/test.toml"))


def find_definition(root: Path, test_id: str) -> Path:
    """The test's ``test.toml``. Raises InputError naming what there is instead."""
    folder = root / RAW / check_id(test_id)
    path = folder / "test.toml"
    if path.is_file():
        return path
    if not (root / RAW).is_dir():
        raise InputError(f"{root / RAW}: no such folder; expected the folder of the raw tests (see --root)")
    if folder.is_dir():
        raise InputError(
            f"{path}: no such file; expected what is known about the test (`hfa new {test_id}` drafts one)"
        )
    raise InputError(f'no test "{test_id}" below {root / RAW}{near_misses(test_id, known_tests(root))}')


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
        settings: parameters by ``"stage.name"``.

    Raises:
        InputError: no such test, or its definition is at fault.
    """
    definition = load_definition(find_definition(root, test_id))
    _check_same(definition, test_id)
    folder = (out if out is not None else root / PROCESSED) / test_id
    return Context(root, definition, folder, progress, settings or {})


def _check_same(definition: TestDefinition, test_id: str) -> None:
    if definition.test.id != test_id:
        raise InputError(
            f'{definition.path}: test.id: found "{definition.test.id}", expected the name of its folder, "{test_id}"'
        )
