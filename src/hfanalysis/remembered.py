"""Answers that take milliseconds to find and are asked for at every start, kept in a file for as long as what they
follow from is as it was.

A file that cannot be read, is damaged or was written in another state is passed over; where none can be written, the
answers take their time again.
"""

from __future__ import annotations

import atexit
import json
import os
from collections.abc import Callable
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from typing import Any


class Remembered:
    """Answers (what JSON can hold) by their questions, written when the process ends."""

    def __init__(self, path: Path, state: str, lasting: bool = True) -> None:
        """``state`` tells what the answers follow from; one that is not ``lasting`` may change unseen: none is kept."""
        self._path, self._state, self._lasting = path, state, lasting
        self._known = self._read()
        self._new = False

    def __call__(self, question: str, find: Callable[[], Any]) -> Any:
        """The answer, found now if it is not known."""
        if question not in self._known:
            self._known[question] = find()
            if self._lasting and not self._new:
                self._new = True
                atexit.register(self.save)
        return self._known[question]

    def _read(self) -> dict[str, Any]:
        with suppress(OSError, ValueError):
            checksum, _, body = self._path.read_text(encoding="utf-8").partition("\n")
            if checksum == _checksum(body):
                state, known = json.loads(body)
                return dict(known) if state == self._state else {}
        return {}

    def save(self) -> None:
        """Keep the answers for the next process, whole or not at all."""
        body = json.dumps([self._state, self._known])
        scratch = self._path.with_name(f".{self._path.name}.{os.getpid()}")
        try:
            self._path.parent.mkdir(exist_ok=True)
            scratch.write_text(f"{_checksum(body)}\n{body}", encoding="utf-8")
            scratch.replace(self._path)
        except OSError:
            with suppress(OSError):
                scratch.unlink()


def _checksum(body: str) -> str:
    return sha256(body.encode()).hexdigest()
