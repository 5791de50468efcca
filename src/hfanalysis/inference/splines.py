"""Cubic B-splines over time, and an effect that adds them to a site of the model."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import inf

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.sites import HOOK_OF_SITE, IS_LIQUID, RATES, SITES, term
from hfanalysis.inference.unknown import nameless_effect

GIVEN = ("site", "hook", "first", "spacing", "count", "wet")
SITE, HOOK, FIRST, SPACING, COUNT, WET = range(6)
COEFFICIENTS = len(GIVEN) + 1
"""Where in the parameters of the effect the coefficients begin, behind the strength and GIVEN."""


@term
def _source(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    """p: the strength (which is 1: all coefficients together are the source), GIVEN, the coefficients."""
    if hook != int(p[1 + HOOK]) or (p[1 + WET] > 0.0 and env[IS_LIQUID] == 0.0):
        return
    u = (t - p[1 + FIRST]) / p[1 + SPACING]
    k = int(np.floor(u))
    f = u - k
    g = 1.0 - f
    total = 0.0
    for j in range(4):
        i = k - 1 + j
        if 0 <= i < int(p[1 + COUNT]):
            if j == 0:
                weight = g * g * g / 6.0
            elif j == 1:
                weight = (3.0 * f * f * f - 6.0 * f * f + 4.0) / 6.0
            elif j == 2:
                weight = (3.0 * g * g * g - 6.0 * g * g + 4.0) / 6.0
            else:
                weight = f * f * f / 6.0
            total += weight * p[COEFFICIENTS + i]
    site[int(p[1 + SITE])] += p[0] * total


@dataclass(frozen=True)
class Splines:
    """Cubic B-splines with ``count`` coefficients; the i-th peaks at ``first`` + i ``spacing`` [s].

    Beyond their ends they fade, or stay as they are at these if they are ``held``. Those of a source that ends with the
    liquid, at ``liquid_out`` [s], break off there.
    """

    first: float
    spacing: float
    count: int
    held: bool = False
    liquid_out: float = inf

    @classmethod
    def over(cls, start: float, end: float, spacing: float, wet: bool = False) -> Splines:
        """Splines that reach over an interval, or over that in which liquid flows. ``start``, ``end`` and ``spacing``
        [s]."""
        pieces = max(int(np.ceil((end - start) / spacing)), 1)
        width = (end - start) / pieces
        return cls(start - width, width, pieces + 3, liquid_out=end if wet else inf)

    def at(self, times: Array) -> Array:
        """Values (times, count) [-] of the splines at ``times`` (times,) [s]; where all of them reach they add up to
        one (de Boor, A Practical Guide to Splines, chapter IX).

        >>> float(Splines.over(0.0, 2.0, 0.5).at(np.array([0.7])).sum().round(9))
        1.0
        """
        if self.held:
            last = self.first + (self.count - 2) * self.spacing
            times = np.clip(times, self.first + self.spacing, last)
        u = np.abs((times[:, None] - self.first) / self.spacing - np.arange(self.count)[None, :])
        near, far = (4.0 - 6.0 * u**2 + 3.0 * u**3) / 6.0, (2.0 - u) ** 3 / 6.0
        return np.where(times[:, None] >= self.liquid_out, 0.0, np.where(u < 1.0, near, np.where(u < 2.0, far, 0.0)))


@lru_cache(maxsize=64)
def probe(site: str, splines: Splines, typical: float) -> Effect:
    """An effect that adds splines to a site; its coefficients c0, c1, ... are of ``typical`` size [the site's unit]."""
    given = (
        SITES.index(site),
        HOOK_OF_SITE.get(site, RATES),
        splines.first,
        splines.spacing,
        splines.count,
        np.isfinite(splines.liquid_out),
    )
    fixed = [
        Parameter(name, "", "of the probe", 1.0, center=float(v), given=True)
        for name, v in zip(GIVEN, given, strict=True)
    ]
    reach = 2.0 * splines.spacing
    coefficients = [
        Parameter(f"c{i}", "", f"source about {at:.2f} s", typical, acting=(at - reach, at + reach))
        for i, at in enumerate(splines.first + splines.spacing * np.arange(splines.count))
    ]
    return nameless_effect(
        site,
        "tank_energy",
        f"an unknown source at {site}",
        (Parameter("on", "", "1: the source acts", 1.0), *fixed, *coefficients),
        term=_source,
    )
