"""The burnt gas of every engine: its table, by itself, for those who need no more of an engine."""

from __future__ import annotations

from functools import lru_cache

from hfanalysis.thermo import combustion_table


@lru_cache(maxsize=1)
def combustion_of() -> combustion_table.CombustionTable:
    """The combustion table, loaded once."""
    return combustion_table.build()
