"""What to test next: what is told of a constant goes with what moves by it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.cli.run import hfa
from tests.cli.shaped import MAELSTROM
from tests.simulation.test_spread import file

from hfanalysis.errors import InputError
from hfanalysis.inference.adopted.effects import Adopted
from hfanalysis.products.engines import NextTests
from hfanalysis.simulation import next_test
from hfanalysis.simulation.next_test import CHANGES, next_tests
from hfanalysis.simulation.scatter import PRIOR_SCATTER

LAW = {"names": ["n", "ln_a"], "std": [0.05, 0.25], "correlation": [[1.0, -0.99], [-0.99, 1.0]]}


def found(wanted: str | None = None, **errors: Any) -> NextTests:
    return next_tests(file(covariance={**LAW, **errors}), Adopted(), wanted)


def by_name(told: NextTests) -> dict[str, float]:
    return {row.name: row.std for row in told.tests if row.std is not None}


def test_what_is_told_is_the_best_linear_estimate() -> None:
    """Of two readings of one unknown: by hand, 1/s^2 = 1/1 + 1/(c s_1)^2 + 1/(c s_2)^2."""
    rng = np.random.default_rng(3)
    unknown = rng.standard_normal(200_000)
    read = {"impulse": 0.02 * unknown, "chamber_pressure": 0.05 * unknown}
    told = next_test._after(unknown, read, ("thrust cell", "chamber gauge"))
    by_hand = (1.0 + (0.02 / 0.01) ** 2 + (0.05 / 0.01) ** 2) ** -0.5
    assert told == pytest.approx(by_hand, rel=0.02)
    assert next_test._after(unknown, {}, ("burn time",)) == pytest.approx(1.0, rel=0.01)


def test_an_exponent_alone_is_told_by_any_burn() -> None:
    """With nothing else unknown, and as much scatter as tests of a stand have."""
    told = found("n", names=["n"], std=[0.05], correlation=[[1.0]])
    assert told.std == pytest.approx(0.05, rel=0.15)
    assert by_name(told)["as before"] < 0.6 * told.std
    assert all(std <= told.std for std in by_name(told).values())


def test_every_test_is_told_or_says_why_not() -> None:
    told = found()
    assert {row.name for row in told.tests} == set(CHANGES)
    assert all((row.std is None) == (row.reason is not None) for row in told.tests)
    full = next(row for row in told.tests if row.name == "10 K warmer")
    assert "holds" in str(full.reason)  # of a tank with 20 % ullage at 25 degC


def test_the_apogee_s_deviation_is_that_of_draws() -> None:
    from hfanalysis.simulation.unsteady_run import simulate

    bound = {"names": ["n", "ln_a"], "std": [0.01, 0.05], "correlation": [[1.0, -0.9], [-0.9, 1.0]]}
    drawn = simulate(file(covariance=bound), None, 400).product.flight.apogee.std
    assert found(**bound).std == pytest.approx(drawn, rel=0.2)


def test_another_seed_leaves_the_best_the_best() -> None:
    one, two = (list(by_name(next_tests(file(covariance=LAW), Adopted(), "n", seed))) for seed in (1, 2))
    assert one[0] == two[0]
    assert len(set(one[:3]) & set(two[:3])) >= 2


def test_how_well_the_fired_load_is_known_is_no_part_of_the_next_engine_s() -> None:
    def spread(load: float) -> float:
        return found(names=["n", "oxidizer_mass"], std=[0.02, load], correlation=[[1.0, 0.0], [0.0, 1.0]]).std

    assert spread(0.3) == pytest.approx(spread(1e-6), rel=1e-9)


def test_without_scatter_between_tests_more_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    with_it = by_name(found("n"))
    monkeypatch.setattr(next_test, "PRIOR_SCATTER", dict.fromkeys(PRIOR_SCATTER, 1e-6))
    without = by_name(found("n"))
    assert without["two thirds of the holes"] < 0.9 * with_it["two thirds of the holes"]


def test_a_sensor_is_worth_nothing_less_than_nothing() -> None:
    told = found("n")
    worth = [one.worth for one in told.sensors]
    assert worth == sorted(worth, reverse=True)
    assert worth[0] > 0.0
    assert min(worth) >= 0.0


def test_what_is_no_target_or_has_no_errors_is_refused() -> None:
    with pytest.raises(InputError, match="expected apogee, total_impulse or one of n, ln_a"):
        found("weather")
    status, _, err = hfa("next", MAELSTROM)
    assert status == 2
    assert "covariance" in err


def test_the_command_ranks_and_says_what_the_deviation_is(tmp_path: Any) -> None:
    path = tmp_path / "engine.toml"
    rows = [list(map(float, row)) for row in np.array(LAW["correlation"])]
    text = f"[covariance]\nnames = {LAW['names']}\nstd = {LAW['std']}\ncorrelation = {rows}\n".replace("'", '"')
    path.write_text(MAELSTROM.read_text(encoding="utf-8") + "\n" + text, encoding="utf-8")
    status, out, _ = hfa("next", path, "--for", "n")
    assert status == 0
    assert "four thirds of the holes" in out
    assert "worth of each sensor" in out
