"""The burnt gas of every engine: its table, by itself, for those who need no more of an engine."""

from __future__ import annotations

from functools import lru_cache

from hfanalysis.thermo import combustion_table
from hfanalysis.thermo.fuels import PARAFFIN, Fuel


@lru_cache(maxsize=4)
def combustion_of(fuel: Fuel = PARAFFIN) -> combustion_table.CombustionTable:
    """The combustion table of a fuel, loaded once."""
    return combustion_table.build(fuel=fuel)
