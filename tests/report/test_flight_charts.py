"""Lines of a flight are the model's: whole, however its solver stepped."""

from __future__ import annotations

import numpy as np

from hfanalysis.report.flight_charts import FlightCurves


def test_a_coast_in_longer_steps_than_the_burn_is_drawn_whole() -> None:
    """A burn of three seconds has steps of 3 ms, the coast after it of 50 ms: in a log that would be a hole."""
    time = np.concatenate([np.arange(0.0, 3.0, 3e-3), np.arange(3.0, 25.0, 0.05)])
    curves = FlightCurves({"ascent": {"time": time, "height": 120.0 * time}}, None, 3.0)
    chart = curves.curve("height")
    assert chart is not None
    (line,) = chart.lines
    drawn = line.reduced(*chart.span, 24_000)
    inside = (drawn.time > 0.1) & (drawn.time < 24.9)
    assert inside.sum() > 400
    assert np.isfinite(drawn.mean[inside]).all()
