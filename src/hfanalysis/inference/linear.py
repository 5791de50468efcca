"""What a fit leaves open, as linear in splines at any place: its own parameters follow, their priors counted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.sensitivity import run_with_tangents
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.predict import AFTER, sensor_slopes, slopes_of, with_spare_fuel
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.places import PLACES, SourcePlace
from hfanalysis.inference.splines import Splines, probe

SCALES = np.geomspace(0.02, 4.0, 9)
"""Sizes of a source that are tried, in units of what is typical of its place."""

SPACING = 0.6
"""Seconds between the splines of a source."""


@dataclass(frozen=True)
class Projected:
    """Slopes with splines (n) and residual with the fit's parameters (m) projected out, their priors counted.

    ``information`` (n, n) and ``pull`` (n,) of the splines; the parameters (x) then move by ``start`` (m,) + ``follow``
    (m, n) times the coefficients.
    """

    information: Array
    pull: Array
    start: Array
    follow: Array


@dataclass(frozen=True)
class Linearized:
    """A fit to observations, with what splines at any place change in them.

    Raises ValueError or ArithmeticError where the engine cannot be run with all places open.
    """

    fitted: Fit
    observed: Observed

    @property
    def splines(self) -> Splines:
        """From the opening to the end of what is compared."""
        return Splines.over(0.0, self.observed.last, SPACING)

    @cached_property
    def everywhere(self) -> list[tuple[SourcePlace, Projected]]:
        """All places of the model that have no source yet, with :attr:`splines` at each."""
        return self.at(PLACES, self.splines)

    def at(self, places: Sequence[SourcePlace], splines: Splines) -> list[tuple[SourcePlace, Projected]]:
        """Those of the places that have no source yet, with splines at each; what is projected is whitened, by
        coefficients in the unit of the place."""
        hypothesis, observed = self.fitted.hypothesis, self.observed
        engine = hypothesis.as_run(self.fitted.x)
        taken = {a.effect.name for a in engine.effects}
        probes = {place: probe(place.name, splines, place.typical) for place in places}
        probes = {place: effect for place, effect in probes.items() if effect.name not in taken}
        probed = replace(engine, effects=(*engine.effects, *(effect.at(on=1.0) for effect in probes.values())))
        names = [f"{effect.name}.c{i}" for effect in probes.values() for i in range(splines.count)]
        tangents = run_with_tangents(
            with_spare_fuel(probed, observed.fuel_out), names, observed.longest + AFTER, run_on=True
        )
        columns = np.split(slopes_of(hypothesis, observed, tangents), len(probes), axis=1) if probes else []
        return [(place, self._project(own)) for place, own in zip(probes, columns, strict=True)]

    def read_by(self, sensor: str, splines: Splines) -> Projected:
        """With splines in what a sensor reads, by coefficients in its SI unit."""
        return self._project(sensor_slopes(self.observed, sensor, splines))

    def _project(self, columns: Array) -> Projected:
        a = self.fitted.slopes
        through = np.linalg.solve(a.T @ a + np.eye(a.shape[1]), a.T)
        # the fit has already moved its parameters: what is left is the residual less what they still explain
        r = self.fitted.residual - a @ self.fitted.x
        clear = columns - a @ (through @ columns)
        # (1 + A A^T)^-1 applied to columns and residual
        return Projected(columns.T @ clear, -(clear.T @ r), -(through @ r), -(through @ columns))
