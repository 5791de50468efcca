"""The page of a test: complete in itself, honest about what is missing, safe whatever the texts say."""

from __future__ import annotations

import base64
import hashlib
import itertools
import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from tests.report.sample import (
    CALIBRATION,
    FLIGHT,
    HEALTH,
    SEGMENTS,
    VALIDATION,
    channel,
    material,
    quantity,
    saying,
    without,
)  # fmt: skip

from hfanalysis.charts.colors import COLORS, STYLES
from hfanalysis.charts.style import sheet
from hfanalysis.charts.svg import Event, events, new_plot, value_range
from hfanalysis.products.calibration import Calibration
from hfanalysis.quantity import CONDITIONAL, DERIVED, STATED, Quantity
from hfanalysis.record.log import TestLog
from hfanalysis.record.summary import summary
from hfanalysis.report.index import write_index
from hfanalysis.report.material import Material, phase_list
from hfanalysis.report.page import page, render
from hfanalysis.report.sections import lay_out, provenance, sections
from hfanalysis.report.sections.findings import sentence, warnings

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
    assert not {"img", "iframe", "object", "embed", "base", "link"} & {tag for tag, _ in reader.tags}
    assert not re.search(r"url\(|@import|(?:src|href)=\"(?!#)", text)
    assert set(re.findall(r"https?://[^\"']*", text)) == {"http://www.w3.org/2000/svg"}


def test_only_the_pages_own_script_may_run(text: str) -> None:
    scripts = Reader(text).all("script")
    assert [attrs.get("type") for attrs in scripts].count(None) == 1
    policy = next(attrs["content"] or "" for attrs in Reader(text).all("meta") if "http-equiv" in attrs)
    own = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    digest = base64.b64encode(hashlib.sha256(own[0].encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in policy
    assert policy.startswith("default-src 'none'")


def test_the_page_stays_small_whatever_the_logger_wrote(tmp_path: Path) -> None:
    made = material(tmp_path)
    clock = np.arange(95.0, 125.0, 1e-4)
    busy = replace(
        channel("p_tank", "Pa", lambda t: t), time=clock, values=np.sin(clock), flags=np.zeros(clock.size, np.uint8)
    )
    thermometers = {f"T_{n}": replace(busy, name=f"T_{n}", unit="K") for n in range(24)}
    text = page(replace(made, log=TestLog({**made.log.channels, "p_tank": busy, **thermometers})))
    assert len(text.encode()) < 5_000_000


def test_the_page_is_the_same_from_run_to_run(tmp_path: Path, text: str) -> None:
    assert page(material(tmp_path)) == text


def hostile(folder: Path) -> Material:
    """A test whose every text wants to be something else."""
    made = material(folder, label=HOSTILE, description=f"'''{HOSTILE}'''")
    named = channel(HOSTILE, "V", lambda t: 1.0 + 0.0 * t, HOSTILE)
    log = TestLog({**made.log.channels, HOSTILE: named})
    odd = {"m": quantity(1.0, HOSTILE, 0.1, why=HOSTILE, verdict=HOSTILE), "rest": {"remarks": [HOSTILE]}}
    provenance = {"raw": {HOSTILE: HOSTILE}}
    products = {
        "ingest": {**summary(log).to_json(), "warnings": [HOSTILE], "provenance": provenance},
        "segments": {**SEGMENTS, "warnings": [HOSTILE], "notes": [HOSTILE], "provenance": provenance},
        "calibration": {**CALIBRATION, **odd, "warnings": [HOSTILE], "notes": [HOSTILE], "provenance": provenance},
    }
    return replace(saying(made, **products), log=log, absent={"validation": HOSTILE})


def test_hostile_texts_are_shown_not_obeyed(tmp_path: Path, text: str) -> None:
    attacked = page(hostile(tmp_path))
    reader = Reader(attacked)
    assert reader.open == []
    assert "img" not in {tag for tag, _ in reader.tags}
    assert len(reader.all("script")) == len(Reader(text).all("script"))
    assert not any(name.startswith("on") for _, attrs in reader.tags for name in attrs)
    assert "&lt;script&gt;" in attacked
    assert "49" not in re.findall(r"&amp;(.{0,20})", attacked)[0]


def test_hostile_texts_do_not_break_the_data_of_the_charts(tmp_path: Path) -> None:
    found = re.search(r'id="chart-data">(.*?)</script>', page(hostile(tmp_path)), re.DOTALL)
    assert found is not None
    charts = json.loads(found[1])["charts"]
    assert HOSTILE in [series["label"] for chart in charts.values() for series in chart["series"]]


def test_every_chart_has_a_text_alternative(text: str) -> None:
    reader = Reader(text)
    charts = [attrs for attrs in reader.all("svg") if attrs["class"] == "chart"]
    ids = [attrs["id"] for _, attrs in reader.tags if "id" in attrs]
    tables = [attrs for attrs in reader.all("details") if attrs.get("class") not in ("fold", "more", "why")]
    assert len(charts) == len(reader.all("figure")) == len(tables) == 30
    assert len(ids) == len(set(ids))
    for chart in charts:
        assert chart["role"] == "img"
        assert {chart["aria-labelledby"], chart["aria-describedby"]} <= set(ids)


def test_the_text_alternative_is_a_sentence_from_the_data(text: str) -> None:
    (said,) = re.findall(r'<desc id="tank-mass-desc"[^>]*>(.*?)</desc>', text)
    assert re.search(r"tank mass: 8\.\d+ kg at −2\.0 s, 0\.\d+ kg at 20\.0 s; highest", said)
    assert "liquid gone at 5.27 s" in said


def test_what_scrolls_can_be_reached_by_keyboard_and_has_a_name(text: str) -> None:
    regions = [attrs for attrs in Reader(text).all("div") if attrs.get("class") == "scroll"]
    assert regions
    assert all(attrs["tabindex"] == "0" and attrs["role"] == "region" and attrs["aria-label"] for attrs in regions)


def test_a_replica_is_called_a_replica(tmp_path: Path, text: str) -> None:
    assert "REPLICA: generated, not measured" in text
    assert "REPLICA" not in page(material(tmp_path, source="measured"))


def test_the_verdict_names_what_is_known_and_what_is_not(tmp_path: Path) -> None:
    said = sentence(material(tmp_path))
    assert said.startswith(
        "Identified: effective injector coefficient, feed loss coefficient, liquid-phase feed loss and "
        "regression rate at the reference flux."
    )
    assert "Outside its physical range: polytropic exponent." in said
    assert "Not identifiable from this test: vapor compressibility, vapor-phase feed loss, regression" in said


def test_what_is_derived_stated_or_conditional_is_not_called_unidentifiable(tmp_path: Path) -> None:
    made = material(tmp_path)
    found = made.need(Calibration)
    judged = {"Z": DERIVED, "K_loss": STATED, "C_i": CONDITIONAL}
    quantities = {name: Quantity(0.5, "", 0.01, verdict=verdict) for name, verdict in judged.items()}
    said = sentence(replace(made, products={**made.products, "calibration": found.but(**quantities)}))
    assert "Conditional, for the reasons below: effective injector coefficient." in said
    assert "Derived from others, or stated: vapor compressibility and feed loss coefficient." in said
    assert "vapor compressibility" not in said.partition("Not identifiable")[2]


def test_the_verdict_names_the_sensors_that_look_wrong(tmp_path: Path) -> None:
    said = sentence(saying(material(tmp_path), health=HEALTH))
    assert said.endswith("Sensors: thrust zero off; thrust and chamber pressure scale off.")
    assert "Sensors:" not in sentence(material(tmp_path))


def test_why_a_channel_is_doubted_stands_once_and_its_numbers_have_its_mark(tmp_path: Path) -> None:
    """Two numbers rest on the thrust's zero; what else is said of one of them stays in its row."""
    shift = "thrust (zero): reads 76 N after the firing and 0 N before it"
    measured = {
        "total_impulse": quantity(18_340.0, "N s", 60.0, verdict="doubted", why=shift),
        "peak_thrust": quantity(2430.0, "N", 15.0, verdict="doubted", why=f"{shift}; of the despiked signal"),
    }
    validation = {**VALIDATION, "performance": {"measured": measured, "model": {}}}
    text = page(saying(material(tmp_path), health=HEALTH, validation=validation))
    shown = re.sub("<[^>]*>", "", re.sub(r' title="[^"]*"', "", text))
    assert shown.count("after the firing and") == 1
    assert text.count('href="#reason-1"') >= 4
    assert text.count('id="reason-1"') == 1
    (row,) = re.findall(r"<tr><th[^>]*>peak thrust.*?</tr>", text, re.DOTALL)
    assert "doubted" in row
    assert "of the despiked signal" in row


def test_quantities_that_lack_the_same_thing_share_the_reason(tmp_path: Path) -> None:
    lacking = {"value": None, "reason": "no injector area", "verdict": "not identifiable"}
    calibration = {**CALIBRATION, "C_i": lacking, "m": lacking, "Z": lacking}
    found = {laid.key: laid for laid in lay_out(saying(material(tmp_path), calibration=calibration))}
    assert "".join(map(str, found["findings"].blocks)).count("no injector area") == 1


def test_modes_that_could_not_run_say_why(tmp_path: Path) -> None:
    made = material(tmp_path)
    text = page(saying(made, validation={**VALIDATION, "absent": {"full": "test.toml does not state the throat"}}))
    assert "Full: test.toml does not state the throat" in text


def test_reasons_and_values_are_on_the_page(text: str) -> None:
    for words in ("needs 14 kW of heat", "the vapor phase lasts 0.05 s", "11.43", "set by the engineer", "ab" * 32):
        assert words in text


def test_what_looks_wrong_with_the_sensors_stands_apart_from_the_rest(tmp_path: Path) -> None:
    logged, others = warnings(material(tmp_path))
    assert logged == ["samples flagged dropout: p_run (10 of 4600)"]
    assert others == ["the purge check valve opens before the liquid is gone"]


def test_the_sections_stand_in_the_order_in_which_they_are_read(text: str) -> None:
    heads = re.findall(r'<h2 id="(\w+)-head"', text)
    order = [
        "verdict",
        "diagnosis",
        "phases",
        "pressures",
        "injector",
        "thrust",
        "flow",
        "regression",
        "residuals",
        "calibration",
    ]
    assert [head for head in heads if head in order] == order
    assert heads[-1] == "absent" or heads[-1] == "provenance"


def test_every_section_is_left_out_with_its_reason(tmp_path: Path) -> None:
    bare = without(
        material(tmp_path), calibration="no liquid phase", validation="no liquid phase", residuals="no model"
    )
    for laid in lay_out(replace(bare, log=TestLog({}), stores={})):
        assert laid.blocks or laid.absent or dict(sections())[laid.key].unasked
    reasons = {laid.key: laid.absent for laid in lay_out(bare)}
    assert reasons["calibration"] == "no liquid phase"
    assert reasons["residuals"] == "no model"
    assert "no model" in page(bare)


def test_what_lacks_the_same_thing_is_named_together(tmp_path: Path) -> None:
    names = ("segments", "calibration", "validation", "residuals", "performance", "flight")
    text = page(without(material(tmp_path), **dict.fromkeys(names, "nothing opens")))
    absent = text[text.index('id="absent"') :]
    assert absent.count("nothing opens") == 1
    together = absent[: absent.index("nothing opens")]
    assert all(title in together for title in ("Performance", "Phases", "Model against measurement", "Calibration"))


def test_the_page_has_its_landmarks_and_a_way_past_them(text: str) -> None:
    reader = Reader(text)
    for landmark in ("header", "nav", "main", "footer", "h1"):
        assert len(reader.all(landmark)) == 1, landmark
    skip = next(attrs for attrs in reader.all("a") if attrs.get("class") == "skip")
    ids = {attrs.get("id") for _, attrs in reader.tags}
    assert {attrs["href"] for attrs in reader.all("a")} <= {f"#{name}" for name in ids if name}
    assert skip["href"] == "#main"
    levels = [int(tag[1]) for tag, _ in reader.tags if re.fullmatch("h[1-6]", tag)]
    assert all(after - before <= 1 for before, after in itertools.pairwise(levels))


def test_every_section_says_what_it_needs() -> None:
    known = {"ingest", "health", "segments", "calibration", "validation", "residuals", "performance", "flight"}
    known |= {"diagnosis"}
    for _, section in sections():
        assert set(section.needs) <= known


def test_every_number_of_a_table_knows_both_systems_of_units(text: str) -> None:
    (row,) = re.findall(r"<tr><th[^>]*>peak chamber pressure.*?</tr>", text, re.DOTALL)
    assert 'data-value="1320000.0" data-unit="Pa" data-si="13.20" data-team="191.4"' in row
    assert 'data-si="bar" data-team="psi"' in row


def test_forces_in_the_sentences_of_products_change_with_the_units(tmp_path: Path) -> None:
    text = page(saying(material(tmp_path), health=HEALTH))
    assert '<span data-si="76 N" data-team="17.1 lbf">76 N</span>' in text


def test_a_log_without_a_firing_gets_a_page_that_says_so(tmp_path: Path) -> None:
    names = ("segments", "calibration", "validation", "residuals", "performance")
    text = page(without(material(tmp_path), **dict.fromkeys(names, "nothing opens")))
    assert "No firing was found in this log" in text
    assert "nothing opens" in text
    assert "log time [s]" in text


def test_nitrogen_may_come_before_the_liquid_is_gone(tmp_path: Path) -> None:
    early = {**SEGMENTS, "t_purge": quantity(3.0, "s", 0.01)}
    found = [(phase.name, phase.start, phase.end) for phase in phase_list(saying(material(tmp_path), segments=early))]
    assert found == [
        ("line filling", 0.0, 0.87),
        ("liquid", 0.87, 3.0),
        ("liquid + N₂", 3.0, 5.271),
        ("vapor + N₂", 5.271, 17.0),
    ]


def test_dead_channels_leave_no_chart_and_no_crash(tmp_path: Path) -> None:
    dead = channel("p_tank", "Pa", lambda t: np.full(t.size, np.nan))
    bare = without(material(tmp_path), "residuals", "calibration", "performance")
    laid = {section.key: section for section in lay_out(replace(bare, log=TestLog({"p_tank": dead})))}
    assert laid["pressures"].absent == "there is nothing to draw"


def _luminance(color: str) -> float:
    parts = [int(color[i : i + 2], 16) / 255.0 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def _contrast(a: str, b: str) -> float:
    low, high = sorted((_luminance(a), _luminance(b)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_colors_reach_wcag_aa(dark: bool) -> None:
    colors = {name: pair[dark] for name, pair in COLORS.items()}
    for ground in ("paper", "raised"):
        for ink in ("ink", "soft", "accent", "good", "open", "bad"):
            assert _contrast(colors[ink], colors[ground]) >= 4.5, (ink, ground)
        for line in (*STYLES, "model", "raw", "residual", "C_i", "p_fill"):
            assert _contrast(colors[line], colors[ground]) >= 3.0, (line, ground)
    for verdict in ("good", "open", "bad"):
        assert _contrast(colors[verdict], colors[f"{verdict}-tint"]) >= 4.5, verdict


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_names_of_phases_stand_out_from_their_tints(dark: bool) -> None:
    colors = {name: pair[dark] for name, pair in COLORS.items()}
    share = float(re.findall(r"\.phase \{ opacity: ([\d.]+)", sheet())[0])
    for tint in ("fill", "liquid", "vapor", "nitrogen"):
        ground = _mixed(colors[tint], colors["paper"], share)
        assert _contrast(colors["soft"], ground) >= 4.5, tint
        assert _contrast(colors["ink"], ground) >= 4.5, tint


def _mixed(a: str, b: str, share: float) -> str:
    parts = ((int(a[i : i + 2], 16), int(b[i : i + 2], 16)) for i in (1, 3, 5))
    return "#" + "".join(f"{round(share * x + (1 - share) * y):02x}" for x, y in parts)


def test_every_color_that_the_style_sheet_asks_for_is_there() -> None:
    assert set(re.findall(r"var\(--([\w-]+)[),]", sheet())) - {"c"} <= set(COLORS)


def test_a_drift_that_could_not_be_removed_is_told(tmp_path: Path) -> None:
    made = material(tmp_path)
    doubtful = replace(
        made.log.channels["thrust"],
        history=("tare: no settled level after the firing: drift not removed",),
    )
    text = page(replace(made, log=TestLog({**made.log.channels, "thrust": doubtful})))
    assert "No settled level after the firing: drift not removed." in text


def test_the_flight_tells_its_checks_and_its_margin(text: str) -> None:
    flight = text[text.index('<section id="flight"') :]
    assert re.search(r"failed</span> velocity leaving the rail: at least <span[^>]*>30\.48 m/s</span>", flight)
    assert "static margin at rail departure (calibers)" in flight


def test_without_a_geometry_the_page_says_what_to_add(tmp_path: Path) -> None:
    made = material(tmp_path)
    bare = {"margin_at_rail_departure": {"value": None, "reason": "no [rocket.geometry] is given"}}
    text = page(saying(made, flight={**FLIGHT, "stability": bare}))
    assert 'id="chart-flight-margin"' not in text
    (paragraph,) = re.findall(r"No static margin is drawn: .*?</p>", text)
    sentence = re.sub("<[^>]*>", "", paragraph)
    for name in ("[rocket.geometry]", "test.toml", "nose", "fins", "structure", "tank_position", "chamber_position"):
        assert name in sentence


def test_the_flight_s_charts_mark_the_rail_s_end_and_the_end_of_the_burn(text: str) -> None:
    found = re.findall(r"Events: off the rail at 0\.5\d s, burn out at 12\.40 s\.", text)
    assert len(found) >= 3


def test_c_star_says_where_it_ends_and_why(tmp_path: Path, text: str) -> None:
    assert "It ends where nitrogen enters" in text
    made = material(tmp_path)
    segments = {name: value for name, value in SEGMENTS.items() if name != "t_purge"}
    assert "It ends where nitrogen enters" not in page(saying(made, segments=segments))


def test_the_index_lists_every_test() -> None:
    rows = [
        {
            "id": HOSTILE,
            "kind": "hot fire",
            "date": "",
            "source": "replica",
            "sentence": HOSTILE,
            "numbers": [[HOSTILE, HOSTILE, HOSTILE]],
            "spark": {"path": "M0 0L1 1", "of": HOSTILE, "style": HOSTILE},
            "href": "a%3C/report.html",
            "compared": [(HOSTILE, "a%3C/compare_b.html")],
            "limits": [("broken", HOSTILE)],
            "kept": 2,
        }
    ]
    text = render("index.html.j2", rows=rows, campaign="")
    assert Reader(text).open == []
    assert text.count("<script>") == 1


def test_the_index_leads_to_the_pages_of_pairs_and_of_the_campaign(tmp_path: Path) -> None:
    folder = tmp_path / "processed"
    (folder / "HF0").mkdir(parents=True)
    (folder / "HF0" / "report.html").write_text(page(material(tmp_path)), encoding="utf-8")
    assert "compare_" not in write_index(folder).read_text(encoding="utf-8")
    (folder / "HF0" / "compare_HF1.html").write_text("", encoding="utf-8")
    (folder / "campaign.html").write_text("", encoding="utf-8")
    text = write_index(folder).read_text(encoding="utf-8")
    assert '<a href="HF0/compare_HF1.html">HF1</a>' in text
    assert '<a href="campaign.html">' in text


def test_the_index_reads_what_the_pages_say_of_themselves(tmp_path: Path) -> None:
    (tmp_path / "processed" / "HF0").mkdir(parents=True)
    (tmp_path / "processed" / "HF0" / "report.html").write_text(page(hostile(tmp_path)), encoding="utf-8")
    text = write_index(tmp_path / "processed").read_text(encoding="utf-8")
    assert Reader(text).open == []
    assert 'data-si="2430 N" data-team="546.3 lbf"' in text
    assert "chamber pressure over the test" in text
    assert "REPLICA" in text


def test_a_few_wild_readings_do_not_flatten_a_chart_but_are_told(tmp_path: Path) -> None:
    made = material(tmp_path)
    mass = made.log.channels["m_tank"]
    wild = mass.values.copy()
    wild[2000:2010] = 540.0
    log = TestLog({"m_tank": replace(mass, values=wild)})
    text = page(replace(made, log=log))
    assert re.search(r"A few readings lie outside the chart, as far as <span[^>]*>540 kg</span>\.", text)
    low, high = value_range([wild])
    assert low == 0.0
    assert 8.0 < high < 20.0


def test_names_of_events_never_overlap() -> None:
    plot = new_plot((-2.0, 20.0), (0.0, 1.0))
    events(plot, [Event(0.0, 0.0, "t_open"), Event(0.2, 0.0, "t_feed"), Event(0.4, 0.0, "t_v")])
    heights = re.findall(r'class="event-name" x="[\d.]+" y="([\d.]+)"', "".join(plot.parts))
    assert len(set(heights)) == 3


def test_adopted_effects_show_in_the_verdict_and_in_what_the_page_is_made_from(tmp_path: Path) -> None:
    made = material(tmp_path)
    parameters = {"power": quantity(900.0, "W", 0.0), "lag": quantity(0.1, "s", 0.0)}
    effect = {"name": "tank_heat", "file": "T.effects.toml", "parameters": parameters}
    text = page(saying(made, calibration={**CALIBRATION, "effects": [effect]}))
    assert "Included in the model: heat into the tank, 0.9 kW; the numbers hold with it." in text
    assert text.count("Included in the model: heat into the tank, 0.9 kW (lag 0.1 s) (engines/T.effects.toml).") == 1
    assert "Included" not in page(made)


def test_the_code_of_every_stage_is_stated_and_what_they_share_once(tmp_path: Path) -> None:
    made = material(tmp_path)
    stated = {"hfanalysis": "1", "libraries": {"numpy": "2"}}
    origins = {name: part.but(provenance={**stated, "code": f"{name}!"}) for name, part in made.products.items()}
    (table,) = provenance.render(replace(made, products=origins))
    assert [str(table).count(f"<code>{name}!</code>") for name in origins] == [1] * len(origins)
    assert str(table).count("libraries / numpy") == 1


def test_the_page_says_what_reaches_the_injector_and_what_a_small_coefficient_does_not_say(text: str) -> None:
    found = text[text.index("What reaches the injector") :]
    for words in (
        "439",
        "isenthalpic",
        "homogeneous equilibrium",
        "effective",
        "does not say that the injector is poor",
    ):
        assert words in found, words
