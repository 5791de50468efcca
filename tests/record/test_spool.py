"""Columns on their way: in memory or on disk, in one piece or in many, they are what was in the log."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import pytest
from tests.record import make

from hfanalysis.record import spool
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers import delimited, open_log

T = np.arange(0.0, 60.0, 0.01)
TOML = make.LOG + make.channel("p_tank", "bar") + make.channel("T_tank", "K")


@pytest.mark.parametrize("end", ["", "\n", "\n\n   \n"])
def test_a_log_in_many_pieces_is_the_log_in_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, end: str) -> None:
    text = make.csv(time=T, p_tank=50.0 + np.sin(T), T_tank=290.0 + np.cos(T)).rstrip("\n") + end
    whole = make.read(tmp_path / "whole", TOML, {"log.csv": text})
    monkeypatch.setattr(delimited, "SEGMENT", 1000)
    for memory in (1 << 30, 30_000):
        monkeypatch.setattr(spool, "IN_MEMORY", memory)
        pieces = make.read(tmp_path / str(memory), TOML, {"log.csv": text})
        for name in ("p_tank", "T_tank"):
            np.testing.assert_array_equal(pieces[name].values, whole[name].values)
            np.testing.assert_array_equal(pieces[name].time, whole[name].time)
        assert pieces.provenance["raw"] == {"log.csv": hashlib.sha256(text.encode()).hexdigest()}
    assert len(whole["p_tank"].values) == len(T)


def test_a_column_taken_may_be_changed_and_is_gone(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(make.csv(time=T, p_tank=T))
    columns = spool.Spool(open_log(tmp_path / "log.csv", FileSpec(file="log.csv")), tmp_path)
    columns.fill([1], [0], lambda share: None)
    taken = columns.take(1)
    taken += 1.0
    np.testing.assert_allclose(taken, T + 1.0)
    assert columns.rows(1) == 0
    np.testing.assert_allclose(columns.look(0), T)
