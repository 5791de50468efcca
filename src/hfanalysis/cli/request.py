"""What the command line asks for of a test."""

from __future__ import annotations

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

    def setting(self, text: str) -> Request:
        """The same with one more parameter of a stage, ``STAGE.NAME=VALUE``."""
        return replace(self, settings=(*self.settings, text))
