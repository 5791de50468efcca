"""Tests of other worlds: laws that are neutral where they are none, and counts that say what was found."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from benchmarks.reference_engine import Reference
from benchmarks.worlds import Scored, Study, figures, found_path, refused, run_one, scored
from benchmarks.worlds_table import error_by_odds, error_of, table
from simulated.blind import nitrous
from simulated.blind import slots as s
from simulated.blind import stand as blind
from simulated.blind.effects import EFFECTS, Hidden, slots_of
from simulated.engines import maelstrom
from simulated.worlds import laws, reference
from simulated.worlds.engines import ENGINES, drawn, simulated
from simulated.worlds.engines import QUICK as ENGINES_OF_QUICK
from simulated.worlds.loggers import LOGGERS, filtered, written
from simulated.worlds.loggers import QUICK as LOGGERS_OF_QUICK
from simulated.worlds.loggers import drawn as drawn_sensors
from simulated.worlds.plan import KINDS, SETS, plan, worlds
from simulated.worlds.write import answer_path, write_test

from hfanalysis.record.definition import load_definition

RATE_OF_RUNS = 1000.0
SIZES = {laws.TAIL: 0.1, laws.MIXING: 0.3, laws.ZONE_LAG: 0.002, laws.OPENING: 0.03, laws.THRUST_LOSS: 0.01}


def with_law(which: int, size: float) -> laws.World:
    values = laws.plain().laws.copy()
    values[which] = size
    return replace(laws.plain(), laws=values)


@pytest.fixture(scope="module")
def stand() -> blind.Stand:
    return drawn(np.random.default_rng(3), "2 kN", "late", laws.plain())


def test_without_laws_the_engine_is_that_of_the_blind_generator(stand: blind.Stand) -> None:
    here, there = simulated(stand, laws.plain()), blind.simulate(stand)
    assert here.t_v == pytest.approx(there.t_v, abs=2e-3)
    assert here.t_fuel_out == pytest.approx(there.t_fuel_out, abs=2e-3)
    both = min(here.t_v, here.t_fuel_out) - 0.1
    rows = (here.time > 0.05) & (here.time < both)
    for channel in range(len(s.CHANNELS)):
        assert here.traces[rows, channel] == pytest.approx(there.traces[rows, channel], rel=2e-3, abs=1e-3)


@pytest.mark.parametrize("which", range(laws.LAWS - 4))
def test_every_law_shows(stand: blind.Stand, which: int) -> None:
    size = SIZES.get(which, 0.05)
    plain, other = (simulated(stand, world).traces[:, :6] for world in (laws.plain(), with_law(which, size)))
    assert np.abs(other - plain).max(axis=0).max() > 0.0
    spread = np.ptp(plain, axis=0)
    early = slice(100, int(1e3 * 0.6 * simulated(stand, laws.plain()).t_v))
    assert (np.abs(other - plain)[early] < 0.05 * spread).all()


def test_other_closures_of_what_is_hidden_are_none_at_strength_zero(stand: blind.Stand) -> None:
    everything = laws.plain()
    everything.laws[laws.DYER :] = 1.0
    assert (simulated(stand, everything).traces == simulated(stand, laws.plain()).traces).all()
    for name in ("injector_two_phase", "injector_choked_vapor", "grain_pressure_regression", "fuel_sliver"):
        effect = EFFECTS[name]
        shape = dict.fromkeys(effect.shape, 800000.0)
        hidden = slots_of((Hidden(effect, 0.3 * effect.most, shape),))
        one, other = (simulated(stand, world, hidden).traces for world in (laws.plain(), everything))
        assert np.abs(one - other).max() > 0.0


def test_a_chamber_without_a_flame_turns_cold_as_slowly_as_its_law_says() -> None:
    early = drawn(np.random.default_rng(5), "2 kN", "early", laws.plain())

    def left(mixing: float) -> float:
        run = simulated(early, with_law(laws.MIXING, mixing))
        gone = int(1e3 * run.t_fuel_out)
        return float(run.trace(s.P_CHAMBER)[gone + 150] / run.trace(s.P_CHAMBER)[gone - 10])

    # c* goes with the root of R T, which has come down by exp(-0.15 s / mixing) to that of cold nitrous oxide, a
    # twentieth; and the fuel's flow is gone, an eighth of all
    assert left(0.3) == pytest.approx((7.0 / 8.0) * np.sqrt(np.exp(-0.5) + 0.05 * (1.0 - np.exp(-0.5))), abs=0.08)
    assert left(0.03) < 0.4


def test_the_other_table_is_another_nitrous_oxide() -> None:
    esdu = replace(laws.plain(), properties="esdu").tank_table()
    off = esdu[nitrous.P] / nitrous.table()[nitrous.P] - 1.0
    assert 1e-4 < np.abs(off[np.arange(off.size) > 4000]).max() < 0.02


@pytest.mark.parametrize("logger", LOGGERS)
def test_logs_are_as_their_logger_writes_them(stand: blind.Stand, logger: str) -> None:
    rng, of = np.random.default_rng(1), LOGGERS[logger]
    run = simulated(stand, laws.plain())
    log = written(rng, stand, run, run.traces[:, :6], of, drawn_sensors(rng, of, stand))
    steps = np.diff(log.time)
    assert np.median(steps) == pytest.approx(1.0 / of.rate, rel=0.1)
    assert (steps > 0.0).all()
    assert log.t_open - log.time[0] == pytest.approx(of.rest, abs=1.1 / of.rate)
    if of.bits:
        assert np.unique(np.round(log.values[:, 0] / (1500.0 / 2**of.bits), 6) % 1.0).size == 1


def test_mains_that_a_slow_logger_folds_down_are_noise_and_no_error_of_a_sensor(stand: blind.Stand) -> None:
    of, run = LOGGERS["25 Hz, mains noise, 14 bit"], simulated(stand, laws.plain())
    channel = s.CHANNELS.index("p_purge")
    moved = []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        sensors = drawn_sensors(rng, of, stand)
        log = written(rng, stand, run, run.traces[:, :6], of, sensors)
        rest = log.values[log.time < log.t_open - 1.0, channel]
        moved.append(float(np.ptp(rest.reshape(-1, 25).mean(axis=1))) / sensors.white[channel])
    assert sorted(moved)[2] > of.hum


def test_a_third_of_the_plan_hides_nothing_and_all_stands_are_in_it() -> None:
    tests = plan()
    assert [sum(t.kind == kind for t in tests) for kind in KINDS] == [20, 28, 7, 5]
    assert {t.engine for t in tests} == set(ENGINES_OF_QUICK)
    assert {t.logger for t in tests} == set(LOGGERS_OF_QUICK)
    assert not {t.seed for t in tests} & {t.seed for t in plan("development", 200)}
    assert tests == plan()
    wide = plan("calibration", 120)
    assert {t.engine for t in wide} == set(ENGINES)
    assert {t.logger for t in wide} == set(LOGGERS)


def test_a_stand_that_lacks_a_sensor_has_no_such_channel(tmp_path: Path) -> None:
    (one,) = [t for t in plan("calibration", 120) if t.logger == "500 Hz, no thrust" and t.kind == "none"][:1]
    write_test(one, tmp_path)
    stated = load_definition(tmp_path / "raw_tests" / one.id / "test.toml")
    assert set(stated.channels) == {"p_tank", "p_run", "p_chamber", "p_purge", "m_tank"}
    assert not any("thrust" in exclusion.channels for exclusion in stated.exclude)
    assert "Thrust" not in (tmp_path / "raw_tests" / one.id / "log.csv").read_text(encoding="utf-8").splitlines()[0]


def test_a_filter_leaves_what_is_slow_and_takes_what_is_fast() -> None:
    time = np.arange(2000) / RATE_OF_RUNS
    slow, fast = (np.sin(2.0 * np.pi * f * time)[:, None] for f in (1.0, 300.0))
    assert np.abs(filtered(slow, 60.0) - slow)[200:].max() < 0.05
    assert np.abs(filtered(fast, 60.0))[200:].max() < 0.25
    assert filtered(fast, 0.0) is fast


def case(kind: str, hidden: tuple[str, ...], verdict: str, named: dict[str, float], unknown: float = 0.0) -> Scored:
    answer = {"id": "Q", "kind": kind, "engine": "1 kN", "logger": "a", "end": "left",
              "effects": {name: {"d_prime": 20.0} for name in hidden}}  # fmt: skip
    effects = [{"name": name, "probability": p} for name, p in named.items()]
    product: dict[str, Any] = {"verdict": verdict, "effects": effects, "posterior": {"unknown": unknown}}
    return Scored(answer, product, 10.0, "")


def test_what_is_stated_surely_beside_the_right_name_is_wrong_all_the_same() -> None:
    right = case("single", ("tank_heat",), "named", {"tank_heat": 0.99})
    more = case("single", ("tank_heat",), "named", {"tank_heat": 0.99, "n2_purge": 0.95})
    strange = case("single", ("tank_heat",), "unknown", {}, 0.99)
    outside = case("outside", ("vent_leak",), "unknown", {}, 0.99)
    alarm = case("none", (), "ambiguous", {"tank_heat": 0.6})
    assert [c.wrong for c in (right, more, strange, outside, alarm)] == [[], ["n2_purge"], ["unknown"], [], []]
    assert [c.exact for c in (right, more, strange, outside, alarm)] == [True, False, False, True, False]
    rows = figures([right, more, strange, outside, alarm])
    quiet = case("none", (), "none", {})
    quiet.product["compared"] = {"model_form_error": {"tank": 2e-4, "chamber": 1e-3}}
    quiet.product["warnings"] = ["the search did not converge: the base model came to lie 3.0 deeper"]
    assert figures([quiet])[-3:] == [
        "Model-form error where nothing is hidden, as parts of ranges, the median (the largest): "
        "tank 0.0002 (0.0002), chamber 0.001 (0.001).",
        "",
        "The search did not converge in Q.",
    ]
    assert rows[2] == "| all | 5 | 1 of 1 | 2 of 5 | 1 of 3 | 1 of 1 | 0 of 0 | 0 |"


def test_what_came_to_no_diagnosis_is_no_right_answer_and_is_said() -> None:
    first, second, third = plan()[:3]
    quiet, failed = (case("none", (), "none", {}) for _ in range(2))
    quiet.answer["id"] = first.id
    failed.answer["id"] = second.id
    failed = replace(failed, product={}, failure="raw/Q/test.toml: no tank\nexpected [tank]")
    assert not failed.exact
    assert refused([quiet], [first]) == []
    assert refused([quiet, failed], [first, second, third])[1:] == [
        "2 of 3 came to no diagnosis and are in no figure:",
        "",
        f"- {second.id}: expected [tank]",
        f"- {third.id}: not diagnosed by this version",
    ]


def test_a_test_that_breaks_stops_no_other_and_what_an_older_version_found_does_not_stand_for_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("a defect")

    monkeypatch.setattr("benchmarks.worlds.diagnosed", broken)
    (first,) = plan()[:1]
    kept = found_path(first, tmp_path)
    kept.parent.mkdir()
    kept.write_text(json.dumps({"digest": "older", "seconds": 1.0, "failure": "", "product": {}}), encoding="utf-8")
    (tmp_path / "answers").mkdir()
    (tmp_path / "answers" / f"{first.id}.json").write_text("{}", encoding="utf-8")
    assert run_one(first.id, Study(tmp_path, (first,), "now")) == "ZeroDivisionError: a defect"
    assert scored([first], tmp_path, "now") == []
    assert len(scored([first], tmp_path, "older")) == 1


def test_scored_worlds_are_one_draw_each_and_their_tests_are_their_own() -> None:
    tests = plan("scored", 10_000)
    assert len({t.id for t in tests}) == len({t.seed for t in tests}) == len(tests) < 500
    for place in worlds("scored"):
        own = [t for t in tests if t.world == place.name]
        assert {(t.engine, t.logger, t.laws) for t in own} == {(place.engine, place.logger, place.laws)}
        assert sum(t.kind == "none" for t in own) >= 25
        stretch = [t.kind for t in tests[: len(tests) // 2] if t.world == place.name]
        assert 0.4 < stretch.count("none") / sum(t.kind == "none" for t in own) < 0.6
    assert len({t.laws for t in tests}) == len(worlds("scored")) == 9
    others = {t.seed for which in SETS if which != "scored" for t in plan(which, 400)}
    assert not others & {t.seed for t in tests}


def test_all_tests_of_a_world_have_its_laws_and_an_answer_says_how_far_rivals_are(tmp_path: Path) -> None:
    first, second = [t for t in plan("scored", 10_000) if t.world == "A" and t.kind == "single"][:2]
    answers = []
    for test in (first, second):
        write_test(test, tmp_path)
        answers.append(json.loads(answer_path(test.id, tmp_path).read_text(encoding="utf-8")))
    assert answers[0]["laws"] == answers[1]["laws"]
    assert answers[0]["fade"] == answers[1]["fade"]
    for answer in answers:
        for effect in answer["effects"].values():
            assert 0.0 <= effect["to_rivals"] <= effect["d_prime"] + 1e-9


def test_burnt_gas_that_has_left_the_reference_solvers_chamber_leaves_the_cold() -> None:
    """What is left of it vanishes, and the solver may try less than nothing of it: its mixture stays what it was."""
    solver = Reference(maelstrom(), liquid=False, burning=False, burnt_of=6.0)
    end = np.array([1e-3, 0.0, 250.0, 0.03, -1e-12, 2e-13, 1e5, 0.0, 0.0, 0.0, 0.0, 2e-3, 300.0])
    volume = solver.engine.dead_volume + np.pi * end[3] ** 2 * solver.engine.grain_length
    pressure, gas = solver.held(end)
    assert pressure == pytest.approx(end[12] / volume, rel=1e-6)
    assert gas.temperature > 0.0


def test_a_log_of_the_reference_solver_is_read(tmp_path: Path) -> None:
    """It ends as the valve closes: nothing after it is left out."""
    first = next(t for t in plan("scored", 10_000) if t.of_reference)
    write_test(first, tmp_path)
    stated = load_definition(tmp_path / "raw_tests" / first.id / "test.toml")
    assert stated.exclude == ()
    assert set(stated.channels) >= {"p_tank", "p_chamber"}


def test_the_reference_solver_runs_a_stand_as_the_blind_generator_does_without_laws(stand: blind.Stand) -> None:
    solved, plain = reference.histories(stand), simulated(stand, laws.plain())
    assert solved.t_v == pytest.approx(plain.t_v, rel=0.02)
    rows = slice(300, int(900 * min(solved.t_v, plain.t_v)))
    for channel in (s.P_TANK, s.P_RUN, s.P_CHAMBER, s.THRUST, s.M_TANK):
        assert solved.traces[rows, channel] == pytest.approx(plain.traces[rows, channel], rel=0.04)
    assert np.abs(solved.traces[rows, s.P_CHAMBER] - plain.traces[rows, s.P_CHAMBER]).max() > 1e3


def test_the_table_counts_claims_by_world_and_what_could_be_asked_for() -> None:
    def case(kind: str, world: str, d_prime: float, rivals: float, product: dict[str, Any]) -> Scored:
        effect = {"d_prime": d_prime, "to_rivals": rivals, "equations": ["grain"], "inside_library": True}
        effects = {} if kind == "none" else {"fuel_sliver": effect}
        answer = {"id": "x", "kind": kind, "world": world, "engine": "e", "logger": "l", "end": "left"}
        return Scored({**answer, "effects": effects}, product, 5.0, "")

    def named(name: str, p: float) -> dict[str, Any]:
        posterior = {name: p, "none": 1.0 - p}
        return {"verdict": "named", "effects": [{"name": name, "probability": p}], "posterior": posterior}

    quiet = {"verdict": "none", "effects": [], "posterior": {"none": 0.8, "unknown": 0.2}}
    cases = [
        *[case("none", "A", 0.0, 0.0, quiet)] * 3, case("none", "B", 0.0, 0.0, named("tank_heat", 0.95)),
        case("single", "A", 20.0, 9.0, named("fuel_sliver", 0.97)), case("single", "B", 20.0, 9.0, quiet),
        case("single", "B", 20.0, 1.0, quiet),
    ]  # fmt: skip
    rows = {line.split("|")[1].strip(): line.split("|") for line in table(cases) if line.startswith("|")}
    assert rows["claim where nothing is hidden, all worlds"][2].strip() == "0.250"
    assert float(rows["the same in the worst world (its lower limit)"][2]) > 0.15
    exact = rows["exact set of names, d' >= 8 and >= 4 to every rival"]
    assert (exact[2].strip(), exact[4].strip()) == ("0.500", "2")
    assert "| 1 of 1 (" in next(line for line in table(cases) if line.startswith("| B "))
    without = [line for line in table(cases[4:]) if "where nothing is hidden" in line or "worst world" in line]
    assert [line.split("|")[2].strip() for line in without[:2]] == ["-", "-"]


def test_what_is_right_by_the_odds_before_a_test_is_no_error_where_most_tests_hide_nothing() -> None:
    """Of tests in which nothing is stated 0.25 of 0.25 + 0.6 hide nothing where kinds are as frequent as that."""

    def stated(kind: str, p: float) -> Scored:
        hidden = {} if kind == "none" else {"fuel_sliver": {"d_prime": 20.0, "inside_library": True}}
        product = {"verdict": "none", "effects": [], "posterior": {"none": p, "tank_heat": 0.0}}
        return Scored({"id": "x", "kind": kind, "effects": hidden}, product, 5.0, "")

    def mixed(p: float) -> list[Scored]:
        return [*[stated("none", p)] * 5, stated("single", p)] * 200

    right = 0.25 / 0.85
    assert error_of(mixed(right)).value == pytest.approx(5 / 6 - right, abs=0.01)
    assert error_by_odds(mixed(right)).value < 0.05
    assert error_by_odds(mixed(0.9)).value == pytest.approx(0.9 - right, abs=0.01)
    assert error_by_odds(mixed(right)[:1]).n == 0
