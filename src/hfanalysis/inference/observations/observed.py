"""What a test says, in the form that inference takes it: block means with the covariance of their noise.

A constant offset of a sensor and an error of its gain, as large as its stated accuracy allows, are part of the
covariance: they are nuisances with a Gaussian prior. Blocks that contain a change of phase are left out; the instants
of the changes are observations of their own. After the flow has ended the chamber's pressure is the ambient one and
the thrust is none: what the sensors read then is compared as well, for it tells a drift.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import hypot, log

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from hfanalysis.arrays import Array
from hfanalysis.inference.observations.channel import CHAMBER_FORM, FORM_ERROR, ObservedChannel
from hfanalysis.inference.observations.flow_end import WITHOUT_FIRE
from hfanalysis.inference.observations.noise import Group, SlowNoise, groups_of, slow_noise
from hfanalysis.inference.observations.recorded import ALIKE, TOGETHER
from hfanalysis.inference.unknown import Unknown

FADE = "fuel_fade"
"""Among what was stated: the seconds in which the fire went out, with the deviation of their log."""


@dataclass(frozen=True)
class Observed:
    """The channels of a test, the instants of its phase changes with their deviations [s], and when it ends [s].

    ``grid`` [s]: points at which a model is asked: through the flow, and ``resting`` ones before it, at the opening and
    after it. ``fuel_out``: where the comparison of the tank goes on beyond the fuel, its measured end, at which that of
    every model ends; ``flame_shown`` [s]: until when a flame is shown, where nothing tells whether it burns on.
    ``stated``: what was measured outside the log (SI), or in it beside the blocks (FADE), with
    standard deviations, by name. ``common``: covariance of the first and second of TOGETHER, if both are there;
    ``alike``: the same of ALIKE, which come one after the other; ``line_zero`` [s]: when the zero of the second was
    taken of the first. ``errors``: model-form error, as part of the range of the tank's channels, and of chamber and
    thrust. ``unknowns``: those that the samples show without a model. ``abrupt``: the seconds that FADE would be if the
    fire were out at once, where a model was asked.

    ``grid``: (points,); ``ambient``: pressure [Pa].
    """

    channels: tuple[ObservedChannel, ...]
    grid: Array
    resting: NDArray[np.bool_]
    events: Mapping[str, tuple[float, float]]
    stated: Mapping[str, tuple[float, float]]
    phases: Mapping[str, float]
    end: float
    flow_end: float
    ambient: float
    common: Array | None = None
    alike: Array | None = None
    line_zero: float | None = None
    errors: tuple[float, float] = (FORM_ERROR, CHAMBER_FORM * FORM_ERROR)
    fuel_out: float | None = None
    flame_shown: float | None = None
    unknowns: tuple[Unknown, ...] = ()
    abrupt: float | None = None

    def with_errors(self, tank: float, chamber: float) -> Observed:
        """The same with another model-form error: parts [-] of the range of the tank's channels, and of chamber and
        thrust."""
        made = replace(self, errors=(tank, chamber))
        vars(made)["_groups"] = self._groups  # the same channels: what is made once for an error serves all
        return made

    def with_white_noise(self) -> Observed:
        """The same as if the noise of blocks were independent: what it costs to think so can be studied."""
        return replace(self, channels=tuple(c.with_white_noise() for c in self.channels), common=None, alike=None)

    def only(self, names: tuple[str, ...]) -> Observed:
        """The same with these channels alone."""
        kept = tuple(c for c in self.channels if c.name in names)
        common, alike = (
            shared if {*pair} <= {*names} else None for pair, shared in ((TOGETHER, self.common), (ALIKE, self.alike))
        )
        return replace(self, channels=kept, common=common, alike=alike)

    def without(self, left_out: Mapping[str, NDArray[np.bool_]]) -> Observed:
        """The same without some blocks of each channel: ``left_out`` (blocks,) by channel."""
        keep = {c.name: np.flatnonzero(~left_out[c.name]) for c in self.channels}
        common, alike = (
            None if shared is None else shared[np.ix_(*(keep[name] for name in pair))]
            for pair, shared in ((TOGETHER, self.common), (ALIKE, self.alike))
        )
        return replace(self, channels=tuple(c.only(keep[c.name]) for c in self.channels), common=common, alike=alike)

    @cached_property
    def log_size(self) -> float:
        """Log of the determinant of the covariance's root [natural log of SI], of the instants in units of their own
        deviations."""
        of_blocks = -float(sum(np.linalg.slogdet(factor)[1] for _, factor in self._factors))
        return of_blocks + sum(log(self.spread(name) / deviation) for name, (_, deviation) in self.events.items())

    def spread(self, event: str) -> float:
        """Standard deviation of measured less modeled instant [s] of an event.

        What a form gets wrong of the tank moves the end of its liquid by as large a part, and what nobody knows of a
        flow without fire moves it besides.
        """
        at, deviation = self.events[event]
        if event != "t_v":
            return deviation
        unburnt = max(at - self.fuel_out, 0.0) if self.fuel_out is not None else 0.0
        return hypot(deviation, self.errors[0] * at, WITHOUT_FIRE * unburnt)

    @cached_property
    def _groups(self) -> tuple[Group, ...]:
        """The channels by whose noise goes together."""
        return tuple(groups_of(self.channels, self.common, self.alike))

    @cached_property
    def _factors(self) -> tuple[tuple[slice, Array], ...]:
        """Inverse Cholesky factors of groups of channels, and their rows."""
        return tuple((group.place, group.whitening(self.errors)) for group in self._groups)

    @cached_property
    def slow_noise(self) -> SlowNoise:
        """What of the whitened noise is slow."""
        return slow_noise(self._groups, self.errors)

    def whiten(self, rows: Array) -> Array:
        """Rows (blocks of all channels one after the other, ...) [SI], in units in which the noise is white and of size
        one [-]."""
        return np.concatenate([factor @ rows[place] for place, factor in self._factors])

    def rewhitened(self, rows: Array, other: Observed) -> Array:
        """Rows that ``other`` has whitened, which differs in its model-form error only, as this one does.

        Rows of events follow the blocks'; those of what was stated, which come last, stay as they are.
        """
        out = rows.copy()
        for (place, factor), (_, before) in zip(self._factors, other._factors, strict=True):
            out[place] = factor @ solve_triangular(before, rows[place], lower=True)
        for row, name in enumerate(self.events, self._groups[-1].place.stop):
            out[row] *= other.spread(name) / self.spread(name)
        return out

    def left_open(self, residual: Array) -> tuple[float, float]:
        """Mean square [-] of a whitened residual (observations,) over the tank's channels, and over chamber and thrust;
        0 without any."""
        together = np.concatenate([np.full(c.time.size, c.name in TOGETHER) for c in self.channels])
        square = residual[: together.size] ** 2
        tank, chamber = (float(square[side].mean()) if side.any() else 0.0 for side in (~together, together))
        return tank, chamber

    @property
    def longest(self) -> float:
        """The last instant that anything is known of [s after the opening]."""
        weighed = self.flow_end if "fuel_mass_after" in self.stated else self.end
        return max([weighed, self.last, *(at for at, _ in self.events.values())])

    @property
    def last(self) -> float:
        """The last point of the grid while something flows [s after the opening]."""
        return float(self.grid[~self.resting][-1])

    @property
    def names(self) -> tuple[str, ...]:
        """Of the channels."""
        return tuple(c.name for c in self.channels)
