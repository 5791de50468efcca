"""An engine on a stand like the one of the report's hot fires, for tests."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from simulated.engines import hf5_like

from hfanalysis.engine.unsteady import Engine


@cache
def _engine() -> Engine:
    return replace(hf5_like(), oxidizer_enthalpy=None)


def engine_on_stand(**changes: object) -> Engine:
    """HF5's engine with constants near those that its test gives, under the corrected conventions."""
    return replace(_engine(), **changes)  # type: ignore[arg-type]
