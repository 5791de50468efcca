"""How long work tells what it is doing."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

Progress = Callable[[str, float | None], None]
"""Told what is being done, and the fraction done where it is known."""


_TOLD: list[Callable[[], None]] = []
"""Who wants to know when something is compiled."""


@contextmanager
def watching_compiler(tell: Callable[[], None]) -> Iterator[None]:
    """Have ``tell`` called each time that one more function has to be compiled."""
    _TOLD.append(tell)
    try:
        yield
    finally:
        _TOLD.remove(tell)


def compiling() -> None:
    """Called by the compiler for every function that no earlier run has kept."""
    for tell in _TOLD:
        tell()


def silent(_text: str, _fraction: float | None = None) -> None:
    """Progress that nobody watches."""
