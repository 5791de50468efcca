"""Where, when and how much: on made-up observations whose truth is known."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from tests.diagnose.made import hypothesis, observed
from tests.engine.stand import engine_on_stand

from hfanalysis.diagnose.fit import fit, predict
from hfanalysis.diagnose.localise import LEAST_EVIDENCE, Localisation, localise
from hfanalysis.diagnose.of_test import gap, place
from hfanalysis.diagnose.probe import Splines, probe
from hfanalysis.diagnose.words import sentence
from hfanalysis.effects import effect
from hfanalysis.engine.unsteady import burn
from hfanalysis.quantity import Quantity


@cache
def localised(name: str) -> Localisation:
    cases = {
        "none": lambda: observed(),
        "heat": lambda: observed(effect("tank_heat").at(power=6000.0)),
        "thrust": lambda: observed(offsets={"thrust": 150.0}),
    }
    return localise(hypothesis(), cases[name]())


def test_the_constants_come_back_from_a_wrong_start() -> None:
    found = fit(hypothesis(), observed())
    truth = engine_on_stand()
    assert found.converged
    for name, value in (("area", truth.feed.area), ("oxidizer_mass", 8.35), ("temperature", 293.0)):
        index = found.hypothesis.names.index(name)
        spread = np.sqrt(found.covariance[index, index]) * found.hypothesis.jacobian(found.x)[index, index]
        assert abs(found.values[name] - value) < 4.0 * spread
    assert hypothesis().values(np.zeros(hypothesis().size))["area"] != pytest.approx(truth.feed.area, rel=0.02)


def test_the_residual_of_the_truth_is_white() -> None:
    found = fit(hypothesis(), observed())
    assert np.mean(found.residual**2) == pytest.approx(0.9, abs=0.25)


def test_slopes_are_differences_of_predictions() -> None:
    x = np.zeros(hypothesis().size)
    here = predict(hypothesis(), observed(), x, tangents=True)
    assert here.slopes is not None
    for k in range(x.size):
        up, down = (
            predict(hypothesis(), observed(), x + s * 1e-3 * np.eye(x.size)[k], tangents=False) for s in (1, -1)
        )
        quotient = (up.residual - down.residual) / 2e-3
        quiet = np.abs(here.slopes[:, k] - quotient) < 0.02 * np.abs(quotient).max() + 0.05
        # beside the end of the liquid, which moves, a difference of runs is no derivative
        assert quiet.mean() > 0.95


def test_where_nothing_is_missing_no_source_is_claimed() -> None:
    assert localised("none").sources == ()
    assert localised("none").ranking[0].log_evidence < LEAST_EVIDENCE


def test_heat_into_the_tank_is_found_in_its_energy_equation() -> None:
    found = localised("heat")
    where = place(found.sources[0], found.observed)
    assert where["equation"] == "tank_energy"
    plain = {k: v.to_json() if isinstance(v, Quantity) else v for k, v in where.items()}
    assert "the tank" in sentence(plain)


def test_the_heat_has_its_size() -> None:
    source = localised("heat").sources[0]
    if source.site.name != "tank_heat":
        pytest.fail(f"the source was placed at {source.site.name}")
    middle = (source.time > 1.0) & (source.time < 4.0)
    assert source.mean[middle].mean() == pytest.approx(6000.0, abs=3.0 * source.std[middle].mean() + 600.0)


def test_a_step_of_the_load_cell_is_a_sensors() -> None:
    found = localised("thrust")
    assert found.sources[0].site.name in ("offset of thrust", "thrust_factor")
    late = found.sources[0].time > 3.6
    assert np.abs(found.sources[0].mean[late]).mean() > 2.0 * np.abs(found.sources[0].mean[~late]).mean()


def test_with_its_source_the_gap_closes() -> None:
    found = gap(localised("heat"))
    assert found["after"]["p_tank"] < found["before"]["p_tank"]


def test_splines_sum_to_one_where_they_reach() -> None:
    splines = Splines.over(0.0, 5.0, 0.6)
    assert splines.at(np.linspace(0.0, 5.0, 50)).sum(axis=1) == pytest.approx(1.0)


def test_a_probe_adds_its_splines_to_its_site() -> None:
    splines = Splines.over(0.0, 4.0, 1.0)
    constant = {f"c{i}": 700.0 for i in range(splines.count)}
    probed = engine_on_stand(effects=(probe("tank_heat", splines, 1000.0).at(on=1.0, **constant),))
    heated = engine_on_stand(effects=(effect("tank_heat").at(power=700.0),))
    times = np.linspace(0.1, 3.9, 20)
    theirs, ours = (burn(e, 4.0, 1e-7, times=times).output("tank_pressure") for e in (heated, probed))
    assert ours == pytest.approx(theirs, rel=1e-6)
