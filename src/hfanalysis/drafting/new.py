"""A new test on disk: its folder, the logs in it, test.toml drafted from them, and a picture of them."""

from __future__ import annotations

import re
import shutil
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from hfanalysis.drafting.columns import read_log_files
from hfanalysis.drafting.document import document
from hfanalysis.drafting.picture import picture
from hfanalysis.drafting.survey import Surveyed, survey
from hfanalysis.errors import InputError
from hfanalysis.products.disk import atomic

_ID = re.compile(r"\w[\w.+-]*")
DEFINITION, PICTURE = "test.toml", "columns.svg"


@dataclass(frozen=True)
class NewTest:
    """What was made: the path of test.toml, of the picture, and what was found in the logs."""

    path: Path
    picture: Path
    found: Surveyed


def new_test(
    root: Path, test_id: str, logs: Sequence[Path], edit: Callable[[Surveyed], Surveyed] = lambda found: found
) -> NewTest:
    """Draft ``raw_tests/ID/test.toml`` from logs, which are copied there unless they are there already.

    Args:
        root: folder that holds ``raw_tests/``.
        test_id: name of the new test.
        logs: its log files.
        edit: what an engineer makes of what was found.

    Raises:
        InputError: the name cannot be a test's, a log cannot be read or is no log, or a file is already there.
    """
    folder = root / "raw_tests" / test_id
    copies = _checked(test_id, folder, logs)
    found = edit(survey(read_log_files(logs)))
    text = document(test_id, found)
    tomllib.loads(text)  # a draft that is no TOML is a defect: nothing is written
    _place(text, folder, copies)
    seen = root / "processed" / test_id / PICTURE
    _write(seen, picture(found))
    return NewTest(folder / DEFINITION, seen, found)


def _checked(test_id: str, folder: Path, logs: Sequence[Path]) -> dict[Path, Path]:
    """Where which log is to be copied to; raises :class:`InputError` before anything is read or written."""
    if not _ID.fullmatch(test_id) or ".." in test_id:
        raise InputError(f"{test_id!r} cannot name a test; expected letters, digits, '.', '_', '+' and '-'")
    for log in logs:
        _is_file(log)
    target = folder / DEFINITION
    if target.exists():
        raise InputError(f"{target}: is there already, and is never overwritten")
    copies: dict[Path, Path] = {}
    for log in logs:
        copy = folder / log.name
        if copy in copies.values() or copy == target:
            raise InputError(f"{log}: there is another file {log.name!r} of this test; expected every name once")
        if copy.exists() and not copy.samefile(log):
            raise InputError(f"{copy}: is there already, and is never overwritten")
        copies[log] = copy
    return copies


def _is_file(log: Path) -> None:
    if log.is_dir():
        raise InputError(f"{log}: is a folder; expected the test's log files, each after a --log of its own")
    if not log.is_file():
        raise InputError(f"{log}: no such file; expected the test's log")
    try:
        log.name.encode("utf-8")
    except UnicodeEncodeError:
        raise InputError(f"{log!r}: its name is not UTF-8; expected one that test.toml can hold") from None


def _place(text: str, folder: Path, copies: dict[Path, Path]) -> None:
    try:
        for log, copy in copies.items():
            if not copy.exists():
                with atomic(copy) as scratch:
                    shutil.copyfile(log, scratch)
    except OSError as error:
        raise InputError(f"{folder}: cannot be written to ({error.strerror})") from None
    _write(folder / DEFINITION, text)


def _write(path: Path, text: str) -> None:
    try:
        with atomic(path) as scratch:
            scratch.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path.parent}: cannot be written to ({error.strerror})") from None
