"""From files to channels: units, clocks, flags that come from outside, and the product on disk."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
from tests.products.cf import check
from tests.record import make

from hfanalysis.errors import AbsentError, InputError
from hfanalysis.record import spool
from hfanalysis.record.clocks import stale_stamps
from hfanalysis.record.definition import load_definition
from hfanalysis.record.ingest import ingest
from hfanalysis.record.log import Flag, read_log
from hfanalysis.units import Value

HF5 = Path(__file__).parents[2] / "raw_tests" / "HF5"
T = np.arange(0.0, 3.0, 0.01)
P = 50.0 + np.random.default_rng(2).normal(scale=0.1, size=len(T))
TANK = make.channel("p_tank", "bar")


def test_the_replica_is_read_as_it_stands(tmp_path: Path) -> None:
    ingest(load_definition(HF5 / "test.toml"), tmp_path / "ingest.h5")
    log = read_log(tmp_path / "ingest.h5")
    assert set(log.channels) == {"p_tank", "p_run", "p_chamber", "p_purge", "thrust", "m_tank"}
    assert log["p_tank"].values[0] == pytest.approx(947.8387 * 6894.757293, rel=1e-9)
    assert log["p_tank"].accuracy == pytest.approx(2 * 6894.757293)
    assert log["p_tank"].accuracy_stated
    assert log["p_chamber"].zero_std < 1500
    assert log.provenance["source"] == "replica"
    assert log.provenance["raw"] == {"log.csv": hashlib.sha256((HF5 / "log.csv").read_bytes()).hexdigest()}
    assert (log["p_tank"].flags > 0).sum() == 109


def test_the_product_is_the_same_to_the_byte(tmp_path: Path) -> None:
    for name in ("a.h5", "b.h5"):
        ingest(load_definition(HF5 / "test.toml"), tmp_path / name)
    assert (tmp_path / "a.h5").read_bytes() == (tmp_path / "b.h5").read_bytes()


def test_xarray_reads_the_product(tmp_path: Path) -> None:
    make.read(tmp_path, make.LOG + TANK, {"log.csv": make.csv(time=T, p_tank=P)})
    with xr.open_dataset(tmp_path / "ingest.h5") as data:
        assert data["p_tank"].dims == ("time",)
        assert data["p_tank"].attrs["units"] == "Pa"
        assert data["p_tank_flags"].dtype == np.uint8
        np.testing.assert_allclose(data["time"], T, atol=1e-9)
        assert json.loads(data.attrs["provenance"])["test"] == "T"


def test_nothing_but_the_product_is_left_where_it_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spool, "IN_MEMORY", 1000)
    (tmp_path / "out").mkdir()
    path = make.write(tmp_path, make.LOG + TANK, {"log.csv": make.csv(time=T, p_tank=P)})
    ingest(load_definition(path), tmp_path / "out" / "ingest.h5")
    assert [p.name for p in (tmp_path / "out").iterdir()] == ["ingest.h5"]
    np.testing.assert_allclose(read_log(tmp_path / "out" / "ingest.h5")["p_tank"].values, P * 1e5, rtol=1e-5)


def test_a_long_log_is_put_together_from_its_segments(tmp_path: Path) -> None:
    t, p = np.arange(200_000) / 1000, np.random.default_rng(1).normal(50, 1, 200_000)
    seen: list[float] = []
    path = make.write(tmp_path, make.LOG + TANK, {"log.csv": make.csv(time=t, p_tank=p)})
    ingest(load_definition(path), tmp_path / "ingest.h5", lambda _, share: seen.append(share))
    log = read_log(tmp_path / "ingest.h5")
    np.testing.assert_allclose(log["p_tank"].values, p * 1e5, rtol=1e-5)
    np.testing.assert_allclose(log["p_tank"].time, t, atol=1e-3)
    assert len(seen) > 2
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


def test_gauge_pressures_gain_the_ambient_pressure(tmp_path: Path) -> None:
    toml = make.LOG + make.channel("p_tank", "barg") + make.channel("p_run", "bar", "gauge = true")
    toml += make.channel("p_fill", "bar") + '[site]\nambient_pressure = "0.95 bar"\n'
    log = make.read(tmp_path, toml, {"log.csv": make.csv(time=T, p_tank=P, p_run=P + 1, p_fill=P + 2)})
    difference = log["p_tank"].values - (log["p_fill"].values - 2e5)
    np.testing.assert_allclose(difference, 0.95e5, rtol=1e-3)
    np.testing.assert_allclose(log["p_run"].values - log["p_tank"].values, 1e5, rtol=1e-3)


def test_scale_and_offset_come_before_the_unit(tmp_path: Path) -> None:
    toml = make.LOG + make.channel("T_tank", "degC", "scale = 2", "offset = -1")
    log = make.read(tmp_path, toml, {"log.csv": "time,T_tank\n0,10\n1,11\n2,12\n"})
    np.testing.assert_allclose(log["T_tank"].values, [292.15, 294.15, 296.15])


def test_the_same_test_in_other_units_is_the_same_test(tmp_path: Path) -> None:
    us = make.LOG + make.channel("p_tank", "psig") + make.channel("thrust", "lbf") + make.channel("T_tank", "degF")
    si = make.LOG + make.channel("p_tank", "bar") + make.channel("thrust", "N") + make.channel("T_tank", "K")
    kelvin, newton = 280 + 0.1 * P, 10 * P
    fahrenheit, lbf = kelvin * 9 / 5 - 459.67, newton / 4.4482216152605
    psig = (P * 1e5 - 101325) / 6894.757293168
    a = make.read(tmp_path / "us", us, {"log.csv": make.csv(time=T, p_tank=psig, thrust=lbf, T_tank=fahrenheit)})
    b = make.read(tmp_path / "si", si, {"log.csv": make.csv(time=T, p_tank=P, thrust=newton, T_tank=kelvin)})
    for name in ("p_tank", "thrust", "T_tank"):
        np.testing.assert_allclose(a[name].values, b[name].values, rtol=1e-5)
        assert a[name].unit == b[name].unit


def test_an_unstated_accuracy_is_the_class_default_and_marked(tmp_path: Path) -> None:
    log = make.read(tmp_path, make.LOG + TANK, {"log.csv": make.csv(time=T, p_tank=P)})
    assert not log["p_tank"].accuracy_stated
    assert log["p_tank"].accuracy == pytest.approx(0.005 * 50e5, rel=0.02)


def test_files_keep_their_own_clocks(tmp_path: Path) -> None:
    toml = '[log]\nfiles = ["a.csv", { file = "b.csv", time = { column = "ms", unit = "ms", offset = "2 s" } }]\n'
    toml += 'time = { column = "time", unit = "s" }\n' + TANK + make.channel("thrust", "N")
    log = make.read(
        tmp_path, toml, {"a.csv": make.csv(time=T, p_tank=P), "b.csv": make.csv(ms=1e3 * T[:9], thrust=P[:9])}
    )
    np.testing.assert_allclose(log["thrust"].time, T[:9] + 2.0)
    np.testing.assert_allclose(log["p_tank"].time, T)


def test_a_log_without_stamps_has_a_rate(tmp_path: Path) -> None:
    toml = '[log]\nfiles = ["log.csv"]\ntime = { rate = "2 kHz" }\n' + TANK
    log = make.read(tmp_path, toml, {"log.csv": make.csv(p_tank=P, thrust=P)})
    np.testing.assert_allclose(log["p_tank"].time[:3], [0, 0.0005, 0.001])


@pytest.mark.parametrize(
    ("stamps", "stale"),
    [
        ([0, 1, 2, 3], []),
        ([0, 1, 1, 1, 2], [2, 3]),
        ([0, 1, 2, 1.5, 3, 4], [2]),
        ([0, 1, 99, 2, 3, 4], [2]),
        ([5, 6, 7, 8, 0, 1, 2], [4, 5, 6]),
        ([5, 6, 0, 1, 2, 3], [0, 1]),
    ],
)
def test_as_few_samples_as_can_be_are_flagged_for_time(stamps: list[float], stale: list[int]) -> None:
    found = np.flatnonzero(stale_stamps(np.array(stamps, dtype=float))).tolist()
    kept = np.delete(np.array(stamps), found)
    assert len(found) == len(stale)
    assert (np.diff(kept) > 0).all()
    if stamps != [0, 1, 2, 1.5, 3, 4]:  # there either side will do
        assert found == stale


def test_samples_out_of_time_are_flagged_and_kept(tmp_path: Path) -> None:
    time = T.copy()
    time[100], time[200] = time[99], 1000.0
    log = make.read(tmp_path, make.LOG + TANK, {"log.csv": make.csv(time=time, p_tank=P)})
    assert np.flatnonzero(log["p_tank"].flags & Flag.TIME).tolist() == [100, 200]
    assert len(log["p_tank"].values) == len(T)
    assert any("2 samples flagged time" in warning for warning in log.warnings)


def test_truncated_stamps_are_spread_where_the_engineer_asks(tmp_path: Path) -> None:
    time = np.floor(T)
    toml = '[log]\nfiles = ["log.csv"]\ntime = { column = "time", spread = true }\n' + TANK
    log = make.read(tmp_path, toml, {"log.csv": make.csv(time=time, p_tank=P)})
    np.testing.assert_allclose(log["p_tank"].time, T, atol=1e-9)
    plain = make.read(tmp_path, make.LOG + TANK, {"log.csv": make.csv(time=time, p_tank=P)})
    assert plain["p_tank"].good.sum() == 3
    assert any("spread = true" in warning for warning in plain.warnings)


def test_rows_without_a_stamp_are_left_out_and_counted(tmp_path: Path) -> None:
    log = make.read(tmp_path, make.LOG + TANK, {"log.csv": "time,p_tank\n0,50\n,51\nnoon,52\n1,53\n2,54\n"})
    np.testing.assert_allclose(log["p_tank"].values, [50e5, 53e5, 54e5])
    assert any("2 rows without a readable time stamp" in warning for warning in log.warnings)


def test_excluded_stretches_are_flagged(tmp_path: Path) -> None:
    toml = make.LOG + TANK + make.channel("p_run", "bar")
    toml += '[[exclude]]\nchannels = ["p_tank"]\nstart = "1 s"\nend = "1.05 s"\n'
    log = make.read(tmp_path, toml, {"log.csv": make.csv(time=T, p_tank=P, p_run=P + 1)})
    assert (log["p_tank"].flags == Flag.EXCLUDED).sum() == 6
    assert not log["p_run"].flags.any()
    assert np.isfinite(log["p_tank"].values).all()


def test_a_row_of_zeros_is_a_dropout_of_all_channels(tmp_path: Path) -> None:
    near_zero = np.random.default_rng(4).normal(scale=0.3, size=len(T))
    near_zero[50] = 0.0
    tank = P.copy()
    tank[50] = 0.0
    toml = make.LOG + TANK + make.channel("thrust", "N")
    log = make.read(tmp_path, toml, {"log.csv": make.csv(time=T, p_tank=tank, thrust=near_zero)})
    assert np.flatnonzero(log["thrust"].flags).tolist() == [50]


def test_a_missing_channel_is_named(tmp_path: Path) -> None:
    log = make.read(tmp_path, make.LOG + TANK, {"log.csv": make.csv(time=T, p_tank=P)})
    assert log.get("thrust") is None
    with pytest.raises(AbsentError, match="'thrust'"):
        log["thrust"]


def test_a_file_that_is_no_product_is_refused(tmp_path: Path) -> None:
    (tmp_path / "x.h5").write_text("no")
    with pytest.raises(InputError, match=r"x\.h5"):
        read_log(tmp_path / "x.h5")


def test_times_are_not_in_the_file(tmp_path: Path) -> None:
    make.read(tmp_path, make.LOG + TANK, {"log.csv": make.csv(time=T, p_tank=P)})
    check(tmp_path / "ingest.h5")
    with h5py.File(tmp_path / "ingest.h5") as file:
        assert "created" not in " ".join([*file.attrs, *file["p_tank"].attrs]).lower()


def test_ambient_pressure_is_stated_or_from_the_altitude_or_of_sea_level(tmp_path: Path) -> None:
    log = {"log.csv": make.csv(time=T, p_tank=P)}
    for site, low, high in (("", 101324, 101326), ('[site]\naltitude = "1402 m"\n', 85000, 86500)):
        found = load_definition(make.write(tmp_path, make.LOG + TANK + site, log)).ambient_pressure
        assert low < found.value < high
        assert found.std
    stated = make.write(tmp_path, make.LOG + TANK + '[site]\nambient_pressure = "0.9 +/- 0.01 bar"\n', log)
    assert load_definition(stated).ambient_pressure == Value(0.9e5, 0.01e5)


def test_what_hits_all_channels_of_a_file_is_told_once(tmp_path: Path) -> None:
    mass, other = np.linspace(8.0, 7.0, len(T)), P + 1.0
    rows = make.csv(time=T, p_tank=P, m_tank=mass, p_run=other).splitlines()
    for i in (50, 51, 52):
        rows[1 + i] = f"{T[i]:.6g},,,"
    rows[1 + 200] = f"{T[200]:.6g},{P[200]:.6g},,"
    rows[1 + 250] = f"{T[250]:.6g},{P[250]:.6g},,"
    toml = make.LOG + TANK + make.channel("m_tank", "kg") + make.channel("p_run", "bar")
    log = make.read(tmp_path, toml, {"log.csv": "\n".join(rows)})
    assert [warning for warning in log.warnings if "dropout" in warning] == [
        "channel p_tank: 3 of 300 samples flagged dropout",
        "channels m_tank, p_run: the same 5 of 300 samples flagged dropout",
    ]
    rows[1 + 200] = rows[1 + 250] = f"{T[200]:.6g},{P[200]:.6g},7.5,50.0"
    log = make.read(tmp_path / "b", toml, {"log.csv": "\n".join(rows)})
    assert [warning for warning in log.warnings if "dropout" in warning] == [
        "log.csv: 3 of 300 samples of all 3 channels flagged dropout"
    ]
