"""What people read on a page: short sentences, no name of code, and no more words than a screen or two hold."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.report.diagnosed import DIAGNOSIS, NOTHING
from tests.report.prose import Prose
from tests.report.sample import HEALTH, SEGMENTS, material, saying, without

from hfanalysis.report.material import Material
from hfanalysis.report.page import page
from hfanalysis.wording.plain import in_plain, sentences_of


def cases(folder: Path) -> dict[str, Material]:
    """Pages of many kinds: all there is, nothing missing, an unknown, sensors that look wrong, and next to nothing."""
    made = material(folder)
    names = ("segments", "calibration", "validation", "residuals", "performance", "diagnosis", "flight")
    odds = {"unknown": 0.9, "tank_heat": 0.1, "none": 0.0}
    unknown = {**DIAGNOSIS, "verdict": "unknown", "effects": [], "set90": ["unknown"], "posterior": odds}
    return {
        "whole": made,
        "nothing missing": saying(made, diagnosis=NOTHING),
        "unknown": saying(made, diagnosis=unknown),
        "doubted": saying(made, health=HEALTH),
        "misfire": saying(made, segments={**SEGMENTS, "misfire": True}),
        "bare": without(made, **dict.fromkeys(names, "the valve's opening was not found")),
    }


@pytest.mark.parametrize("name", ["whole", "nothing missing", "unknown", "doubted", "misfire", "bare"])
def test_sentences_are_short_and_hold_no_name_of_code(name: str, tmp_path: Path) -> None:
    found = Prose(page(cases(tmp_path)[name]))
    assert found.long == []
    assert found.code_names == set()
    assert len(found.sentences) > 20


def test_the_prose_that_is_judged_is_what_people_read() -> None:
    text = (
        "<p>One two. Of p_tank three.</p><details><summary>four</summary><p>five</p></details>"
        "<figure><figcaption>six</figcaption></figure><code>p_run</code>"
    )
    found = Prose(text)
    assert found.sentences == ["One two.", "Of p_tank three.", "four", "five", "six"]
    assert found.code_names == {"p_tank"}
    assert (found.words, found.figures) == (6, 1)
    assert Prose(f"<p>{'word ' * 26}</p>").long == [("word " * 26).strip()]


def test_a_page_opens_with_few_words_and_pictures(tmp_path: Path) -> None:
    found = Prose(page(material(tmp_path)))
    assert found.words <= 1550
    assert found.figures <= 16


def test_a_long_sentence_is_cut_where_it_has_parts_and_symbols_stay() -> None:
    words = "p_tank " + "falls " * 15 + "(fast; as told); m " + "is " * 12 + "low, and the rest is high"
    said = in_plain(words, {"p_tank": "tank pressure"})
    assert said == "tank pressure " + "falls " * 15 + "(fast; as told). m " + "is " * 12 + "low, and the rest is high"
    assert len(sentences_of(said)) == 2
    assert in_plain("[channels.p_tank] is 'p_tank'", {"p_tank": "tank pressure"}) == "[channels.p_tank] is 'p_tank'"
