"""What the command line asks for of a test."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path


@dataclass(frozen=True)
class Request:
    """What the command line asks for."""

    test: str
    root: Path
    out: Path | None
    as_json: bool
    force: bool
    quiet: bool
    settings: tuple[str, ...] = ()
    verbose: bool = False

    def setting(self, text: str) -> Request:
        """The same with one more parameter of a stage, ``STAGE.NAME=VALUE``."""
        return replace(self, settings=(*self.settings, text))


def named(test: str, root: Path) -> tuple[str, Path]:
    """A test's name and root from its name, or from the path of its folder or its test.toml, as a shell completes it.

    A path sets the root where none is asked for. What is no such path is taken for a name.
    """
    if os.sep not in test:
        return test, root
    path = Path(test)
    folder = (path.parent if path.name == "test.toml" else path).absolute()
    if not (folder / "test.toml").is_file() or folder.parent.name != "raw_tests":
        return test, root
    return folder.name, folder.parent.parent if root == Path() else root
