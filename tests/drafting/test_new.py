"""A new test on disk: a draft that loads whatever the log is called and holds, and a picture of every column."""

from __future__ import annotations

import csv
import io
import re
import shutil
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from hfanalysis.drafting.new import new_test
from hfanalysis.errors import InputError
from hfanalysis.record.definition import Statements, load_definition

LOG = Path(__file__).parents[2] / "raw_tests" / "HF5" / "log.csv"


def short_log(folder: Path, header: str, name: str = "log.csv", rows: int = 60) -> Path:
    """A log with this header and a firing in every column but the first, which is time."""
    columns = next(csv.reader([header]))
    log = folder / name
    log.parent.mkdir(parents=True, exist_ok=True)
    lines = [
        ",".join([f"{0.01 * i:.2f}", *(f"{((i * k) % 20) + k}" for k in range(1, len(columns)))]) for i in range(rows)
    ]
    log.write_text("\n".join([header, *lines]) + "\n", encoding="utf-8")
    return log


def test_a_draft_is_a_valid_definition(tmp_path: Path) -> None:
    definition = load_definition(new_test(tmp_path, "HF9", [LOG]).path)
    assert set(definition.channels) == {"p_tank", "p_run", "p_chamber", "p_purge", "thrust", "m_tank"}
    assert definition.channels["p_tank"].unit == "psia"
    assert definition.log.time is not None
    assert definition.log.time.column == "Time (s)"


def test_the_log_is_copied_beside_it_unchanged(tmp_path: Path) -> None:
    new_test(tmp_path, "HF9", [LOG])
    assert (tmp_path / "raw_tests/HF9/log.csv").read_bytes() == LOG.read_bytes()


def test_a_log_already_in_its_place_stays_there(tmp_path: Path) -> None:
    folder = tmp_path / "raw_tests" / "HF9"
    folder.mkdir(parents=True)
    shutil.copy(LOG, folder)
    before = (folder / "log.csv").stat()
    new_test(tmp_path, "HF9", [folder / "log.csv"])
    assert (folder / "log.csv").stat().st_mtime_ns == before.st_mtime_ns


def test_nothing_is_ever_overwritten(tmp_path: Path) -> None:
    log = short_log(tmp_path, "time (s),thrust (N)")
    path = new_test(tmp_path, "HF9", [log]).path
    path.write_text("mine")
    with pytest.raises(InputError, match="never overwritten"):
        new_test(tmp_path, "HF9", [log])
    assert path.read_text() == "mine"
    (tmp_path / "raw_tests/HF8").mkdir()
    (tmp_path / "raw_tests/HF8/log.csv").write_text("another log")
    with pytest.raises(InputError, match="never overwritten"):
        new_test(tmp_path, "HF8", [log])


@pytest.mark.parametrize("name", ["../x", "a/b", "", ".", "..", "a b", "-x"])
def test_a_name_must_be_a_folder_name(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="cannot name a test"):
        new_test(tmp_path, name, [LOG])
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("name", "found"), [("empty.csv", "empty"), ("words.csv", "no data|column of numbers")])
def test_what_is_no_log_is_refused_before_anything_is_written(tmp_path: Path, name: str, found: str) -> None:
    (tmp_path / name).write_text("" if name == "empty.csv" else "a,b\nno,numbers\nat,all\n")
    with pytest.raises(InputError, match=found):
        new_test(tmp_path, "HF9", [tmp_path / name])
    assert not (tmp_path / "raw_tests").exists()


def test_a_folder_is_no_log(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is a folder"):
        new_test(tmp_path / "root", "HF9", [tmp_path])


def test_every_one_of_several_logs_is_in_the_draft(tmp_path: Path) -> None:
    """Each with its own clock; a channel says from which file it is."""
    logs = [
        short_log(tmp_path, "time (ms),thrust (N)", "force.csv"),
        short_log(tmp_path, "t (s),chamber (psi)", "p.csv"),
    ]
    made = new_test(tmp_path, "T", logs)
    definition = load_definition(made.path)
    assert [(spec.file, spec.time.unit) for spec in definition.log.files if spec.time] == [
        ("force.csv", "ms"),
        ("p.csv", "s"),
    ]
    assert {name: channel.file for name, channel in definition.channels.items()} == {
        "thrust": "force.csv", "p_chamber": "p.csv",
    }  # fmt: skip


def test_two_logs_of_one_name_are_refused(tmp_path: Path) -> None:
    logs = [short_log(tmp_path / folder, "time (s),thrust (N)") for folder in ("a", "b")]
    with pytest.raises(InputError, match="expected every name once"):
        new_test(tmp_path, "T", logs)


def test_a_log_that_says_nothing_is_drafted_and_loads(tmp_path: Path) -> None:
    """With one column under its own name, for a test has channels, and the guesses as comments."""
    made = new_test(tmp_path, "T", [short_log(tmp_path, "seconds,a1,PT-TANK")])
    assert not set(load_definition(made.path).channels) & {"p_tank"}
    assert "# [channels.p_tank]" in made.path.read_text(encoding="utf-8")


def test_every_section_of_test_toml_is_in_the_draft_and_those_that_are_marked_load_too(tmp_path: Path) -> None:
    path = new_test(tmp_path, "T", [short_log(tmp_path, "time (s),p_tank (psi)", rows=100)]).path
    text = path.read_text(encoding="utf-8")
    sections = set(Statements.__dataclass_fields__) - {"schema"}
    assert {name for name in sections if re.search(rf"^(# )?\[+{name}[\].]", text, re.MULTILINE)} == sections
    marked = text.partition("# What the engine is.")[2]
    opened = re.sub(r"^# (\[|\w+ = )", r"\1", marked, flags=re.MULTILINE)
    path.write_text(text.partition("# What the engine is.")[0] + "# " + opened, encoding="utf-8")
    stated = load_definition(path)
    assert all(getattr(stated, name) for name in sections)


@pytest.mark.parametrize(
    ("test_id", "kind"),
    [("HF3", "hot_fire"), ("AJ-CF1", "cold_flow"), ("coldflow-2019", "cold_flow"), ("water2", "water_flow")],
)
def test_the_name_says_which_kind_of_test_it_is(test_id: str, kind: str, tmp_path: Path) -> None:
    log = short_log(tmp_path, "time (s),p_tank (psi)")
    assert load_definition(new_test(tmp_path, test_id, [log]).path).test.kind == kind


def test_every_column_is_drawn(tmp_path: Path) -> None:
    made = new_test(tmp_path, "T", [short_log(tmp_path, 'time,a & <b>,"c ""d""",state of things')])
    drawing = ElementTree.parse(made.picture).getroot()
    names = [title.text for title in drawing.iter("{http://www.w3.org/2000/svg}title")]
    assert names == ["a & <b>", 'c "d"', "state of things"]
    assert sum("line" in (path.get("class") or "") for path in drawing.iter("{http://www.w3.org/2000/svg}path")) >= 3


NAMES = st.text(st.characters(codec="utf-8"), max_size=12)
PIECES = st.lists(
    st.sampled_from(["P", "T", "PT", "RUN", "TANK", "N2O", "CC", "thrust", "(psi)", "[bar]", "{", ")", '"', "\\", "é",
                     " ", "_", "°C", "(lbs)", "time", "\x7f", "[channels.x]", "=", "'", "\u2028", "psia", "(V)", "#"]),
    max_size=5,
).map("".join)  # fmt: skip


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@example(labels=["time", "time", "time", ""])
@example(labels=["", "", ""])
@example(labels=["p_tank (psia)", "p_tank (psia)", "p_tank  (psia)"])
@example(labels=['"""', "a\nb", "thrust (furlongs)", "m [kg"])
@given(labels=st.lists(st.one_of(NAMES, PIECES), min_size=2, max_size=8))
def test_a_draft_always_loads_whatever_the_columns_are_called(
    labels: list[str], tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("names")
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(labels)
    generator = np.random.default_rng(1)
    rows = np.cumsum(generator.uniform(0.01, 1.0, (40, len(labels))), axis=0) * np.where(
        np.arange(len(labels)) % 2, -1, 1
    )
    np.savetxt(text, rows, delimiter=",", fmt="%.4f")
    (folder / "log.csv").write_text(text.getvalue(), encoding="utf-8", newline="")
    try:
        made = new_test(folder, "T", [folder / "log.csv"])
    except InputError:
        return  # a header that the reader itself refuses
    assert load_definition(made.path).channels
    ElementTree.parse(made.picture)
