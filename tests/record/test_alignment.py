"""Files with clocks of their own come onto one: by dates, or by what their channels show together."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.record import make

from hfanalysis.arrays import Array
from hfanalysis.errors import InputError
from hfanalysis.record.alignment import find_offset

RNG = np.random.default_rng(4)
FAST, SLOW = np.arange(0.0, 30.0, 0.01), np.arange(0.0, 25.0, 0.05)


def burn(time: Array, opening: float, level: float, noise: float) -> Array:
    """A channel that rises at the opening, sags, and falls eight seconds later."""
    on = np.clip((time - opening) / 0.15, 0.0, 1.0) * np.clip((opening + 8.0 - time) / 0.6 + 1.0, 0.0, 1.0)
    return level * on * (1.0 - 0.03 * (time - opening)) + RNG.normal(scale=noise, size=time.size)


def files(late: float, noise: float = 0.3) -> dict[str, str]:
    """Two files of one firing, whose opening is at 10 s by the first's clock and ``late`` earlier by the second's."""
    return {
        "a.csv": make.csv(t=FAST, p_run=burn(FAST, 10.0, 40.0, noise), p_chamber=burn(FAST, 10.0, 25.0, noise)),
        "b.csv": make.csv(t=SLOW, thrust=burn(SLOW, 10.0 - late, 2000.0, 60.0 * noise)),
    }


def toml(offset: str) -> str:
    one = '{ file = "a.csv", time = "t" }'
    two = f'{{ file = "b.csv", time = {{ column = "t", offset = "{offset}" }} }}'
    channels = (make.channel("p_run", "bar"), make.channel("p_chamber", "bar"), make.channel("thrust", "N"))
    return f"[log]\nfiles = [{one}, {two}]\n" + "".join(channels)


@pytest.mark.parametrize("late", [3.7, -4.2])
def test_an_offset_is_found_by_what_the_channels_show(tmp_path: Path, late: float) -> None:
    log = make.read(tmp_path, toml("auto"), files(late))
    assert log["thrust"].time[0] == pytest.approx(late, abs=0.15)
    said = next(warning for warning in log.warnings if "its clock is set so" in warning)
    assert "b.csv" in said
    assert "+/-" in said


def test_a_clock_that_the_channels_contradict_is_told_of(tmp_path: Path) -> None:
    off, on = (make.read(tmp_path / f"{late}", toml("0 s"), files(late)) for late in (3.7, 0.0))
    assert any("not where its stamps put it" in one for one in off.warnings)
    assert not any("its stamps" in one for one in on.warnings)


def test_an_offset_that_the_channels_do_not_show_is_not_guessed(tmp_path: Path) -> None:
    noise = files(0.0) | {"b.csv": make.csv(t=SLOW, thrust=RNG.normal(size=SLOW.size))}
    with pytest.raises(InputError, match=r"offset = 'auto' of b.csv.*expected offset"):
        make.read(tmp_path, toml("auto"), noise)


def test_two_openings_of_one_valve_tie() -> None:
    twice = burn(FAST, 5.0, 40.0, 0.1) + burn(FAST, 18.0, 40.0, 0.1)
    found = find_offset([(FAST, twice)], [(SLOW, burn(SLOW, 5.0, 40.0, 0.1))])
    assert found is not None
    assert not found.told


@pytest.mark.parametrize("days", [0, 1])
def test_dates_bring_files_together(tmp_path: Path, days: int) -> None:
    texts = {
        "a.csv": "t,p_run\n2024-05-01 23:59:58,1\n2024-05-01 23:59:59,2\n2024-05-02 00:00:03,3\n",
        "b.csv": f"t,thrust\n2024-05-0{1 + days} 00:00:01,5\n2024-05-0{1 + days} 00:00:02,6\n",
    }
    toml = '[log]\nfiles = ["a.csv", "b.csv"]\ntime = { column = "t", unit = "datetime" }\n'
    log = make.read(tmp_path, toml + make.channel("p_run", "bar") + make.channel("thrust", "N"), texts)
    np.testing.assert_allclose(log["p_run"].time, [86398.0, 86399.0, 86403.0])
    np.testing.assert_allclose(log["thrust"].time, 86400.0 * days + np.array([1.0, 2.0]))
