"""Dates and times of day become seconds, whatever they are written in, chunk after chunk."""

from __future__ import annotations

import datetime
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from tests.record import make

from hfanalysis.arrays import Array
from hfanalysis.errors import InputError
from hfanalysis.record.quiet import Trace, in_blocks
from hfanalysis.record.readers.stamps import StampParser

STEP = 0.25
BEGIN = datetime.datetime(2022, 5, 11, 23, 59, 50)
MOMENTS = [BEGIN + datetime.timedelta(seconds=STEP * i) for i in range(90)]
T = STEP * np.arange(len(MOMENTS))


def with_fraction(form: str, mark: str = ".") -> Callable[[datetime.datetime], str]:
    return lambda moment: moment.strftime(form) + f"{mark}{moment.microsecond // 1000:03d}"


DATES = {
    "iso": lambda m: m.isoformat(),
    "iso blank": lambda m: str(m),
    "iso comma": with_fraction("%Y-%m-%d %H:%M:%S", ","),
    "slash colon": with_fraction("%Y/%m/%d %H:%M:%S", ":"),
    "compact": with_fraction("%Y%m%dT%H%M%S"),
    "utc": lambda m: with_fraction("%Y-%m-%dT%H:%M:%S")(m) + "Z",
    "zone": lambda m: with_fraction("%Y-%m-%dT%H:%M:%S")(m) + "+00:00",
    "german": with_fraction("%d.%m.%Y %H:%M:%S", ","),
    "day first": with_fraction("%d/%m/%Y %H:%M:%S"),
    "month first": with_fraction("%m/%d/%Y %H:%M:%S"),
    "dashes": with_fraction("%d-%m-%Y %H:%M:%S"),
    "matlab": with_fraction("%d-%b-%Y %H:%M:%S"),
    "excel": lambda m: with_fraction("%m/%d/%y %I:%M:%S")(m) + m.strftime(" %p"),
    "named": with_fraction("%B %d, %Y %H:%M:%S"),
}
CLOCKS = {
    "clock": with_fraction("%H:%M:%S"),
    "comma": with_fraction("%H:%M:%S", ","),
    "colon": with_fraction("%H:%M:%S", ":"),
    "halves": lambda m: with_fraction("%I:%M:%S")(m) + m.strftime(" %p"),
    "halves close": lambda m: with_fraction("%I:%M:%S")(m) + m.strftime("%p").lower(),
    "four digits": lambda m: m.strftime("%H:%M:%S") + f".{m.microsecond // 1000 + m.second % 7:04d}",
    "unpadded": lambda m: m.strftime("%H:%M:%S") + f".{m.microsecond // 1000 + m.second % 9}",
    "minutes": with_fraction("%M:%S"),
}


def parsed(stamps: list[str], cut: int) -> tuple[Array, StampParser]:
    """Seconds of stamps that come in two chunks, and the parser."""
    parser = StampParser()
    parts = [parser.seconds(pa.array(part, pa.string())) for part in (stamps[:cut], stamps[cut:]) if part]
    return np.concatenate(parts), parser


@pytest.mark.parametrize("cut", [90, 30, 60])
@pytest.mark.parametrize("form", DATES)
def test_dates(form: str, cut: int) -> None:
    found, parser = parsed([DATES[form](moment) for moment in MOMENTS], cut)
    np.testing.assert_allclose(found, 86390.0 + T, atol=1e-6)
    assert parser.epoch == (datetime.date(2022, 5, 11) - datetime.date(1970, 1, 1)).days * 86400.0


@pytest.mark.parametrize("cut", [90, 45])
@pytest.mark.parametrize("form", CLOCKS)
def test_times_of_day_go_on_over_midnight(form: str, cut: int) -> None:
    found, _ = parsed([CLOCKS[form](moment) for moment in MOMENTS], cut)
    np.testing.assert_allclose(np.diff(found), STEP, atol=0.010)
    np.testing.assert_allclose(found - found[0], T, atol=0.020)


@pytest.mark.parametrize("month", [1, 5, 11])
def test_whether_the_day_comes_first_is_told_by_the_step_at_midnight(month: int) -> None:
    for order in ("%d/%m/%Y", "%m/%d/%Y"):
        days = [datetime.datetime(2022, month, day, 12) for day in (3, 4)]
        found, _ = parsed([day.strftime(f"{order} %H:%M:%S") for day in days], 1)
        np.testing.assert_allclose(found, [43200.0, 129600.0])


def test_what_is_no_stamp_is_no_number() -> None:
    stamps = ["2022-05-11 10:00:00", "2022-02-31 10:00:01", "", "rubbish", "2022-05-11 10:00:04"]
    found, _ = parsed(stamps, 5)
    np.testing.assert_array_equal(np.isfinite(found), [True, False, False, False, True])


@pytest.mark.parametrize(("first", "last"), [(50, 50), (17, 3), (50, 1)])
def test_whole_seconds_that_a_steady_logger_shares_are_spread(tmp_path: Path, first: int, last: int) -> None:
    counts = [first, 50, 51, 49, 50, 50, last]
    seconds = np.repeat(np.arange(len(counts)), counts)
    rng = np.random.default_rng(2)
    text = "time,p_tank\n" + "".join(
        f"10:00:{s:02d},{p:.3f}\n" for s, p in zip(seconds, rng.normal(50, 1, seconds.size), strict=True)
    )
    log = make.read(tmp_path, make.LOG + make.channel("p_tank", "bar"), {"log.csv": text})
    np.testing.assert_allclose(np.diff(log["p_tank"].time), 0.02, atol=0.001)
    assert any("spread evenly, since as many share each" in one for one in log.warnings)


def test_stamps_of_a_logger_that_pauses_are_not_spread(tmp_path: Path) -> None:
    seconds = np.repeat(np.arange(7), [50, 50, 20, 90, 50, 7, 50])
    text = "time,p_tank\n" + "".join(f"{s},{50 + i % 7}\n" for i, s in enumerate(seconds))
    log = make.read(tmp_path, make.LOG + make.channel("p_tank", "bar"), {"log.csv": text})
    np.testing.assert_array_equal(log["p_tank"].time, seconds)


@pytest.mark.parametrize("stamps", [np.zeros(50), np.linspace(-1e307, 0.0, 50), np.linspace(0.0, 1e-60, 50)])
def test_stamps_of_no_clock_are_refused(stamps: Array, tmp_path: Path) -> None:
    log = make.csv(time=stamps, p_tank=np.full(50, 1.0))
    with pytest.raises(InputError, match="is their column a clock"):
        make.read(tmp_path, make.LOG + make.channel("p_tank", "bar"), {"log.csv": log})


def test_blocks_of_samples_closer_than_numbers_can_tell_are_one() -> None:
    blocks = in_blocks(Trace(np.linspace(0.0, 1e-60, 50), np.ones(50)), 0.1)
    assert blocks.time.shape == (1,)
