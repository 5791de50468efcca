"""``hfa effects``: the library of effects, those of the team included."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from typing import Any

from hfanalysis.cli.exit_status import put
from hfanalysis.effects import FOLDER, library
from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.errors import InputError


def effects(root: Path, as_json: bool) -> None:
    """Show the effects there are: those that come along, and those in ``root``/effects/."""
    if not root.is_dir():
        raise InputError(f"--root {root}: there is no such folder")
    found = library(root / FOLDER)
    if as_json:
        from hfanalysis.products.disk import to_json

        put(to_json(product(found)))
        return
    from hfanalysis.cli import tables

    tables.show_effects(product(found))


def product(found: dict[str, Effect]) -> dict[str, Any]:
    """The library as data, in SI; a bound that is not there is null."""
    return {"effects": {name: _described(effect) for name, effect in found.items()}}


def _described(effect: Effect) -> dict[str, Any]:
    strengths = {p.name for p in effect.parameters[: effect.strengths]}
    return {
        "equation": effect.equation,
        "meaning": effect.meaning,
        "formula": effect.formula,
        "sites": list(effect.sites),
        "phases": list(effect.phases),
        "parameters": {p.name: {"strength": p.name in strengths, **_prior(p)} for p in effect.parameters},
        "twins": list(effect.twins),
        "decisive": effect.decisive,
        "reference": effect.reference,
    }


def _prior(p: Parameter) -> dict[str, Any]:
    low, high = (bound if isfinite(bound) else None for bound in (p.low, p.high))
    return {
        "unit": p.unit,
        "meaning": p.meaning,
        "center": p.center,
        "typical": p.typical,
        "low": low,
        "high": high,
        "given": p.given,
    }
