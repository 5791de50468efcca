"""The page in a real browser: it opens offline, complains about nothing, answers to hands, and can be read by all.

Skips where there is no Chromium, unless HFA_REQUIRE_BROWSER is set: then its absence is a failure.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image
from tests.campaign.rows import made as campaign
from tests.cli.run import hfa
from tests.report.browser import CHROMIUM, Page, browser
from tests.report.sample import channel, material
from tests.report.test_page import hostile

from hfanalysis.campaign.page import page as campaign_page
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import Channel
from hfanalysis.report.compare import compare
from hfanalysis.report.page import page
from hfanalysis.report.pdf import print_page

ENGINE = Path(__file__).parents[2] / "engines" / "maelstrom.toml"
PRESSURES = '[data-chart="pressures"]'


@pytest.fixture(scope="module")
def tab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    """A tab of a real browser."""
    if CHROMIUM is None:
        if os.environ.get("HFA_REQUIRE_BROWSER"):
            pytest.fail("no Chromium here, and HFA_REQUIRE_BROWSER asks for one")
        pytest.skip("no Chromium here")
    with browser(tmp_path_factory.mktemp("profile")) as opened:
        yield opened


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of a test that has everything."""
    folder = tmp_path_factory.mktemp("page")
    (folder / "report.html").write_text(page(material(folder)), encoding="utf-8")
    return folder / "report.html"


@pytest.fixture
def opened(tab: Page, path: Path) -> Page:
    """That page, opened anew, as the first reader finds it."""
    tab.forget()
    tab.console.clear()
    tab.requests.clear()
    return tab.open(path)


def ticks(tab: Page, chart: str = PRESSURES, axis: str = "x") -> list[float]:
    """The values at an axis."""
    found = tab.ask(f"[...document.querySelectorAll('{chart} .{axis}-tick')].map((tick) => tick.textContent)")
    return [float(text.replace("−", "-")) for text in found]


def read_out(tab: Page, chart: str = PRESSURES) -> list[str]:
    """What the legend says under the cursor."""
    return list(tab.ask(f"[...document.querySelectorAll('{chart} output')].map((output) => output.textContent)"))


def test_the_page_complains_about_nothing_and_asks_for_nothing(opened: Page, path: Path) -> None:
    assert opened.console == []
    assert {url for url in opened.requests if not url.startswith("data:")} == {path.as_uri()}


def test_a_drag_zooms_all_charts_and_a_double_click_shows_all(opened: Page) -> None:
    left, top, width, height = opened.show(f"{PRESSURES} .plot")
    before = ticks(opened)
    opened.drag((left + 0.3 * width, top + 0.5 * height), (left + 0.5 * width, top + 0.5 * height))
    after = ticks(opened)
    assert before[0] < after[0] < after[-1] < before[-1]
    beside = ticks(opened, '[data-chart="glance-thrust"]')
    assert after[0] - 0.5 < beside[0] < beside[-1] < after[-1] + 0.5
    opened.click(left + 0.4 * width, top + 0.5 * height, count=2)
    assert ticks(opened) == before


def test_a_flight_has_a_clock_of_its_own(opened: Page) -> None:
    unfold(opened)
    left, top, width, height = opened.show(f"{PRESSURES} .plot")
    before = ticks(opened, '[data-chart="flight-height"]')
    opened.drag((left + 0.3 * width, top + 0.5 * height), (left + 0.5 * width, top + 0.5 * height))
    assert ticks(opened, '[data-chart="flight-height"]') == before


def test_zooming_fits_the_values_to_what_is_seen(opened: Page) -> None:
    unfold(opened)
    left, top, width, height = opened.show('[data-chart="tank-mass"] .plot')
    opened.drag((left + 0.7 * width, top + 0.5 * height), (left + 0.8 * width, top + 0.5 * height))
    values = ticks(opened, '[data-chart="tank-mass"]', "y")
    assert values[-1] - values[0] < 1.0


def test_zooming_in_shows_every_sample_of_the_log(opened: Page) -> None:
    left, top, width, height = opened.show(f"{PRESSURES} .plot")
    line = f"document.querySelector('{PRESSURES} .chart > .line.p_tank').getAttribute('d').split(/[ML]/).length - 1"
    for _ in range(2):
        opened.drag((left + 0.4 * width, top + 0.5 * height), (left + 0.45 * width, top + 0.5 * height))
    first, last = ticks(opened)[0], ticks(opened)[-1]
    assert last - first < 0.2
    assert opened.ask(line) >= 200.0 * (last - first)


def test_a_page_is_ready_at_once(opened: Page) -> None:
    before = opened.ask("performance.getEntriesByType('navigation')[0].domContentLoadedEventEnd")
    assert before < 3000.0


def test_the_wheel_zooms_about_the_pointer_and_leaves_scrolling_alone(opened: Page) -> None:
    left, top, width, height = opened.show(f"{PRESSURES} .plot")
    place = (left + 0.5 * width, top + 0.5 * height)
    before = ticks(opened)
    opened.mouse("mouseMoved", *place)
    for _ in range(4):
        opened.mouse("mouseWheel", *place, deltaX=0, deltaY=-120)
    opened.settle()
    assert ticks(opened)[-1] - ticks(opened)[0] < 0.6 * (before[-1] - before[0])
    for _ in range(6):
        opened.mouse("mouseWheel", *place, deltaX=0, deltaY=120)
    opened.settle()
    assert ticks(opened) == before


def test_the_cursor_reads_every_line_in_every_chart(opened: Page) -> None:
    left, top, width, height = opened.show(f"{PRESSURES} .plot")
    opened.mouse("mouseMoved", left + 0.4 * width, top + 0.5 * height)
    opened.settle()
    t = float(opened.ask(f"document.querySelector('{PRESSURES} .instant').textContent")[4:-2])
    tank, _, chamber, _ = (float(text.split()[0]) for text in read_out(opened))
    assert tank == pytest.approx(65.0 * 2.718281828 ** (-t / 14.0), rel=0.05)
    assert chamber == pytest.approx(1.0 + 13.0 * 2.718281828 ** (-t / 9.0), rel=0.05)
    assert read_out(opened, '[data-chart="glance-thrust"]')[0].endswith(" N")


def test_a_line_can_be_taken_out_and_put_back(opened: Page) -> None:
    drawn = f"document.querySelectorAll('{PRESSURES} .chart > .line.p_run').length"
    before = opened.ask(drawn)
    opened.ask(f"document.querySelectorAll('{PRESSURES} .key')[1].click()")
    opened.settle()
    assert opened.ask(drawn) == 0
    assert opened.ask(f"document.querySelectorAll('{PRESSURES} .key')[1].getAttribute('aria-pressed')") == "false"
    opened.ask(f"document.querySelectorAll('{PRESSURES} .key')[1].click()")
    opened.settle()
    assert opened.ask(drawn) == before > 0


def test_the_keyboard_does_what_the_mouse_does(opened: Page) -> None:
    opened.ask(f"document.querySelector('{PRESSURES} .plot').focus()")
    before = ticks(opened)
    opened.press("ArrowRight")
    first = opened.ask("document.getElementById('spoken').textContent")
    assert re.match(r"t = \d+\.\d+ s: tank \d+\.\d+ bar, run line", first)
    opened.press("ArrowRight")
    assert opened.ask("document.getElementById('spoken').textContent") != first
    opened.press("+")
    opened.press("+")
    zoomed = ticks(opened)
    assert zoomed[-1] - zoomed[0] < 0.7 * (before[-1] - before[0])
    opened.press("-")
    assert ticks(opened) != zoomed
    opened.press("0")
    assert ticks(opened) == before


def unfold(tab: Page) -> None:
    """Open every section, and what is folded within."""
    tab.ask("document.querySelectorAll('details.fold, details.more').forEach((fold) => { fold.open = true })")
    tab.settle()


SECTION = "document.getElementById('diagnosis')"
WEAK = '[data-chart="diagnosis-weak-tank-energy"]'


def test_the_diagnosis_is_read_and_drawn_without_a_complaint(opened: Page) -> None:
    unfold(opened)
    said = opened.ask(f"{SECTION}.innerText")
    assert "Missing from the model, with probability: heat into the tank (0.83)." in said
    assert "m 0.75 refitted, 1.08 with the effects." in said
    assert opened.ask(f"{SECTION}.querySelectorAll('figure .line.p_tank').length") > 0
    bars = opened.ask(
        f"[...{SECTION}.querySelectorAll('.share')].map((b) => b.lastChild.getBoundingClientRect().width)"
    )
    assert bars == sorted(bars, reverse=True)
    assert bars[0] > 5.0 * bars[1] > 0.0
    assert opened.console == []


def test_what_is_folded_within_the_diagnosis_is_drawn_when_it_opens(opened: Page) -> None:
    drawn = f"document.querySelectorAll('{WEAK} .overlay').length"
    before = opened.ask(drawn)
    assert not opened.ask(f"document.querySelector('{WEAK}').checkVisibility()")
    unfold(opened)
    assert opened.ask(f"document.querySelector('{WEAK}').checkVisibility()")
    assert opened.ask(drawn) > before
    left, top, width, height = opened.show(f"{WEAK} .plot")
    opened.mouse("mouseMoved", left + 0.4 * width, top + 0.5 * height)
    opened.settle()
    assert read_out(opened, WEAK)[0].endswith(" kW")


def test_paper_shows_what_is_folded_within_the_diagnosis(tab: Page, path: Path) -> None:
    tab.open(path)
    shown = f"document.querySelector('{WEAK}').checkVisibility()"
    tab.ask("dispatchEvent(new Event('beforeprint'))")
    assert tab.ask(shown)
    tab.ask("dispatchEvent(new Event('afterprint'))")
    assert not tab.ask(shown)


def test_tab_reaches_every_chart_and_the_focus_is_seen(opened: Page) -> None:
    unfold(opened)
    reached, outlined = set(), True
    for _ in range(600):
        opened.press("Tab")
        name, style = opened.ask(
            "(() => { const e = document.activeElement; return [e.closest('figure') && e.classList.contains('plot')"
            " ? e.closest('figure').dataset.chart : e.tagName, getComputedStyle(e).outlineStyle] })()"
        )
        outlined &= style != "none" or name == "BODY"
        reached.add(name)
        if name == "BODY":
            break
    assert (
        set(opened.ask("[...document.querySelectorAll('figure[data-chart]')].map((f) => f.dataset.chart)")) <= reached
    )
    assert outlined


def test_the_units_change_everywhere_and_back(opened: Page) -> None:
    numbers = (
        "[...document.querySelectorAll('[data-value][data-unit=Pa]')].map((e) => [e.dataset.value, e.textContent])"
    )
    whole = "document.body.innerText"
    before = opened.ask(whole)
    opened.ask("document.querySelector('#choose-units [value=team]').click()")
    opened.settle()
    found = opened.ask(numbers)
    assert len(found) > 10
    for si, shown in found:
        number = float(shown.split()[0].replace("−", "-"))
        assert number == pytest.approx(float(si) / 6894.757293168, rel=5e-3, abs=0.06), shown
    assert opened.ask(f"document.querySelector('{PRESSURES} .y-label').textContent") == "pressure [psi]"
    assert max(ticks(opened, PRESSURES, "y")) > 800.0
    assert "psi" in opened.ask("document.getElementById('pressures-desc').textContent")
    assert not re.search(r"\d (bar|N)\b", opened.ask(whole))
    opened.ask("document.querySelector('#choose-units [value=si]').click()")
    opened.settle()
    assert opened.ask(whole) == before


def test_a_choice_is_kept_for_the_next_page(opened: Page, path: Path) -> None:
    opened.ask("document.querySelector('#choose-units [value=team]').click()")
    opened.ask("document.querySelector('#choose-theme [value=dark]').click()")
    opened.open(path)
    assert "psi" in opened.ask("document.querySelector('#verdict').innerText")
    assert opened.ask("document.documentElement.dataset.theme") == "dark"


CONTRAST = """(() => {
  const parts = (text) => text.match(/[\\d.]+/g).map(Number);
  const luminance = ([r, g, b]) => [r, g, b].map((c) => c / 255)
    .map((c) => c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
    .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
  const ground = (element) => {
    for (let e = element; e; e = e.parentElement) {
      const color = parts(getComputedStyle(e).backgroundColor);
      if (color.length < 4 || color[3] > 0) return color;
    }
    return [255, 255, 255];
  };
  const found = [], walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const text = walker.currentNode.data.trim(), element = walker.currentNode.parentElement;
    if (!text || !element.checkVisibility() || ["SCRIPT", "STYLE", "title", "desc"].includes(element.tagName)) continue;
    const style = getComputedStyle(element), ink = parts(element.closest("svg") ? style.fill : style.color);
    const [a, b] = [luminance(ink), luminance(ground(element))].sort((x, y) => x - y);
    found.push([(b + 0.05) / (a + 0.05), text.slice(0, 40)]);
  }
  return found;
})()"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_text_stands_out_from_its_ground(opened: Page, path: Path, scheme: str) -> None:
    opened.open(path, prefers_color_scheme=scheme)
    opened.ask("document.querySelectorAll('details').forEach((fold) => { fold.open = true })")
    ratios = opened.ask(CONTRAST)
    assert len(ratios) > 500
    assert [text for ratio, text in ratios if ratio < 4.5] == []


def test_the_theme_can_be_chosen_against_the_systems(opened: Page, path: Path) -> None:
    opened.open(path, prefers_color_scheme="dark")
    ground = "getComputedStyle(document.body).backgroundColor"
    dark = opened.ask(ground)
    opened.ask("document.querySelector('#choose-theme [value=light]').click()")
    assert opened.ask(ground) != dark
    opened.ask("document.querySelector('#choose-theme [value=auto]').click()")
    assert opened.ask(ground) == dark


@pytest.mark.parametrize("width", [320, 390, 768])
def test_a_narrow_screen_never_scrolls_sideways(opened: Page, path: Path, width: int) -> None:
    opened.open(path, width=width, height=844)
    assert opened.ask("document.documentElement.scrollWidth") <= width
    for chart in opened.ask("[...document.querySelectorAll('.chart')].map((svg) => svg.getBoundingClientRect().right)"):
        assert chart <= width


def test_paper_has_all_charts_and_no_controls(opened: Page, tmp_path: Path) -> None:
    charts = opened.ask("document.querySelectorAll('figure').length")
    opened.media("print")
    opened.settle()
    visible = "[...document.querySelectorAll('{}')].filter((e) => e.checkVisibility()).length"
    assert opened.ask(visible.format("figure svg.chart")) == charts > 10
    assert opened.ask(visible.format("figure details, nav, .bar, .save-csv")) == 0
    assert opened.ask("getComputedStyle(document.body).color") == "rgb(27, 31, 36)"
    printed = opened.printed(tmp_path / "page.pdf").read_bytes()
    assert printed.startswith(b"%PDF")
    assert len(printed) > 50_000


def test_a_dark_screen_prints_on_white_paper(opened: Page, path: Path) -> None:
    opened.ask("document.querySelector('#choose-theme [value=dark]').click()")
    opened.media("print", prefers_color_scheme="dark")
    assert opened.ask("getComputedStyle(document.documentElement).getPropertyValue('--paper')") == "#ffffff"
    assert opened.ask("getComputedStyle(document.body).color") == "rgb(27, 31, 36)"


@pytest.mark.parametrize(
    ("size", "in_sight"),
    [((1440, 900), ".to-contents, .four, .key-numbers, #verdict svg.chart"), ((390, 844), ".four, .key-numbers")],
)
def test_the_first_screen_holds_sentences_numbers_and_charts(
    opened: Page, path: Path, size: tuple[int, int], in_sight: str
) -> None:
    opened.open(path, width=size[0], height=size[1])
    bottoms = opened.ask(f"[...document.querySelectorAll('{in_sight}')].map((e) => e.getBoundingClientRect().bottom)")
    assert max(bottoms) <= size[1]
    below = opened.ask("document.querySelector('#verdict svg.chart').getBoundingClientRect().top")
    assert below >= opened.ask("document.querySelector('.key-numbers').getBoundingClientRect().bottom")


def test_what_is_looked_up_is_folded_and_its_link_opens_it(opened: Page) -> None:
    shown = "[...document.querySelectorAll('{} svg.chart')].some((e) => e.checkVisibility())"
    assert opened.ask(shown.format("#pressures"))
    assert not opened.ask(shown.format("#residuals"))
    link = "document.querySelector('#contents a[href=\"#residuals\"]').click()"
    for _ in range(2):
        opened.ask(link)
        opened.ask("new Promise((done) => setTimeout(done, 100))")
        opened.settle()
        assert opened.ask(shown.format("#residuals"))
        opened.ask("document.querySelector('#residuals summary').click()")
        opened.settle()
        assert not opened.ask(shown.format("#residuals"))


def test_all_sections_but_the_verdict_fold_at_once(opened: Page) -> None:
    height = "document.documentElement.scrollHeight"
    whole = opened.ask(height)
    opened.ask("document.querySelector('#fold-all').click()")
    opened.settle()
    assert opened.ask(height) < 0.4 * whole
    assert opened.ask("document.querySelector('#verdict .four').checkVisibility()")
    opened.ask("document.querySelector('#fold-all').click()")
    opened.settle()
    assert opened.ask(height) > whole


def test_a_chart_that_was_folded_fits_when_it_opens(opened: Page, path: Path) -> None:
    opened.open(path, width=700)
    unfold(opened)
    frame = '[data-chart="full-thrust"]'
    wide, drawn = opened.ask(
        f"(() => {{ const plot = document.querySelector('{frame} .plot'); return [plot.clientWidth,"
        " plot.querySelector('svg').viewBox.baseVal.width] })()"
    )
    assert drawn == pytest.approx(wide, abs=1.0)


def test_the_margin_is_drawn_with_bands_for_every_wind_between_its_limits(opened: Page) -> None:
    chart = '[data-chart="flight-margin"]'
    unfold(opened)
    opened.show(f"{chart} .plot")
    for kind, count in (("line", 2), ("band", 2), ("level", 2)):
        drawn = f"document.querySelectorAll('{chart} .chart > .{kind}:not([d$=\"h12\"])').length"
        assert opened.ask(drawn) == count, kind
    values = ticks(opened, chart, "y")
    assert values[0] <= 1.5
    assert values[-1] >= 6.0
    opened.ask(f"document.querySelector('{chart} .plot').focus()")
    opened.press("Home")
    for _ in range(5):
        opened.press("ArrowRight")
    assert "wind 2.2 m/s" in opened.ask("document.getElementById('spoken').textContent")


def test_without_script_the_charts_are_there_and_the_controls_are_not(tab: Page, path: Path) -> None:
    count = "[...document.querySelectorAll('{}')].filter((e) => e.checkVisibility()).length"
    with tab.without_script():
        tab.open(path, width=1200)
        assert tab.ask(count.format("figure svg.chart .line")) > 10
        assert tab.ask(count.format(".bar, .key, .save-csv")) == 0


def test_hostile_text_is_shown_as_text(tab: Page, tmp_path: Path) -> None:
    (tmp_path / "hostile.html").write_text(page(hostile(tmp_path)), encoding="utf-8")
    tab.console.clear()
    tab.open(tmp_path / "hostile.html", width=390)
    assert tab.console == []
    assert "<script>alert(1)</script>" in tab.ask("document.body.innerText")
    assert tab.ask("document.images.length") == 0
    assert tab.ask("document.documentElement.scrollWidth") <= 390


@pytest.mark.parametrize("name", ["</svg></figure>", "\u202eknat", "x" * 400, "a\"b'c", "]]>", "<!--"])
def test_odd_names_of_channels_stay_names(tab: Page, tmp_path: Path, name: str) -> None:
    made = material(tmp_path, label=name)
    made.log.channels[name] = channel(name, "V", lambda t: 1.0 + 0.0 * t)
    (tmp_path / "odd.html").write_text(page(made), encoding="utf-8")
    tab.console.clear()
    tab.open(tmp_path / "odd.html", width=390)
    assert tab.console == []
    entry = f"[...document.querySelectorAll('.legend bdi')].some((e) => e.textContent === {json.dumps(name)})"
    assert tab.ask(entry)
    framed = tab.ask("document.querySelectorAll('figure[data-chart]').length")
    assert framed == tab.ask("document.querySelectorAll('.plot').length")
    assert tab.ask("document.documentElement.scrollWidth") <= 390


def test_a_campaign_s_page_opens_without_complaint_and_fits_a_narrow_screen(tab: Page, tmp_path: Path) -> None:
    (tmp_path / "campaign.html").write_text(campaign_page(campaign(tmp_path)), encoding="utf-8")
    tab.console.clear()
    tab.open(tmp_path / "campaign.html", width=390)
    assert tab.console == []
    assert tab.ask("document.documentElement.scrollWidth") <= 390
    assert tab.ask("document.querySelectorAll('svg.chart circle').length") == 9
    assert tab.ask("document.querySelector('table a').getAttribute('href')") == "A/report.html"


def test_a_campaign_s_tables_sort_by_any_column_and_leave_out_tests(tab: Page, tmp_path: Path) -> None:
    made = campaign(tmp_path)
    impulses = {"A": 900.0, "B": 11000.0, "C": 2000.0}
    rows = {
        test: row.but(performance={"total_impulse": Quantity(impulses[test], "N s", 10.0)}) if test in impulses else row
        for test, row in made.tests.items()
    }
    (tmp_path / "campaign.html").write_text(campaign_page(made.but(tests=rows)), encoding="utf-8")
    tab.console.clear()
    tab.open(tmp_path / "campaign.html")
    left = "[...document.querySelectorAll('#tests tbody tr')].filter((row) => !row.hidden)"
    names = f"{left}.map((row) => row.cells[0].textContent)"
    heads = "[...document.querySelectorAll('#tests th .sort')]"
    by_impulse = f"{heads}.find((head) => head.textContent === 'total impulse').click()"
    tab.ask(by_impulse)
    assert tab.ask(names) == ["A", "C", "B", "D"]
    tab.ask(by_impulse)
    assert tab.ask(names) == ["B", "C", "A", "D"]  # what has no number comes last in either direction
    assert tab.ask("document.querySelector('#tests th[aria-sort]').textContent") == "total impulse"
    tab.ask("(() => { const f = document.querySelector('.filter input'); f.value = 'heat'; "
            "f.dispatchEvent(new Event('input')); })()")  # fmt: skip
    assert tab.ask(names) == ["B", "A"]
    assert tab.ask("document.querySelector('.filter output').textContent") == "2 of 4"
    shown = "[...document.querySelectorAll('.stand table.sorts tbody tr')].filter((row) => !row.hidden)"
    assert set(tab.ask(f"{shown}.map((row) => row.cells[0].textContent)")) == {"A", "B"}
    assert tab.console == []


def test_an_engine_s_page_opens_without_complaint_and_reads_what_lies_along_its_axes(tab: Page, tmp_path: Path) -> None:
    assert hfa("simulate", ENGINE, "--out", tmp_path, "--quiet").status == 0
    tab.console.clear()
    tab.requests.clear()
    tab.forget()
    tab.open(tmp_path / "maelstrom.html")
    assert tab.console == []
    assert {url for url in tab.requests if not url.startswith("data:")} == {(tmp_path / "maelstrom.html").as_uri()}
    tab.ask("document.querySelectorAll('details.fold').forEach((fold) => { fold.open = true; })")
    said = {}
    for chart in ("thrust", "thrust_flow_length", "specific_impulse_mixture"):
        left, top, width, height = tab.show(f'[data-chart="{chart}"] .plot')
        tab.mouse("mouseMoved", left + 0.4 * width, top + 0.5 * height)
        tab.settle()
        said[chart] = str(tab.ask(f"document.querySelector('[data-chart=\"{chart}\"] .instant').textContent"))
    assert re.fullmatch(r"t = [\d.]+ s", said["thrust"])
    assert re.fullmatch(r"oxidizer flow = [\d.]+ kg/s", said["thrust_flow_length"])
    assert re.fullmatch(r"O/F = [\d.]+", said["specific_impulse_mixture"])
    tab.open(tmp_path / "maelstrom.html", width=390)
    assert tab.ask("document.documentElement.scrollWidth") <= 390


def test_two_tests_share_one_page(tab: Page, tmp_path: Path) -> None:
    made = material(tmp_path)
    (tmp_path / "compare.html").write_text(compare(made, made), encoding="utf-8")
    tab.console.clear()
    tab.open(tmp_path / "compare.html")
    assert tab.console == []
    left, top, width, height = tab.show('[data-chart="pressures-0"] .plot')
    tab.mouse("mouseMoved", left + 0.4 * width, top + 0.5 * height)
    tab.settle()
    one, other = read_out(tab, '[data-chart="pressures-0"]')
    assert one == other != ""


def test_the_page_looks_like_a_page(opened: Page, tmp_path: Path) -> None:
    """A picture with one dominating ground color and dark text on it."""
    shot = Image.open(opened.picture(tmp_path / "page.png")).convert("L")
    histogram, pixels = shot.histogram(), shot.width * shot.height
    assert max(histogram) > 0.3 * pixels
    assert sum(histogram[:90]) > 0.005 * pixels


def test_the_command_prints_the_page(tab: Page, path: Path, tmp_path: Path) -> None:
    printed = print_page(path, tmp_path / "report.pdf")
    assert printed.read_bytes().startswith(b"%PDF")
    assert printed.stat().st_size > 50_000


def test_no_line_goes_across_a_hole_of_the_log(tab: Page, tmp_path: Path) -> None:
    made = material(tmp_path)
    start, end = 1.5, 4.0

    def without_rows(channel: Channel) -> Channel:
        seconds = channel.time - made.opening
        kept = (seconds <= start) | (seconds >= end)
        parts = {name: getattr(channel, name)[kept] for name in ("time", "values", "flags")}
        return replace(channel, **parts, raw=None if channel.raw is None else channel.raw[kept])

    channels = {name: without_rows(channel) for name, channel in made.log.channels.items()}
    holed = replace(made, log=replace(made.log, channels=channels))
    (tmp_path / "report.html").write_text(page(holed), encoding="utf-8")
    tab.forget()
    opened = tab.open(tmp_path / "report.html")
    seen, middle = ticks(opened), 0.5 * (start + end)
    crossing = opened.ask(
        f"""(() => {{
            const at = [...document.querySelectorAll('{PRESSURES} .x-tick')].map((tick) => +tick.getAttribute('x'));
            const [low, high] = [{seen[0]}, {seen[-1]}];
            const x = at[0] + ({middle} - low) / (high - low) * (at[at.length - 1] - at[0]);
            const paths = [...document.querySelectorAll('{PRESSURES} path.line')].map((p) => p.getAttribute('d'));
            const runs = paths.flatMap((d) => d.split('M').filter(Boolean));
            const spans = runs.map((run) => run.split('L').map((point) => parseFloat(point)));
            return [paths.length, spans.filter((s) => Math.min(...s) < x && Math.max(...s) > x).length];
        }})()"""
    )
    assert crossing[0] > 1
    assert crossing[1] == 0
