"""Findings against other tests of the stand, which only ever make suspect: one file each, found by its name."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from hfanalysis.health.seen import SeenTest
from hfanalysis.products.health import Finding

Find = Callable[[SeenTest], Iterable[Finding]]


@cache
def detectors() -> dict[str, Find]:
    """Every detector by its name, in the order of names."""
    names = sorted(m.name for m in iter_modules(__path__) if not m.name.startswith("_"))
    return {name: import_module(f"{__name__}.{name}").find for name in names}
