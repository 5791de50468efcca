"""How long work tells what it is doing."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str, float | None], None]
"""Told what is being done, and the fraction done where it is known."""


def silent(_text: str, _fraction: float | None = None) -> None:
    """Progress that nobody watches."""
