"""What is wrong with a channel is found, named, and told from when to when; a healthy firing is not blamed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.health import fire
from tests.health.fire import Columns

from hfanalysis.health.judge import judge
from hfanalysis.products.health import Finding

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


def between(start: float, end: float, level: float) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """A level for a while."""
    return lambda time, value: np.where((time < start) | (time > end), value, level)


RNG = np.random.default_rng(51)
WILD = RNG.normal(0.0, 900.0, 2000)


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
    "held up": ("railed", "p_tank", lambda t, v: np.maximum(v, 44.0)),
    "cell dies": ("noise", "thrust", lambda t, v: np.where(t < 2.0, v, WILD)),
    "code": ("dropout", "p_chamber", between(2.0, 3.0, -10.0)),
    "below vacuum": ("dropout", "p_tank", between(2.0, 3.0, -2.9)),
    "first reading": ("edge", "thrust", lambda t, v: np.where(t == t[0], 8388607.0, v)),
    "last readings": ("edge", "p_run", lambda t, v: np.where(t > t[-3], 4095.0, v)),
    "zero shifted": ("zero", "thrust", after(1.0, lambda v: v + 90.0)),
    "zero drifts": ("drift", "thrust", lambda t, v: v + 12.0 * t),
    "wired the other way": ("sign", "thrust", lambda t, v: -v),
    "chamber below its line late": ("lag", "p_chamber", slow),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_a_channel_is_blamed_for_what_is_wrong_with_it(case: str, tmp_path: Path) -> None:
    kind, name, by = CASES[case]
    told = found(tmp_path, changed(name, by))
    assert (kind, (name,)) in [(f.kind, f.channels) for f in told]
    assert {n for f in told for n in f.channels if f.verdict == "unusable"} <= {name}


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
