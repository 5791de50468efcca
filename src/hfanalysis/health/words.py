"""How findings say levels and channels."""

from __future__ import annotations

from hfanalysis.record.channels import LONG_NAMES
from hfanalysis.sentences import Text, said

_SHOWN = {"pressure": ("bar", ".3g"), "force": ("N", ".3g"), "mass": ("kg", ".3g")}


def level(value: float, dimension: str) -> Text:
    """A level [SI] in the unit that such sentences have it in.

    >>> level(4.2e5, "pressure"), level(300.0, "temperature")
    ('4.2 bar', '26.85 degC')
    """
    if dimension == "temperature":
        return Text(f"{value - 273.15:.4g} degC")
    return said(value, *_SHOWN.get(dimension, ("", ".4g")))


def called(channel: str) -> str:
    """A channel with what it is: the reader may not know canonical names."""
    long = LONG_NAMES.get(channel)
    return f"{channel} ({long})" if long else channel
