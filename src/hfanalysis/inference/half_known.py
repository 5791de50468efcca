"""Engines that are known in part: numbers stated as ranges, and where a fit starts that has no calibrated engine.

``throat_radius = "18.7 mm +/- 10 %"``: such a number is a constant that may move, with that prior, as those are that a
calibration finds. Where the calibration has no a and n, or no saturated tank comes down to what was measured, a fit
with all constants free needs no more than an engine that is near enough.
"""

from __future__ import annotations

from dataclasses import replace
from math import log1p

import numpy as np

from hfanalysis.assembly.calibrated import Regression, engine_of_test
from hfanalysis.engine.grain import USUAL_N
from hfanalysis.engine.unsteady import Engine
from hfanalysis.errors import AbsentError
from hfanalysis.inference.fitting.hypothesis import Free, Hypothesis, mid_flux
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition

STATED = {
    "volume": (("tank.volume",), 1.0),
    "fuel_mass": (("grain.mass",), 1.0),
    "grain_length": (("grain.length",), 1.0),
    "outer_radius": (("grain.outer_radius",), 1.0),
    "fuel_density": (("grain.density",), 1.0),
    "dead_volume": (("chamber.pre_volume", "chamber.post_volume"), 1.0),
    "throat_area": (("nozzle.throat_radius",), 2.0),
    "exit_area": (("nozzle.exit_radius",), 2.0),
}
"""Numbers of an engine, the keys of test.toml that they are the sum of, and the power of that sum that they are."""

SHORTEST = 0.5
"""Least burn time [s] that a first guess of the regression is made of. Source: by choice; no grain is gone sooner."""


def ranges(definition: TestDefinition) -> dict[str, float]:
    """Relative standard deviations [-] of the numbers in STATED whose ``+/-`` test.toml states."""
    found = {}
    for name, (keys, power) in STATED.items():
        stated = (getattr(getattr(definition, section), key, None) for section, key in map(_parts, keys))
        values = [value for value in stated if value is not None]
        spread = float(np.hypot.reduce([value.std or 0.0 for value in values], initial=0.0))
        if spread > 0.0:
            found[name] = power * spread / sum(value.value for value in values)
    return found


def _parts(key: str) -> tuple[str, str]:
    section, _, own = key.partition(".")
    return section, own


def with_ranges(hypothesis: Hypothesis, definition: TestDefinition) -> Hypothesis:
    """The hypothesis with every number free that is stated as a range."""
    engine = hypothesis.engine
    own = {"volume": engine.feed.volume}
    more = tuple(
        Free(name, own[name] if name in own else getattr(engine, name), log1p(part), "positive", unsure=False)
        for name, part in ranges(definition).items()
    )
    return replace(hypothesis, free=(*hypothesis.free, *more))


def near_enough(segments: Segments, calibration: Calibration, definition: TestDefinition) -> Engine:
    """An engine to start a fit from where the calibration's cannot be run: its tank as warm as the blowdown starts, its
    fuel burnt in the time that the log shows, with the exponent that fuels have.

    Raises AbsentError where the tank's temperature or the burn time is not known, or the engine is not stated.
    """
    rest = calibration.rest
    if rest is None or rest.bulk_temperature.value is None:
        raise AbsentError("the temperature that the blowdown starts from is not known")
    lasts = segments.time("t_fuel_out") or segments.time("t_end")
    if lasts is None:
        raise AbsentError("the log does not show how long the fuel burns")
    engine = engine_of_test(definition, calibration, rest.bulk_temperature.value, Regression(1e-4, USUAL_N[0]))
    web = engine.outer_radius - engine.port_radius
    rate = web / max(lasts, SHORTEST)
    return replace(engine, a=rate / mid_flux(engine) ** engine.n)
