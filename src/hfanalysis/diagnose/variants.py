"""Variants of the method, for studies of what each part of it is good for."""

from __future__ import annotations

from hfanalysis.diagnose.naming import Settings
from hfanalysis.errors import InputError

VARIANTS = {
    "": Settings(),
    "no_tempering": Settings(tempering=False),
    "no_polish": Settings(polishing=False),
    "no_projection": Settings(projection=False),
    "white_noise": Settings(coloured=False),
}
"""By name; the first is the method."""


def settings_of(name: str) -> Settings:
    """The settings of a variant. Raises InputError for an unknown one."""
    if name not in VARIANTS:
        raise InputError(f"diagnose.variant: found {name!r}; expected one of {', '.join(v for v in VARIANTS if v)}")
    return VARIANTS[name]
