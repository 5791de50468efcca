"""The page of a test: complete in itself, honest about what is missing, safe whatever the texts say."""

from __future__ import annotations

import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from sample import CALIBRATION, SEGMENTS, channel, material, quantity

from hfanalysis.report.material import phase_list
from hfanalysis.report.page import page, render, sentence, warnings
from hfanalysis.report.svg import Event, events, new_plot, value_range
from hfanalysis.report.wording import quantities
from hfanalysis.testdata.log import TestLog

HOSTILE = "<script>alert(1)</script>\"'><img src=x onerror=alert(2)>&{{ 7*7 }}"
VOID = {"meta", "link", "br", "img", "hr", "input"}


class Reader(HTMLParser):
    """Collects tags and attributes, and checks that what is opened is closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attrs for name, attrs in self.tags if name == tag]


@pytest.fixture
def text(tmp_path: Path) -> str:
    return page(material(tmp_path))


def test_every_element_is_closed(text: str) -> None:
    assert Reader(text).open == []


def test_nothing_is_loaded_from_elsewhere(text: str) -> None:
    reader = Reader(text)
    assert not {"script", "img", "iframe", "object", "embed", "base"} & {tag for tag, _ in reader.tags}
    assert not re.search(r"url\(|@import|(?:src|href)=\"(?!#)", text)
    assert "http://" not in text
    assert "https://" not in text


def test_the_page_stays_small(text: str) -> None:
    assert len(text.encode()) < 2_000_000


def test_the_page_is_the_same_from_run_to_run(tmp_path: Path, text: str) -> None:
    assert page(material(tmp_path)) == text


def test_hostile_texts_are_shown_not_obeyed(tmp_path: Path) -> None:
    made = material(tmp_path, label=HOSTILE, description=f"'''{HOSTILE}'''")
    hostile = {**SEGMENTS, "warnings": [HOSTILE], "notes": [HOSTILE], "provenance": {"raw": {HOSTILE: HOSTILE}}}
    calibration = {**CALIBRATION, HOSTILE: quantity(1.0, HOSTILE, 0.1, why=HOSTILE, verdict=HOSTILE)}
    calibration |= {"rest": {HOSTILE: HOSTILE}, "provenance": {"raw": {HOSTILE: HOSTILE}}}
    text = page(replace(made, segments=hostile, calibration=calibration, absent={"validate": HOSTILE}))
    reader = Reader(text)
    assert reader.open == []
    assert not {"script", "img"} & {tag for tag, _ in reader.tags}
    assert not any(name.startswith("on") for _, attrs in reader.tags for name in attrs)
    assert "&lt;script&gt;" in text
    assert "49" not in re.findall(r"&amp;(.{0,20})", text)[0]


def test_every_chart_has_a_text_alternative(text: str) -> None:
    reader = Reader(text)
    charts = reader.all("svg")
    ids = [attrs["id"] for _, attrs in reader.tags if "id" in attrs]
    assert len(charts) == 6
    assert len(ids) == len(set(ids))
    for chart in charts:
        assert chart["role"] == "img"
        assert set((chart["aria-labelledby"] or "").split()) <= set(ids)


def test_what_scrolls_can_be_reached_by_keyboard_and_has_a_name(text: str) -> None:
    regions = [attrs for attrs in Reader(text).all("div") if attrs.get("class") == "scroll"]
    assert regions
    assert all(attrs["tabindex"] == "0" and attrs["role"] == "region" and attrs["aria-label"] for attrs in regions)


def test_a_replica_is_called_a_replica(tmp_path: Path, text: str) -> None:
    assert "REPLICA: generated, not measured" in text
    assert "REPLICA" not in page(material(tmp_path, source="measured"))


def test_the_verdict_names_what_is_known_and_what_is_not(tmp_path: Path) -> None:
    said = sentence(material(tmp_path), quantities(CALIBRATION))
    assert said.startswith("Identified: injector coefficient, feed loss coefficient and liquid-phase feed loss.")
    assert "Outside its physical range: polytropic exponent." in said
    assert "Not identifiable from this test: vapour compressibility." in said


def test_reasons_and_values_are_on_the_page(text: str) -> None:
    for words in ("needs 14 kW of heat", "the vapour phase lasts 0.05 s", "11.43", "set by the engineer", "ab" * 32):
        assert words in text


def test_what_bears_on_the_results_is_warned_of_first(tmp_path: Path) -> None:
    assert warnings(material(tmp_path))[0] == "the purge check valve opens before the liquid is gone"


def test_a_log_without_a_firing_gets_a_page_that_says_so(tmp_path: Path) -> None:
    made = material(tmp_path)
    text = page(replace(made, segments=None, calibration=None, residuals=None, absent={"segment": "nothing opens"}))
    assert "No firing was found in this log" in text
    assert "nothing opens" in text
    assert "log time [s]" in text


def test_nitrogen_may_come_before_the_liquid_is_gone(tmp_path: Path) -> None:
    early = {**SEGMENTS, "t_purge": quantity(3.0, "s", 0.01)}
    found = [(phase.name, phase.start, phase.end) for phase in phase_list(replace(material(tmp_path), segments=early))]
    assert found == [
        ("line filling", 0.0, 0.87),
        ("liquid", 0.87, 3.0),
        ("liquid + N₂", 3.0, 5.271),
        ("vapour + N₂", 5.271, 17.0),
    ]


def test_dead_channels_leave_no_chart_and_no_crash(tmp_path: Path) -> None:
    dead = channel("p_tank", "Pa", lambda t: np.full(t.size, np.nan))
    text = page(replace(material(tmp_path), log=TestLog({"p_tank": dead}), residuals=None, calibration=None))
    assert "There is nothing to draw" in text


def _luminance(colour: str) -> float:
    parts = [int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def _contrast(a: str, b: str) -> float:
    low, high = sorted((_luminance(a), _luminance(b)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("scheme", [0, 1], ids=["light", "dark"])
def test_colours_reach_wcag_aa(text: str, scheme: int) -> None:
    blocks = re.findall(r":root \{(.*?)\}", text, re.DOTALL)
    colours = dict(re.findall(r"--([\w]+(?:-tint)?): (#[0-9a-f]{6});", blocks[scheme]))
    for ground in ("paper", "raised"):
        for ink in ("ink", "soft", "accent", "good", "open", "bad"):
            assert _contrast(colours[ink], colours[ground]) >= 4.5, (ink, ground)
        for line in ("p_tank", "p_run", "p_chamber", "p_purge", "thrust", "m_tank", "model", "raw"):
            assert _contrast(colours[line], colours[ground]) >= 3.0, (line, ground)
    for verdict in ("good", "open", "bad"):
        assert _contrast(colours[verdict], colours[f"{verdict}-tint"]) >= 4.5, verdict


def test_the_index_lists_every_test() -> None:
    rows = [
        {
            "id": HOSTILE,
            "kind": "hot fire",
            "date": "",
            "source": "replica",
            "sentence": HOSTILE,
            "href": "a%3C/report.html",
        }
    ]
    text = render("index.html.j2", rows=rows)
    assert Reader(text).open == []
    assert "<script>" not in text


def test_a_few_wild_readings_do_not_flatten_a_chart_but_are_told(tmp_path: Path) -> None:
    made = material(tmp_path)
    mass = made.log.channels["m_tank"]
    wild = mass.values.copy()
    wild[2000:2010] = 540.0
    log = TestLog({"m_tank": replace(mass, values=wild)})
    text = page(replace(made, log=log))
    assert "A few readings lie outside the chart, as far as 540 kg." in text
    low, high = value_range([wild])
    assert low == 0.0
    assert 8.0 < high < 20.0


def test_names_of_events_never_overlap() -> None:
    plot = new_plot((-2.0, 20.0), (0.0, 1.0))
    events(plot, [Event(0.0, 0.0, "t_open"), Event(0.2, 0.0, "t_feed"), Event(0.4, 0.0, "t_v")])
    heights = re.findall(r'class="event-name" x="[\d.]+" y="([\d.]+)"', "".join(plot.parts))
    assert len(set(heights)) == 3
