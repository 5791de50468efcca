"""The table of the equation of state is made once and kept; whatever happens to it, the answer is the same."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hfanalysis.arrays import Array
from hfanalysis.thermo import cache, coolprop_nitrous
from hfanalysis.thermo.cache import cache_directory
from hfanalysis.thermo.saturation import Property


class Source:
    """Stands in for CoolProp: properties that are straight lines in theta, and a count of how often it is asked."""

    def __init__(self) -> None:
        self.asked = 0

    def __call__(self, theta: Array) -> Array:
        self.asked += 1
        return np.array([(1.0 + row) + theta for row in range(len(Property))])


@pytest.fixture
def source(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Source:
    source = Source()
    monkeypatch.setattr(coolprop_nitrous, "sample", source)
    monkeypatch.setenv("HFA_CACHE", str(tmp_path / "cache"))
    return source


def kept(tmp_path: Path) -> Path:
    """The one file that is kept."""
    (path,) = (tmp_path / "cache").iterdir()
    return path


def expected_pressure() -> float:
    """What the stand-in gives at 250 K."""
    return float(np.exp(1.0 + (1.0 - 250.0 / coolprop_nitrous.CRITICAL_TEMPERATURE) ** (1.0 / 3.0)))


def test_the_equation_of_state_is_asked_once(source: Source, tmp_path: Path) -> None:
    first = coolprop_nitrous.build()
    second = coolprop_nitrous.build()
    assert source.asked == 1
    np.testing.assert_array_equal(first.coefficients, second.coefficients)
    assert kept(tmp_path).suffix == ".npy"


@pytest.mark.parametrize(
    "spoil",
    [
        pytest.param(lambda raw: b"", id="empty"),
        pytest.param(lambda raw: raw[:7], id="cut within the header"),
        pytest.param(lambda raw: raw[: len(raw) // 2], id="cut within the numbers"),
        pytest.param(lambda raw: b"not a table\n" * 1000, id="something else"),
        pytest.param(lambda raw: raw[:-40] + np.array([1.0]).tobytes() + raw[-32:], id="another number in it"),
        pytest.param(lambda raw: raw[:-32], id="without its checksum"),
    ],
)
def test_a_spoilt_table_is_made_anew(source: Source, tmp_path: Path, spoil: object) -> None:
    coolprop_nitrous.build()
    path = kept(tmp_path)
    good = path.read_bytes()
    path.write_bytes(spoil(good))  # type: ignore[operator]
    assert coolprop_nitrous.build().pressure(250.0) == pytest.approx(expected_pressure(), rel=1e-12)
    assert source.asked == 2
    assert path.read_bytes() == good
    assert kept(tmp_path) == path  # nothing half made is left beside it


def test_a_table_of_other_code_is_made_anew(source: Source, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    coolprop_nitrous.build()
    monkeypatch.setattr(cache, "source_digest", lambda path: "of other code")
    coolprop_nitrous.build()
    assert source.asked == 2
    assert len(list((tmp_path / "cache").iterdir())) == 2


def test_a_table_of_another_layout_is_made_anew(source: Source, tmp_path: Path) -> None:
    coolprop_nitrous.build()
    np.save(kept(tmp_path), np.zeros((2, 3)))
    assert coolprop_nitrous.build().pressure(250.0) == pytest.approx(expected_pressure(), rel=1e-12)
    assert source.asked == 2


def test_where_nothing_can_be_kept_the_table_is_made_each_time(
    source: Source, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("HFA_CACHE", str(tmp_path / "file" / "cache"))
    for times in (1, 2):
        assert coolprop_nitrous.build().pressure(250.0) == pytest.approx(expected_pressure(), rel=1e-12)
        assert source.asked == times


def test_a_full_disk_leaves_nothing_half_written(
    source: Source, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def write(path: Path, content: bytes) -> None:
        path.write_text("half")
        raise OSError("no space left on device")

    monkeypatch.setattr(Path, "write_bytes", write)
    assert coolprop_nitrous.build().pressure(250.0) == pytest.approx(expected_pressure(), rel=1e-12)
    assert list((tmp_path / "cache").iterdir()) == []


def test_the_tables_are_kept_in_the_users_cache_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("HFA_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_directory() == tmp_path / "hfanalysis"
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache_directory() == tmp_path / ".cache" / "hfanalysis"
    monkeypatch.setenv("HOME", "~")  # what the system leaves of it where there is none
    assert cache_directory().is_absolute()
