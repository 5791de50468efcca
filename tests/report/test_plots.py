"""Every chart as files: all samples in the CSV, a picture in the PNG; and two tests beside each other."""

from __future__ import annotations

import csv as reader
import io
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests.report.sample import CALIBRATION, material, quantity, saying

from hfanalysis.charts.chart import Chart, Series
from hfanalysis.errors import InputError
from hfanalysis.record.schema import changed
from hfanalysis.report import pdf
from hfanalysis.report.compare import both_charts, compare
from hfanalysis.report.payload import LEAST_SAMPLES, MOST_SAMPLES, detail
from hfanalysis.report.plots import csv, write_plots
from hfanalysis.report.sections import charts


def chart(*series: Series) -> Chart:
    """A chart of nothing in particular."""
    return Chart("some", "Some", "pressure", "Pa", series, (0.0, 10.0))


def table(text: str) -> list[list[str]]:
    """The rows of a CSV file."""
    return list(reader.reader(io.StringIO(text)))


def test_the_file_holds_every_sample_in_si(tmp_path: Path) -> None:
    made = material(tmp_path)
    (thrust,) = (found for found in charts(made) if found.key == "thrust")
    rows = table(csv(thrust))
    assert rows[0] == ["time after the valve opens [s]", "as logged [N]", "corrected [N]"]
    assert len(rows) - 1 == np.count_nonzero(made.log["thrust"].good & (made.log["thrust"].time >= 98.0))
    assert float(rows[1][1]) - float(rows[1][2]) == pytest.approx(40.0, abs=1e-3)


def test_lines_on_different_clocks_share_a_file() -> None:
    quick = Series("quick", "p_tank", np.array([0.0, 1.0, 2.0]), np.array([5.0, 6.0, 7.0]))
    slow = Series("slow", "p_run", np.array([0.5, 2.0]), np.array([1.0, 2.0]))
    assert table(csv(chart(quick, slow)))[1:] == [
        ["0.000000", "5", ""],
        ["0.500000", "", "1"],
        ["1.000000", "6", ""],
        ["2.000000", "7", "2"],
    ]


@pytest.mark.parametrize("name", ["=1+1", "+cmd", "@x"])
def test_a_spreadsheet_takes_names_for_text(name: str) -> None:
    line = Series(name, "p_tank", np.array([0.0]), np.array([5.0]))
    assert table(csv(chart(line)))[0][1] == f"'{name} [Pa]"


def test_every_chart_becomes_a_picture_and_a_table(tmp_path: Path) -> None:
    wanted = list(charts(material(tmp_path)))[:4]
    made = write_plots(wanted, tmp_path / "plots", "HF0 $a_b$ (REPLICA)")
    assert {path.name for path in made} == {f"{one.key}.{kind}" for one in wanted for kind in ("csv", "png")}
    for path in made:
        if path.suffix == ".png":
            picture = Image.open(path).convert("L")
            assert picture.width > 1000
            assert sum(picture.histogram()[:120]) > 500


def test_pictures_are_the_same_from_run_to_run(tmp_path: Path) -> None:
    one = next(iter(charts(material(tmp_path))))
    first, second = (write_plots([one], tmp_path / name, "HF0")[1].read_bytes() for name in ("a", "b"))
    assert first == second


def test_two_tests_are_laid_over_each_other_line_by_line(tmp_path: Path) -> None:
    made = material(tmp_path)
    found = {one.title: one for one in both_charts(made, made)}
    assert {"Pressures: tank", "Pressures: chamber", "Thrust", "Mixture ratio"} <= set(found)
    assert [(line.style, line.dashed) for line in found["Thrust"].series] == [("one", False), ("two", True)]


def test_differences_have_their_standard_deviation(tmp_path: Path) -> None:
    one = material(tmp_path)
    changed = {**CALIBRATION, "p_loss_liquid": quantity(13.43e5, "Pa", 0.16e5, verdict="identified")}
    other = saying(one, calibration=changed)
    row = re.search(r"liquid-phase feed loss.*?</tr>", compare(one, other))
    assert row is not None
    assert "+2.00 ± 0.20 bar" in row[0]
    assert "+29.0 ± 2.9 psi" in row[0]
    assert "<strong>10.0</strong>" in row[0]


def test_a_page_of_two_tests_leads_to_both_and_back_to_all(tmp_path: Path) -> None:
    one = material(tmp_path)
    other = replace(one, definition=changed(one.definition, test=changed(one.definition.test, id="cold 2")))
    text = compare(one, other)
    hrefs = re.findall(r'<a href="([^"#]+)">([^<]+)</a>', text)
    assert hrefs[:3] == [("report.html", "HF0"), ("../cold%202/report.html", "cold 2"), ("../index.html", "All tests")]


def test_a_missing_browser_is_told_plainly(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match="no browser to print with; expected one of chromium"):
        pdf.print_page(tmp_path / "report.html", tmp_path / "report.pdf")


def test_a_browser_that_cannot_print_is_told_with_its_words(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    fake = tmp_path / "chromium"
    fake.write_text("#!/bin/sh\necho 'cannot open display' >&2\n")
    fake.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    monkeypatch.setattr(pdf, "BROWSERS", ("chromium",))
    with pytest.raises(InputError, match=r"printed nothing \(cannot open display\)"):
        pdf.print_page(tmp_path / "report.html", tmp_path / "report.pdf")
    assert not list(tmp_path.glob("*.pdf"))


def test_many_lines_share_what_a_page_may_weigh() -> None:
    line = Series("a", "p_tank", np.zeros(30_000), np.zeros(30_000))
    one, many = chart(line), chart(*[line] * 10)
    assert detail([one]) == MOST_SAMPLES
    assert detail([many] * 10) < 0.3 * MOST_SAMPLES
    assert detail([many] * 10) < detail([many] * 5 + [replace(many, weight=0.1)] * 5)
    assert detail([many] * 500) == LEAST_SAMPLES


def test_lines_with_few_samples_leave_their_share_to_the_others() -> None:
    short = Series("a", "p_tank", np.zeros(100), np.zeros(100))
    long = Series("a", "p_tank", np.zeros(30_000), np.zeros(30_000))
    assert detail([chart(long), *[chart(short)] * 200]) == MOST_SAMPLES
