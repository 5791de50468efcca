"""Variants of the method, for studies of what each part of it is good for."""

from __future__ import annotations

from dataclasses import dataclass

from hfanalysis.errors import InputError


@dataclass(frozen=True)
class Settings:
    """What the method does; all on but in studies of what each is good for."""

    tempering: bool = True
    projection: bool = True
    colored: bool = True


VARIANTS = {
    "": Settings(),
    "no_tempering": Settings(tempering=False),
    "no_projection": Settings(projection=False),
    "white_noise": Settings(colored=False),
}
"""By name; the first is the method."""


def settings_of(name: str) -> Settings:
    """The settings of a variant. Raises InputError for an unknown one."""
    if name not in VARIANTS:
        raise InputError(f"diagnose.variant: found {name!r}; expected one of {', '.join(v for v in VARIANTS if v)}")
    return VARIANTS[name]
