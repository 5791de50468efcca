"""Whose effects are run: a team's own are code, and a folder of tests may come from anybody.

Somebody has to agree to each folder once. That is noted in the user's folder for settings, with what the folder held:
where that changes, it is asked again.
"""

from __future__ import annotations

import os
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

from hfanalysis.errors import InputError
from hfanalysis.products.disk import atomic

_agreed: set[tuple[Path, str]] = set()
"""What this process was told, for who has nowhere to note it."""


def files(folder: Path) -> list[Path]:
    """The effects in a team's folder."""
    return sorted(folder.glob("[!_]*.py"))


def agreed(folder: Path) -> bool:
    """Whether somebody has agreed to run what is in the folder, as it is now."""
    held = _held(folder)
    try:
        noted = _note(folder).read_text(encoding="utf-8")
    except (OSError, ValueError):
        noted = ""
    return held in _agreed or noted.split() == [held[1]]


def agree(folder: Path, note: bool = True) -> None:
    """Note that what is in the folder may be run; for this process alone without a ``note``, or where there is no place
    for one."""
    held = _held(folder)
    _agreed.add(held)
    if not note:
        return
    with suppress(OSError), atomic(_note(folder)) as scratch:
        scratch.write_text(f"{held[1]}\n", encoding="utf-8")


def check(folder: Path) -> None:
    """Raises InputError where nobody has agreed to run the effects in a team's folder."""
    there = files(folder)
    if there and not agreed(folder):
        raise InputError(
            f"{folder}: found code that nobody has agreed to run here ({', '.join(path.name for path in there)}); "
            "expected, once it has been read, the option --trust-effects"
        )


def _held(folder: Path) -> tuple[Path, str]:
    """The folder, and SHA-256 over all code in it, by name."""
    whole = folder.resolve()
    total = sha256()
    for path in sorted(whole.rglob("*.py")):
        total.update(f"{path.relative_to(whole).as_posix()}\0{sha256(path.read_bytes()).hexdigest()}\n".encode())
    return whole, total.hexdigest()


def _note(folder: Path) -> Path:
    base = Path(os.environ.get("XDG_CONFIG_HOME") or os.path.join(os.path.expanduser("~"), ".config"))
    if not base.is_absolute():
        base = Path(os.devnull)  # who has no home has no notes: nothing can be read or written below it
    name = sha256(str(folder.resolve()).encode()).hexdigest()[:32]
    return base / "hfanalysis" / "trusted-effects" / name
