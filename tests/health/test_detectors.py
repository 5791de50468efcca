"""What is wrong with a channel is found, named, and told from when to when; a healthy firing is not blamed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.health import fire
from tests.health.fire import Columns

from hfanalysis.health.judge import judge
from hfanalysis.health.performance import BALANCE
from hfanalysis.health.ties.scale import _mass
from hfanalysis.products.health import Finding
from hfanalysis.record.sections import Tank
from hfanalysis.thermo.combustion import equilibrium
from hfanalysis.units import Value

AMBIENT = 1.01325
TANK = '[tank]\nvolume = "16 L"\noxidizer_mass = "8 kg"\n'
THROAT = '[nozzle]\nthroat_radius = "15.5 mm"\n'
"""F / (p_c A_t) of the made-up firing is then 1.33 at 20 bar."""


def found(root: Path, columns: Columns, text: str = "") -> list[Finding]:
    """Every finding of the firing, each once."""
    health = judge(*fire.ingested(root, columns, text))
    return list({id(f): f for c in health.channels.values() for f in c.findings}.values())


def changed(name: str, by: Callable[[np.ndarray, np.ndarray], np.ndarray], **more: np.ndarray) -> Columns:
    """The firing with another channel."""
    columns = fire.columns() | more
    return columns | {name: by(columns["time"], columns[name])}


def after(start: float, by: Callable[[np.ndarray], np.ndarray]) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Something that happens from an instant on."""
    return lambda time, value: np.where(time < start, value, by(value))


def between(start: float, end: float, level: float | np.ndarray) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """A level for a while."""
    return lambda time, value: np.where((time < start) | (time > end), value, level)


RNG = np.random.default_rng(51)
WILD = RNG.normal(0.0, 900.0, 2000)
HISS = np.random.default_rng(52).normal(size=2000)


def slow(time: np.ndarray, value: np.ndarray) -> np.ndarray:
    """A filter of first order, 0.5 s."""
    out = value.copy()
    for i in range(1, len(out)):
        out[i] = out[i - 1] + 0.02 * (value[i] - out[i - 1])
    return out


CASES = {
    "constant": ("dead", "p_tank", lambda t, v: np.full(v.size, 142.4)),
    "no thrust": ("dead", "thrust", lambda t, v: 12.0 + 8.0 * np.sin(997.0 * t)),
    "no chamber pressure": ("dead", "p_chamber", lambda t, v: 1.0 + 0.08 * np.sin(997.0 * t)),
    "line lost for a second": ("dead", "p_run", lambda t, v: np.where(abs(t - 3) < 0.5, 1 + 0.1 * np.sin(997 * t), v)),
    "clipped": ("railed", "p_chamber", lambda t, v: np.minimum(v, 12.0)),
    "clipped, with spikes": ("railed", "thrust", lambda t, v: np.minimum(v, np.where(np.arange(v.size) % 211, 900, v))),
    "cut at its top before the firing": ("railed", "p_tank", lambda t, v: np.minimum(v, v[t < 0.0].min() - 0.3)),
    "a converter of six bits": ("coarse", "p_tank", lambda t, v: 4.0 * np.round(v / 4.0)),
    "held up": ("railed", "p_tank", lambda t, v: np.maximum(v, 44.0)),
    "cell dies": ("noise", "thrust", lambda t, v: np.where(t < 2.0, v, WILD)),
    "code": ("dropout", "p_chamber", between(2.0, 3.0, -10.0)),
    "below vacuum": ("dropout", "p_tank", between(2.0, 3.0, -2.9)),
    "first reading": ("edge", "thrust", lambda t, v: np.where(t == t[0], 8388607.0, v)),
    "last readings": ("edge", "p_run", lambda t, v: np.where(t > t[-3], 4095.0, v)),
    "zero shifted": ("zero", "thrust", after(1.0, lambda v: v + 90.0)),
    "zero drifts": ("drift", "thrust", lambda t, v: v + 12.0 * t),
    "zero shifted down": ("zero", "thrust", after(1.0, lambda v: v - 60.0)),
    "gauge shifted below ambient": ("zero", "p_chamber", after(1.0, lambda v: v - 0.3)),
    "gauge drifts far": ("drift", "p_chamber", lambda t, v: v + 0.8 * (t - t[0])),
    "wired the other way": ("sign", "thrust", lambda t, v: -v),
    "gauge the other way": ("sign", "p_chamber", lambda t, v: 2.0 - v),
    "code with noise within its range": ("dropout", "p_chamber", between(2.0, 3.0, 9.99 + 1e-3 * HISS)),
    "code far above": ("dropout", "thrust", between(2.0, 3.0, 9999.0 + HISS)),
    "flat in a curve": ("dropout", "thrust", between(2.0, 3.0, -999.0 + 5.0 * HISS)),
    "chamber below its line late": ("lag", "p_chamber", slow),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_a_channel_is_blamed_for_what_is_wrong_with_it(case: str, tmp_path: Path) -> None:
    kind, name, by = CASES[case]
    told = found(tmp_path, changed(name, by))
    assert (kind, (name,)) in [(f.kind, f.channels) for f in told]
    assert {n for f in told for n in f.channels if f.verdict == "unusable"} <= {name}


def test_a_chamber_is_dead_that_shows_nothing_of_a_tank_emptied_into_a_fire(tmp_path: Path) -> None:
    columns = changed("p_chamber", lambda t, v: 1.0 + 0.08 * np.sin(997.0 * t))
    columns["p_tank"] = np.where(columns["time"] > 8.0, 20.0, columns["p_tank"])
    del columns["thrust"]
    text = "\n".join(table for table in fire.toml().split("\n\n") if "thrust" not in table)
    assert ("dead", ("p_chamber",)) in [(f.kind, f.channels) for f in found(tmp_path, columns, text)]


def test_a_slow_logs_channel_that_dies_is_told(tmp_path: Path) -> None:
    columns = changed("thrust", lambda t, v: np.where(t < 2.0, v, WILD))
    told = found(tmp_path, {name: values[::10] for name, values in columns.items()})
    assert ("noise", ("thrust",)) in [(f.kind, f.channels) for f in told]


def test_a_burst_between_two_jumps_is_no_drop_out(tmp_path: Path) -> None:
    """At 10 Hz a short firing is far above all else, and begins and ends at once."""
    columns = changed("thrust", lambda t, v: np.where((t > 0.0) & (t < 2.0), v, 12.0 + 8.0 * np.sin(997.0 * t)))
    told = found(tmp_path, {name: values[::10] for name, values in columns.items()})
    assert "dropout" not in {f.kind for f in told}


def test_a_cell_that_has_not_settled_is_told_as_the_chamber_comes_to_ambient(tmp_path: Path) -> None:
    columns = changed(
        "thrust", lambda t, v: v + np.where(t > 1.0, 200.0 * np.exp(-np.maximum(t - 8.0, 0.0) / 6.0), 0.0)
    )
    (told,) = found(tmp_path, {name: values[columns["time"] < 11.0] for name, values in columns.items()})
    assert (told.kind, told.channels, told.cure) == ("zero", ("thrust",), None)


def with_a_tail() -> Columns:
    """A firing whose chamber and thrust fade after 8 s, within seconds, and whose cell is quiet at rest."""
    columns = fire.columns()
    tail = np.where(columns["time"] > 8.0, np.exp(-np.clip(columns["time"] - 8.0, 0.0, None) / 2.0), 0.0)
    columns["p_chamber"] += 6.0 * tail
    pushed = columns["thrust"] + 500.0 * tail
    rests = (columns["time"] < -0.02) | (columns["time"] > 12.0)
    return columns | {"thrust": np.where(rests, 12.0, np.round(pushed, 2))}


def test_a_cell_that_stands_at_its_rest_while_the_chamber_still_pushes_is_at_its_lower_end(tmp_path: Path) -> None:
    columns = with_a_tail()
    cut = columns | {"thrust": np.maximum(columns["thrust"], 330.0)}
    told = [f for f in found(tmp_path, cut) if f.kind == "railed"]
    assert [(f.channels, f.verdict) for f in told] == [(("thrust",), "unusable")] * 2
    assert told[0].span[1] < 0.02
    assert 8.0 < told[1].span[0] < 9.5


def test_a_cell_half_of_whose_noise_at_rest_is_missing_is_at_its_lower_end(tmp_path: Path) -> None:
    columns = changed("thrust", lambda t, v: np.maximum(v, 14.0))
    told = [f for f in found(tmp_path, columns) if f.kind == "railed"]
    assert [(f.channels, f.verdict) for f in told] == [(("thrust",), "unusable")] * 2
    assert told[0].span[1] < 0.02
    assert told[1].span[0] > 7.9


def test_a_cell_that_is_quiet_at_rest_is_at_no_end(tmp_path: Path) -> None:
    assert "railed" not in {f.kind for f in found(tmp_path, with_a_tail())}


@pytest.mark.parametrize("seed", range(3))
def test_a_healthy_firing_is_blamed_for_nothing(seed: int, tmp_path: Path) -> None:
    assert found(tmp_path, fire.columns(seed), fire.toml() + THROAT) == []


def test_what_happens_for_a_while_is_dated_and_its_cure_leaves_just_that_out(tmp_path: Path) -> None:
    (dropout,) = found(tmp_path, changed("p_chamber", between(2.0, 3.0, -10.0)))
    assert dropout.span == pytest.approx((2.0, 3.0), abs=0.03)
    assert dropout.cure is not None
    assert dropout.cure.splitlines()[:2] == ["[[exclude]]", 'channels = ["p_chamber"]']


def test_a_zero_shift_below_what_heat_does_is_none(tmp_path: Path) -> None:
    assert found(tmp_path, changed("thrust", after(1.0, lambda v: v + 10.0))) == []


@pytest.mark.parametrize(("missing", "channels"), [(("p_chamber",), {"p_chamber"}), (fire.CHANNELS, {"p_tank"})])
def test_gauges_are_told_by_the_air(missing: tuple[str, ...], channels: set[str], tmp_path: Path) -> None:
    columns = fire.columns()
    columns |= {n: columns[n] - AMBIENT for n in missing if n.startswith("p_")}
    text = fire.toml().replace('zero = "ambient"\n', "")
    told = [f for f in found(tmp_path, columns, text) if f.kind == "gauge_or_absolute"]
    assert channels <= {n for f in told for n in f.channels}
    assert {f.cure for f in told} == {"gauge = true"}


def test_a_chamber_gauge_that_reads_a_third_is_told_by_the_thrust(tmp_path: Path) -> None:
    columns = changed("p_chamber", lambda t, v: 1.0 + (v - 1.0) / 3.0)
    (told,) = found(tmp_path, columns, fire.toml() + THROAT)
    assert told.kind == "scale"
    assert "p_chamber" in told.channels
    assert told.gain is not None
    assert 0.8 < told.gain < 3.5


@pytest.mark.parametrize(("factor", "told"), [(0.9, False), (1.1, False), (0.65, True), (1.5, True)])
def test_a_thrust_is_doubted_beyond_what_losses_and_the_throat_explain(
    factor: float, told: bool, tmp_path: Path
) -> None:
    """A nozzle whose exit is stated gives 1.33 within a twentieth at 20 bar; its throat is known to 6 %."""
    columns = changed("thrust", lambda t, v: factor * v)
    kinds = {f.kind for f in found(tmp_path, columns, fire.toml() + THROAT + 'exit_radius = "24 mm"\n')}
    assert kinds == ({"scale"} if told else set())


@pytest.mark.parametrize(("factor", "told"), [(1.0, False), (0.5, True)])
def test_a_throat_that_is_not_stated_is_that_of_the_propellant(factor: float, told: bool, tmp_path: Path) -> None:
    """p_c A_t over 8 s is 8.35 kg at c* of 1500 m/s; then thrust and p_c A_t may disagree."""
    columns = changed("thrust", lambda t, v: factor * v)
    text = fire.toml() + '[tank]\nvolume = "16 L"\noxidizer_mass = "6 kg"\n[grain]\nmass = "0.75 kg"\n'
    assert [f.channels for f in found(tmp_path, columns, text)] == [("thrust", "p_chamber")] * told


def test_the_balance_of_propellant_and_pressure_holds_what_fires_have() -> None:
    """Nine tenths of equilibrium to all of it, fuel-rich to lean at the pressures of small stands."""
    gases = [equilibrium(p, ratio) for p in (6e5, 30e5) for ratio in (3.0, 5.0, 7.0, 9.0)]
    velocities = [share * gas.characteristic_velocity for gas in gases for share in (0.9, 1.0)]
    low, high = min(velocities), max(velocities)
    assert np.sqrt(BALANCE[0] * BALANCE[1]) == pytest.approx(np.sqrt(low * high), rel=0.1)
    assert BALANCE[1] - BALANCE[0] == pytest.approx(high - low, rel=0.35)


def test_a_thrust_in_another_unit_is_told_with_the_unit(tmp_path: Path) -> None:
    columns = changed("thrust", lambda t, v: v / 1000.0)
    text = fire.toml().replace('accuracy = "7 N"', 'accuracy = "0.007 N"') + THROAT + TANK
    told = [f for f in found(tmp_path, columns, text) if f.kind == "unit"]
    assert [(f.channels, f.cure) for f in told] == [(("thrust",), 'unit = "kN"')]


def test_a_tank_in_another_unit_is_told_by_what_tanks_hold(tmp_path: Path) -> None:
    columns = changed("p_tank", lambda t, v: v * 14.5038)
    told = [f for f in found(tmp_path, columns) if f.kind == "unit"]
    assert [(f.channels, f.cure) for f in told] == [(("p_tank",), 'unit = "psi"')]


@pytest.mark.parametrize(("first", "second"), [("p_tank", "p_run"), ("p_tank", "p_chamber"), ("p_run", "p_chamber")])
def test_swapped_columns_are_told_as_a_pair(first: str, second: str, tmp_path: Path) -> None:
    columns = fire.columns()
    told = found(tmp_path, columns | {first: columns[second], second: columns[first]})
    assert ("swapped", (first, second)) in [(f.kind, f.channels) for f in told]


def weighed(dry: float, part: float) -> tuple[Columns, str]:
    """The firing with a tank's cell that bears ``dry`` [kg] beside ``part`` of 8 kg."""
    columns = fire.columns()
    gone = np.clip(columns["time"] / 8.0, 0.0, 1.0)
    columns["p_tank"] = np.where(columns["time"] > 8.0, 20.0, columns["p_tank"])
    columns["m_tank"] = dry + part * 8.0 * (1.0 - 0.96 * gone) + RNG.normal(0.0, 0.02, gone.size)
    return columns, fire.toml() + '[channels.m_tank]\ncolumn = "m_tank"\nunit = "kg"\naccuracy = "0.03 kg"\n' + TANK


@pytest.mark.parametrize(("dry", "part", "cure"), [(6.0, 1.0, "offset = -6"), (0.0, 0.1, None)])
def test_a_cell_that_weighs_something_else_is_told(dry: float, part: float, cure: str | None, tmp_path: Path) -> None:
    told = [f for f in found(tmp_path, *weighed(dry, part)) if f.kind == "gross_mass"]
    assert [f.channels for f in told] == [("m_tank",)]
    assert (told[0].cure or "").split(".")[0] == (cure or "")


def test_a_cell_that_weighs_the_oxidizer_is_not_blamed(tmp_path: Path) -> None:
    assert [f for f in found(tmp_path, *weighed(0.0, 1.0)) if "m_tank" in f.channels] == []


def test_a_log_that_ends_before_the_stated_burn_doubts_the_clock(tmp_path: Path) -> None:
    columns = fire.columns()
    columns["time"] = 0.4 * columns["time"]
    told = found(tmp_path, columns, fire.toml() + '[observed]\nburn_time = "8 s"\n')
    assert [(f.kind, f.channels) for f in told] == [("clock", tuple(fire.CHANNELS))]


@pytest.mark.parametrize("way", ["code", "jumps", "later"])
def test_a_thermocouple_that_is_open_is_told(way: str, tmp_path: Path) -> None:
    columns = fire.columns()
    good = 20.0 + RNG.normal(0.0, 0.3, columns["time"].size)
    jumps = RNG.normal(100.0, 60.0, good.size)
    bad = {"code": np.full(good.size, 999.0), "jumps": jumps, "later": np.where(columns["time"] < 3.0, good, jumps)}
    text = fire.toml() + '[channels.T_tank]\ncolumn = "T_tank"\nunit = "degC"\n'
    told = [f for f in found(tmp_path, columns | {"T_tank": bad[way]}, text) if "T_tank" in f.channels]
    assert {f.kind for f in told} == {"open"}
    assert told[0].whole == (way != "later")
    assert found(tmp_path / "good", columns | {"T_tank": good}, text) == []


@pytest.mark.parametrize(("std", "known"), [(0.01, True), (1.0, False)])
def test_a_load_that_may_be_nothing_ties_no_channel_to_it(std: float, known: bool) -> None:
    stated: Any = SimpleNamespace(tank=Tank(oxidizer_mass=Value(1.0, std)), grain=None)
    found = _mass(SimpleNamespace(definition=stated))  # type: ignore[arg-type]
    assert (found is not None and found[0] > 0.0) == known
