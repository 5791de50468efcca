"""m is shot along the tank alone: a blowdown's own exponent is found again."""

from __future__ import annotations

from dataclasses import astuple, replace

import numpy as np
import pytest

from hfanalysis.calibrate.blowdown import Inputs, Shift, Tables, VaporPhase, reduce, reduce_all
from hfanalysis.engine.blowdown import blow_down
from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.thermo.nitrous import saturation

FEED = FeedSystem(16.5e-3, 2.0e-5, 6.5e8)
TIME = np.arange(0.0, 9.0, 2e-3)
CHAMBER = 14e5 - 6e4 * TIME


def emptied(m: float) -> tuple[Tables, Inputs, float]:
    """What is measured of a blowdown, the instants of its vapor phase, and what is left at the end of it [kg]."""
    run = blow_down(saturation(), FEED, 8.0, 290.0, TIME, CHAMBER, m)
    t_end = run.t_v + 0.7
    dry = run.time > run.t_v
    line = np.polyfit(run.time[dry][:20] - run.t_v, run.pressure[dry][:20], 3)
    p_v = float(line[-1])
    p_end, left = (float(np.interp(t_end, TIME, x)) for x in (run.pressure, run.mass))
    tables = Tables(TIME, run.pressure, run.pressure, run.run_pressure, CHAMBER, run.pressure - run.run_pressure)
    return tables, Inputs(8.0, FEED.volume, FEED.area, 0.5, run.t_v, t_end, p_v, p_end), left


@pytest.mark.parametrize("m", [0.75, 1.0, 1.25])
def test_the_exponent_of_a_blowdown_is_found_again(m: float) -> None:
    tables, inputs, left = emptied(m)
    found, end = VaporPhase.plain(saturation(), inputs).shoot(tables, inputs, Shift(), FEED.area)
    assert found == pytest.approx(m, abs=5e-5)
    assert end == pytest.approx(left, rel=1e-5)


def test_a_pressure_that_no_exponent_reaches_has_none() -> None:
    tables, inputs, _ = emptied(1.0)
    phase = VaporPhase.plain(saturation(), inputs)
    fed = replace(inputs, p_end=1.1 * inputs.p_v)
    assert np.isnan(phase.shoot(tables, fed, Shift(), FEED.area)).all()
    assert np.isnan(phase.shoot(tables, replace(inputs, t_end=np.nan), Shift(), FEED.area)).all()


def test_what_is_behind_the_tank_comes_in_as_means_over_steps() -> None:
    """Of a swing that is fast beside the steps its mean is left."""
    tables, inputs, _ = emptied(1.0)
    swinging = replace(tables, chamber=CHAMBER + 1e5 * (-1.0) ** np.arange(TIME.size))
    at = np.linspace(inputs.t_v, inputs.t_end, 11)
    plain, swung = tables.behind(at)[1], swinging.behind(at)[1]
    assert swung == pytest.approx(plain, abs=0.1 * 1e5)


def test_many_reductions_at_once_are_each_as_if_by_itself() -> None:
    """Also one whose vapor phase has no exponent, one without a vapor phase, and one of which C_i and m are held."""
    tables, inputs, _ = emptied(1.0)
    inputs = replace(inputs, C_i=1.0)
    several = [
        inputs,
        replace(inputs, mass=8.1, p_v=0.995 * inputs.p_v, t_v=inputs.t_v + 2e-3),
        replace(inputs, p_end=1.1 * inputs.p_v),
        replace(inputs, t_end=np.nan),
        replace(inputs, C_i=1.02, m=1.1),
    ]
    shifts = [Shift(), Shift(2e4, -1e4, 1e4), Shift(), Shift(), Shift()]
    phase = VaporPhase.plain(saturation(), inputs)
    rows = np.array([astuple(x) for x in several]), np.array([astuple(x) for x in shifts])
    found = reduce_all(tables, saturation(), *rows, phase)
    for row, x, shift in zip(found, several, shifts, strict=True):
        assert row == pytest.approx(
            np.array(astuple(reduce(tables, saturation(), x, shift, phase))), rel=1e-6, nan_ok=True
        )
    assert found[0, 1] == pytest.approx(1.0, abs=1e-4)
    assert np.isfinite(found[1, 1])
    assert np.isnan(found[2, 1])
    assert np.isnan(found[3, 1])
    assert found[4, [0, 1]] == pytest.approx([1.02, 1.1])
