"""The generator: its own physics, its own truth, and nothing of the package it is to test."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from simulated.blind import kernel, nitrous
from simulated.blind import sensors as se
from simulated.blind import slots as s
from simulated.blind import stand as st
from simulated.blind.build import Built, answer, build
from simulated.blind.detect import VALLEYS, Detector, fire_after_liquid, observed, rivals
from simulated.blind.effects import EFFECTS, EQUATIONS, LIBRARY, OUTSIDE, drawn, slots_of
from simulated.blind.observe import BLOCK, Observer, block_covariance
from simulated.blind.plan import MOST_CASES, MOST_SEEDS, SPLITS, Case, plan
from simulated.blind.write import answer_path, document, write_all

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def stand() -> st.Stand:
    """A stand with a purge line whose fuel is gone before the valve closes."""
    return st.draw(np.random.default_rng(11), burns_out=True, purge=True)


@pytest.fixture(scope="module")
def base(stand: st.Stand) -> st.Histories:
    return st.simulate(stand)


@cache
def built(case: Case) -> Built:
    """A case that is built once for the tests of this file."""
    return build(case)


def test_no_module_imports_the_package_under_test() -> None:
    for path in (ROOT / "simulated" / "blind").glob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        names = [a.name for node in ast.walk(tree) if isinstance(node, ast.Import) for a in node.names]
        names += [node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
        assert not [n for n in names if n.split(".")[0] == "hfanalysis"], path.name


def test_making_a_case_loads_nothing_of_the_package_under_test() -> None:
    code = (
        "import sys; from simulated.blind import write, score; from simulated.blind.build import build\n"
        "from simulated.blind.plan import Case\n"
        "build(Case('X', 'none', (), 0.0, 'ar1', 5, 5))\n"
        "sys.exit(any(name.split('.')[0] == 'hfanalysis' for name in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=False).returncode == 0


def test_the_eighteen_expected_effects_and_at_least_eight_others_half_of_them_cited() -> None:
    assert len(LIBRARY) == 18
    assert len(OUTSIDE) >= 8
    assert sum(bool(e.source) for e in OUTSIDE) >= len(OUTSIDE) / 2
    assert {q for e in EFFECTS.values() for q in e.equations} <= set(EQUATIONS)


def test_tank_and_chamber_close_in_mass(base: st.Histories, stand: st.Stand) -> None:
    o = base.traces
    left = o[0, s.M_TANK] - o[-1, s.M_TANK]
    assert left == pytest.approx(np.trapezoid(o[:, s.TANK_FLOW], dx=kernel.STEP), rel=3e-4)
    burning = slice(100, int(1000 * base.t_v))
    entered, left = (
        (o[burning, s.FLOW] + o[burning, s.FUEL]).sum() * kernel.STEP,
        o[burning, s.NOZZLE_FLOW].sum() * kernel.STEP,
    )
    stored = o[burning.stop, s.CHAMBER_MASS] - o[burning.start, s.CHAMBER_MASS]
    # flows are recorded at the start of a step, within which the exponential moves them: a part in ten thousand
    assert entered - left == pytest.approx(stored, abs=1e-4 * entered)


def test_the_saturated_tank_closes_in_energy(base: st.Histories, stand: st.Stand) -> None:
    o, tab, last = base.traces, nitrous.table(), int(1000 * base.t_v) - 1
    u = [nitrous.internal_energy(tab, o[k, s.T_TANK], o[k, s.M_TANK], stand.volume) for k in (0, last)]
    carried = np.trapezoid((o[:, s.TANK_FLOW] * o[:, s.OUT_ENTHALPY])[: last + 1], dx=kernel.STEP)
    assert u[0] - u[1] == pytest.approx(carried, rel=1e-5)


def test_the_fuel_burns_what_was_loaded(base: st.Histories, stand: st.Stand) -> None:
    assert np.isfinite(base.t_fuel_out)
    assert base.trace(s.FUEL).sum() * kernel.STEP == pytest.approx(stand.fuel_mass, rel=1e-3)


def test_the_vapor_is_a_polytrope_of_the_stated_exponent(base: st.Histories, stand: st.Stand) -> None:
    o = base.traces[int(1000 * base.t_v) + 5 : int(1000 * stand.closing) - 2]
    p, mass = np.diff(np.log(o[:, s.P_TANK])), np.diff(np.log(o[:, s.M_TANK]))
    slope = (p / np.where(mass < 0.0, mass, np.nan))[mass < -1e-8]
    assert len(slope) > 3000
    assert slope == pytest.approx(stand.m, rel=1e-6)


def test_the_steps_are_close_to_a_smooth_solution(base: st.Histories) -> None:
    o = base.traces
    inside = slice(200, int(1000 * base.t_v) - 5)
    rate = np.gradient(o[:, s.M_TANK], kernel.STEP)[inside]
    assert -rate == pytest.approx(o[inside, s.TANK_FLOW], rel=1e-5)


@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_of_no_strength_is_the_base_test_bit_for_bit(name: str, stand: st.Stand, base: st.Histories) -> None:
    hidden = drawn(EFFECTS[name], np.random.default_rng(3))
    channels, true = observed(stand, (hidden.at(0.0),))
    assert np.array_equal(channels, base.traces[:, :6])
    assert np.array_equal(true.traces, base.traces)


@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_of_the_largest_plausible_strength_shows(name: str, stand: st.Stand, base: st.Histories) -> None:
    hidden = drawn(EFFECTS[name], np.random.default_rng(3))
    channels, true = observed(stand, (hidden.at(hidden.effect.most),))
    assert np.isfinite(channels).all()
    assert np.isfinite(true.traces).all()
    assert not np.allclose(channels, base.traces[:, :6], rtol=1e-3)


@pytest.mark.parametrize("name", EFFECTS)
def test_the_chamber_does_not_chatter_from_step_to_step(name: str, stand: st.Stand) -> None:
    o = observed(stand, (drawn(EFFECTS[name], np.random.default_rng(3)),))[1].traces
    bend = np.diff(o[100 : int(1000 * stand.closing), s.P_CHAMBER], 2)
    chatter = np.minimum(np.abs(bend[1:]), np.abs(bend[:-1])) * (bend[1:] * bend[:-1] < 0.0)
    # a few steps at events are kinks, not chatter
    assert (chatter > 300.0).sum() <= 12


def test_mass_closes_with_every_physical_effect_at_once(stand: st.Stand) -> None:
    rng = np.random.default_rng(4)
    o = st.simulate(stand, slots_of(tuple(drawn(e, rng) for e in EFFECTS.values()))).traces
    lost = np.trapezoid(o[:, s.TANK_FLOW] - o[:, s.TANK_SOURCE], dx=kernel.STEP)
    assert o[0, s.M_TANK] - o[-1, s.M_TANK] == pytest.approx(lost, rel=2e-3)


@pytest.mark.parametrize("family", se.FAMILIES)
def test_noise_has_the_covariance_that_detectability_uses(family: str) -> None:
    rng = np.random.default_rng(8)
    sensor = se.draw(rng, family).sensor("p_tank")
    lags = np.arange(61 * BLOCK) / se.RATE
    expected = sum((a * a * np.exp(-lags / tau) for a, tau in sensor.slow), np.zeros(len(lags)))
    expected[0] += sensor.white**2
    theory = block_covariance(expected, 60)
    means = np.array(
        [
            (se.slow_noise(rng, sensor.slow, 60 * BLOCK) + rng.normal(0.0, sensor.white, 60 * BLOCK))
            .reshape(60, BLOCK)
            .mean(1)
            for _ in range(600)
        ]
    )
    assert (means**2).mean() == pytest.approx(theory[0], rel=0.15)
    assert (means[:, :-5] * means[:, 5:]).mean() == pytest.approx(theory[5], abs=0.15 * theory[0])


def test_what_the_test_excludes_after_the_valve_has_closed_is_no_evidence() -> None:
    rng = np.random.default_rng(5)
    stand = st.draw(rng)
    channels, base = observed(stand, ())
    observer = Observer.of(stand, base, se.draw(rng, "flicker"))
    means = observer.means(channels, base)
    late = observer.centers[observer.used] > stand.closing
    assert late.sum() > 20
    moved, shifted = means.copy(), means.copy()
    moved[late, s.P_TANK] += 1e5
    shifted[late, s.P_CHAMBER] += 1e5
    same = observer.whitened(means, base)
    assert np.array_equal(observer.whitened(moved, base), same)
    assert not np.array_equal(observer.whitened(shifted, base), same)


@pytest.mark.parametrize(
    ("seed", "shift", "at_rest"),
    [
        (seed, *shown)
        for seed in (7, 11)
        for shown in (({s.P_CHAMBER: 1e4, s.THRUST: 10.0}, True), ({s.P_RUN: 1e4}, False))
    ],
)
def test_how_a_chamber_flushes_after_its_fire_is_no_evidence(seed: int, shift: dict[int, float], at_rest: bool) -> None:
    """A model of the flush to the per mille would see slivers of a hundredth of a millimeter in it."""
    rng = np.random.default_rng(seed)
    stand = st.draw(rng, burns_out=True)
    channels, base = observed(stand, ())
    observer = Observer.of(stand, base, se.draw(rng, "ar1"))
    means, at = observer.means(channels, base), observer.centers[observer.used]
    out = base.t_fuel_out
    same = observer.whitened(means, base)
    spans = ((out, stand.closing, False), (out - 0.3, out - 0.1, True), (stand.closing, 99.0, at_rest))
    for first, last, counts in spans:
        moved, there = means.copy(), (at > first) & (at < last)
        assert there.any()
        for channel, change in shift.items():
            moved[there, channel] += change
        assert np.array_equal(observer.whitened(moved, base), same) is not counts


def test_a_nozzle_that_has_unchoked_ends_what_chamber_and_thrust_tell() -> None:
    rng = np.random.default_rng(5)
    stand = st.draw(rng, burns_out=False)
    channels, base = observed(stand, ())
    observer = Observer.of(stand, base, se.draw(rng, "ar1"))
    means, at = observer.means(channels, base), observer.centers[observer.used]
    ratio = np.interp(at, base.time, base.trace(s.P_CHAMBER)) / stand.ambient
    unchoked, moved = (ratio < 1.7) & (at > base.t_v) & (at < stand.closing), means.copy()
    assert unchoked.sum() > 20
    moved[unchoked, s.P_CHAMBER] += 1e4
    assert np.array_equal(observer.whitened(moved, base), observer.whitened(means, base))
    moved[(ratio > 1.9) & (at > base.t_v), s.P_CHAMBER] += 1e4
    assert not np.array_equal(observer.whitened(moved, base), observer.whitened(means, base))


def test_a_heavier_tank_is_heavier_at_rest_too(stand: st.Stand, base: st.Histories) -> None:
    """As for the log, so for what calibration may make of it: else its cell at rest would tell the mass to grams."""
    observer = Observer.of(stand, base, se.draw(np.random.default_rng(9), "ar1"))
    heavier = st.simulate(replace(stand, mass=stand.mass + 0.1))
    means = [observer.means(run.traces[:, : len(s.CHANNELS)], run)[:, s.M_TANK] for run in (base, heavier)]
    resting = observer.centers[observer.used] < -0.1
    assert resting.sum() > 10
    assert means[0][resting] == pytest.approx(stand.mass)
    assert means[1][resting] == pytest.approx(stand.mass + 0.1)


@pytest.mark.parametrize("family", se.FAMILIES)
def test_whitened_noise_of_a_whole_log_is_white_and_of_unit_size(
    family: str, stand: st.Stand, base: st.Histories
) -> None:
    rng = np.random.default_rng(9)
    instruments = se.draw(rng, family)
    observer = Observer.of(stand, base, instruments)
    t = np.arange(-1000, len(base.time) - 1) / se.RATE + 2e-4
    ideal = np.where(t[:, None] < 0.0, se.rest(stand, base), se._sampled(base.traces[:, :6], t))
    swing = np.interp(t, base.time, se.envelope(base, stand.ambient), left=0.0)
    measured = se._measured(rng, ideal, swing, stand, instruments)
    size, zero, gain = (np.array([getattr(x, k) for x in instruments.sensors]) for k in ("size", "zero", "gain"))
    noise = (measured - zero) * size - ideal * (1.0 + gain)
    blocks = len(observer.centers)
    means = noise[: blocks * BLOCK].reshape(blocks, BLOCK, 6).mean(axis=1)[observer.used]
    white = observer.whitened(means, base)[:-2]
    assert np.mean(white**2) == pytest.approx(1.0, abs=0.1)
    assert np.mean(white[1:] * white[:-1]) == pytest.approx(0.0, abs=0.06)


def test_the_oscillation_has_unit_variance_and_the_stated_covariance() -> None:
    o = se.Oscillation(45.0, 6.0, 0.01, 1.0)
    x = se.narrow_band(np.random.default_rng(0), o.poles, 400_000)
    rho = se.narrow_band_covariance(o.poles, 30)
    assert x.var() == pytest.approx(1.0, rel=0.05)
    assert np.mean(x[:-11] * x[11:]) == pytest.approx(rho[11], abs=0.05)


def test_detectability_is_proportional_to_small_strengths(stand: st.Stand) -> None:
    rng = np.random.default_rng(2)
    detector = Detector(stand, se.draw(rng, "ar1"), rivals(rng))
    heat = detector.rivals["tank_heat"]
    one, two = (detector.d_prime((heat.at(p),))[0] for p in (25.0, 50.0))
    assert two == pytest.approx(2.0 * one, rel=0.05)


def test_calibration_swallows_most_of_what_a_nuisance_can_imitate(stand: st.Stand) -> None:
    rng = np.random.default_rng(2)
    detector = Detector(stand, se.draw(rng, "ar1"), rivals(rng))
    loss = detector.rivals["feed_line_flashing"]
    raw = float(np.linalg.norm(detector.response((loss,))))
    assert detector.d_prime((loss,))[0] < 0.5 * raw
    other_injector = detector.response((), np.array([0.01, 0, 0, 0, 0, 0, 0]))
    assert np.sqrt(detector.fit(other_injector).chi2) < 0.02 * np.linalg.norm(other_injector)


def test_fire_that_the_test_does_not_have_tells_nothing() -> None:
    """With the effect the fuel lasts far shorter after the liquid than without it: the blocks are those of the test."""
    rng = np.random.default_rng(2_010_486)
    brief = st.draw(rng, burns_out=True, purge=None)
    detector = Detector(brief, se.draw(rng, "mixed"), rivals(rng))
    grain, heat = (detector.rivals[name] for name in ("grain_pressure_regression", "tank_heat"))
    d, fit = detector.d_prime((grain.at(0.7),))
    own = detector.on_axis_of((grain.at(0.7),), fit)
    without, with_it = (fire_after_liquid(observed(brief, h)[1]) for h in ((), (grain.at(0.7),)))
    assert 0.0 < with_it < 0.5 * without
    assert own.d_prime((grain.at(0.7),))[0] < 0.7 * d
    assert detector.on_axis_of((heat,), detector.d_prime((heat,))[1]) is detector


@pytest.mark.parametrize(
    ("cases", "seed", "number", "strength", "starts", "strides", "found", "of_one_start"),
    [
        # a little, where the pressure falls to a quarter: a and n do the same
        (600, 0, "C000039", 0.315, VALLEYS[-1:], 0, 2.0, 8.0),
        # no straight line leads along the valley: it is walked, n by n
        (1500, 9, "C090337", 0.17, (), 3, 6.0, 14.0),
    ],
)
def test_another_exponent_of_regression_may_imitate_what_no_step_from_here_leads_to(
    cases: int,
    seed: int,
    number: str,
    strength: float,
    starts: tuple[float, ...],
    strides: int,
    found: float,
    of_one_start: float,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Regressions that depend on pressure; looked for only where, and as far as, they are imitated."""
    case = next(c for c in plan(cases, "calibration", seed) if c.id == number)
    monkeypatch.setattr(
        "simulated.blind.build._set_strengths", lambda detector, hidden, case: tuple(h.at(strength) for h in hidden)
    )
    monkeypatch.setattr("simulated.blind.detect.VALLEYS", starts)
    monkeypatch.setattr("simulated.blind.detect.STRIDES", strides)
    monkeypatch.setattr("simulated.blind.build.Detector.against", lambda detector, fit, rival: np.inf)  # not asked for
    made = build(case)
    one_start, _ = Detector(made.stand, made.instruments).d_prime(made.hidden)
    assert made.detectability["d_prime"] < found < of_one_start < one_start


def test_a_fit_follows_what_nuisances_imitate_along_a_bent_valley() -> None:
    lasting = st.draw(np.random.default_rng(11), burns_out=False, purge=True)
    rng = np.random.default_rng(2)
    detector = Detector(lasting, se.draw(rng, "ar1"), rivals(rng))
    away = np.array([0.0, 0.0, 0.0, -0.6, 0.1, 0.0, 0.0])
    other_fuel = detector.response((), away)
    penalty = float(np.linalg.norm(away / detector.priors[: away.size]))
    assert np.sqrt(detector.quick_fit(other_fuel).chi2) > 5.0 * penalty
    assert np.sqrt(detector.fit(other_fuel).chi2) <= 1.01 * penalty


@pytest.mark.parametrize(
    ("name", "target"),
    [("tank_heat", 8.0), ("nozzle_throat_erosion", 4.0), ("load_cell_drift", 16.0), ("grain_pressure_regression", 4.0)],
)
def test_the_detectability_asked_for_is_met(name: str, target: float) -> None:
    case = Case("X", "single", (name,), target, "flicker", 21, 21)
    a = answer(built(case))
    assert a["d_prime"] == pytest.approx(target, rel=0.05)
    assert all(d <= a["d_prime"] * 1.001 for d in a["against"].values())
    assert not a["effects"][0]["at_most_plausible"]


def test_a_case_is_the_same_from_the_same_seed_and_another_from_another() -> None:
    case = Case("X", "single", ("tank_heat",), 8.0, "flicker", 21, 21)
    first, second = built(case), build(case)
    assert np.array_equal(first.log.values, second.log.values, equal_nan=True)
    assert json.dumps(answer(first)) == json.dumps(answer(second))
    other = build(Case("X", "none", (), 0.0, "mixed", 32, 32))
    assert other.stand != first.stand


def test_tests_of_one_stand_share_the_effect_and_the_hardware_but_not_the_load() -> None:
    shared = {
        "kind": "stand",
        "effects": ("tank_heat",),
        "target": 8.0,
        "family": "ar1",
        "stand_seed": 41,
        "stand": "stand-x",
    }
    a = build(Case("XA", seed=41, **shared))
    b = build(Case("XB", seed=42, second=True, **shared))
    assert a.hidden == b.hidden
    assert (a.stand.C_i, a.stand.K_loss, a.stand.a, a.stand.n) == (b.stand.C_i, b.stand.K_loss, b.stand.a, b.stand.n)
    assert a.stand.mass != b.stand.mass
    assert 'stand = "stand-x"' in document(a)


def test_the_answer_names_phase_onset_and_source_of_a_step() -> None:
    a = answer(build(Case("X", "outside", ("injector_hydraulic_flip",), 8.0, "ar1", 51, 51)))
    effect = a["effects"][0]
    assert effect["onset"] == pytest.approx(effect["shape"]["flip_start"], abs=0.02)
    assert effect["phases"] == ["liquid"]
    assert effect["equation"] == "injector"
    assert max(effect["source"]["values"]) <= 1e-3 < -min(effect["source"]["values"]) + 1e-3
    assert a["after_best_of_library"] == pytest.approx(8.0, rel=0.1)


def test_the_plan_is_deterministic_and_its_seeds_never_meet() -> None:
    assert plan(100, "scored") == plan(100, "scored")
    seeds = {split: {c.seed for c in plan(200, split, seed)} for split in SPLITS for seed in (0, MOST_SEEDS - 1)}
    assert not set.intersection(*seeds.values())
    starts = sorted(SPLITS.values())
    assert all(b - a >= MOST_CASES * MOST_SEEDS for a, b in pairwise(starts))
    assert len({c.id for c in plan(200)}) == 200


def test_the_full_plan_holds_every_effect_at_every_strength_and_300_tests_without() -> None:
    cases = plan(1500, "scored")
    none = [c for c in cases if c.kind == "none"]
    assert len(none) >= 300
    assert {f: sum(c.family == f for c in none) for f in se.FAMILIES} == dict.fromkeys(se.FAMILIES, len(none) // 3)
    single = {(c.effects[0], c.target) for c in cases if c.kind == "single"}
    assert single == {(e.name, t) for e in LIBRARY for t in (1, 2, 4, 8, 16, 32)}
    assert {c.effects[0] for c in cases if c.kind == "outside"} == {e.name for e in OUTSIDE}
    assert sum(c.kind == "pair" for c in cases) >= 100
    assert sum(c.second for c in cases) >= 70


def test_the_smoke_plan_holds_every_kind() -> None:
    assert {c.kind for c in plan(20)} == {"none", "single", "outside", "pair", "stand"}


def test_the_writer_goes_on_where_it_was_stopped(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cases = [Case(f"X{i}", "none", (), 0.0, "ar1", 60 + i, 60 + i) for i in range(2)]
    assert write_all(cases[:1], tmp_path) == []
    first = answer_path(cases[0], tmp_path)
    before = first.stat().st_mtime_ns
    assert write_all(cases, tmp_path) == []
    assert first.stat().st_mtime_ns == before
    assert answer_path(cases[1], tmp_path).exists()
    assert "2 cases, 1 there" in capsys.readouterr().err
    assert sorted(p.name for p in (tmp_path / "raw_tests" / "X0").iterdir()) == ["log.csv", "test.toml"]
