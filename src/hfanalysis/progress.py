"""How long work tells what it is doing."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

Progress = Callable[[str, float | None], None]
"""Told what is being done, and the fraction done where it is known."""


_COMPILED = 0
_TOLD: list[Callable[[int], None]] = []


@contextmanager
def watching_compiler(tell: Callable[[int], None]) -> Iterator[None]:
    """Have ``tell`` called with how many functions this process has compiled, each time that one more is."""
    _TOLD.append(tell)
    try:
        yield
    finally:
        _TOLD.remove(tell)


def compiling() -> None:
    """Called by the compiler for every function that no earlier run has kept."""
    global _COMPILED
    _COMPILED += 1
    for tell in _TOLD:
        tell(_COMPILED)


def silent(_text: str, _fraction: float | None = None) -> None:
    """Progress that nobody watches."""
