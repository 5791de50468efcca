"""Saturated nitrous oxide by name of its source; the reasons for the default stand in docs/properties.md."""

from __future__ import annotations

from functools import lru_cache

from hfanalysis.thermo.saturation import Saturation

SOURCES = ("coolprop", "report")


@lru_cache
def saturation(source: str = "coolprop") -> Saturation:
    """The saturation properties from a source: ``coolprop`` (one consistent equation of state) or ``report``.

    Raises ValueError for an unknown source.
    """
    if source == "coolprop":
        from hfanalysis.thermo import coolprop_nitrous

        return coolprop_nitrous.build()
    if source == "report":
        from hfanalysis.thermo import report_nitrous

        return report_nitrous.build()
    raise ValueError(f"unknown property source {source!r}; known: {', '.join(SOURCES)}")
