"""``hfa effects``: the library of effects, those of the team included."""

from __future__ import annotations

from math import isfinite
from pathlib import Path

from hfanalysis.cli.exit_status import put
from hfanalysis.effects import FOLDER, library
from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.errors import InputError
from hfanalysis.products.disk import to_json
from hfanalysis.products.effects import EffectEntry, EffectLibrary, EffectParameter


def effects(root: Path, as_json: bool) -> None:
    """Show the effects there are: those that come along, and those in ``root``/effects/."""
    if not root.is_dir():
        raise InputError(f"--root {root}: there is no such folder")
    found = product(library(root / FOLDER))
    if as_json:
        put(to_json(found.to_json()))
        return
    from hfanalysis.cli import tables

    tables.show_effects(found)


def product(found: dict[str, Effect]) -> EffectLibrary:
    """The library as data, in SI; a bound that is not there is null."""
    return EffectLibrary(effects={name: _described(effect) for name, effect in found.items()})


def _described(effect: Effect) -> EffectEntry:
    strengths = {p.name for p in effect.parameters[: effect.strengths]}
    return EffectEntry(
        equation=effect.equation,
        meaning=effect.meaning,
        formula=effect.formula,
        sites=effect.sites,
        phases=effect.phases,
        parameters={p.name: _prior(p, p.name in strengths) for p in effect.parameters},
        twins=effect.twins,
        decisive=effect.decisive,
        reference=effect.reference,
        plain_name=effect.plain_name,
    )


def _prior(p: Parameter, strength: bool) -> EffectParameter:
    low, high = (bound if isfinite(bound) else None for bound in (p.low, p.high))
    return EffectParameter(
        strength=strength,
        unit=p.unit,
        meaning=p.meaning,
        center=p.center,
        typical=p.typical,
        low=low,
        high=high,
        given=p.given,
    )
