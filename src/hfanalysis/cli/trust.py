"""Asking once whether a folder's effects may be run."""

from __future__ import annotations

import sys
from pathlib import Path

import typer

from hfanalysis.cli.exit_status import tell


def ask(root: Path, given: bool) -> None:
    """Agree to the effects below ``root`` where that is ``given``, else ask, where there is somebody to ask.

    Without an answer they are refused when a stage wants them (:func:`hfanalysis.effects.trust.check`).
    """
    folder = root / "effects"
    if not any(folder.glob("[!_]*.py")):
        return  # before anything heavy is imported
    from hfanalysis.effects import trust

    if trust.agreed(folder):
        return
    names = ", ".join(path.name for path in trust.files(folder))
    if given or (_somebody() and _yes(folder, names)):
        trust.agree(folder)
        tell(f"{folder}: the code in {names} is run from now on, until it changes")


def _somebody() -> bool:
    return sys.stdin.isatty() and sys.stderr.isatty()


def _yes(folder: Path, names: str) -> bool:
    return typer.confirm(f"hfa: {folder} holds code of its own ({names}). Run it, now and until it changes?", err=True)
