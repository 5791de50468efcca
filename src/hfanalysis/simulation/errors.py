"""Errors of an engine's constants together, put on an engine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import exp

from hfanalysis.engine.unsteady import Engine


def off_by(engine: Engine, off: Mapping[str, float], measured_on: Engine) -> Engine:
    """An engine whose constants are off by what ``off`` has of them [SI], by the names of calibration.json's ``joint``.

    The errors are those of the engine ``measured_on``; areas and ``a`` are off by the same share of another's.
    """
    feed, m = engine.feed, engine.polytropic_exponent
    ln_a = off.get("ln_a", off.get("a", 0.0) / measured_on.a)
    return replace(
        engine,
        feed=replace(
            feed,
            volume=feed.volume + off.get("volume", 0.0),
            area=feed.area * exp(off.get("flow_area", 0.0) / measured_on.feed.area),
            loss_factor=max(feed.loss_factor + off.get("K_loss", 0.0), 0.0),
        ),
        oxidizer_mass=engine.oxidizer_mass + off.get("oxidizer_mass", 0.0),
        fuel_mass=engine.fuel_mass + off.get("fuel_mass", 0.0),
        polytropic_exponent=None if m is None else m + off.get("m", 0.0),
        a=engine.a * exp(ln_a),
        n=engine.n + off.get("n", 0.0),
        throat_area=engine.throat_area * exp(off.get("throat_area", 0.0) / measured_on.throat_area),
    )
