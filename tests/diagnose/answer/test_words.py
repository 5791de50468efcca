"""What a diagnosis says in sentences."""

from __future__ import annotations

from typing import Any

import pytest
from tests.diagnose.answer.test_verdict import eroded, probable
from tests.inference import made
from tests.products.filled import filled

from hfanalysis.diagnose.answer.plausible import judged, size_of
from hfanalysis.diagnose.answer.source_places import places
from hfanalysis.diagnose.answer.verdict import effects_product, verdict_of
from hfanalysis.diagnose.answer.where import by_equation
from hfanalysis.diagnose.answer.words import (
    _LACKING,
    _NAMED_PLACES,
    _part_of,
    effect_sentences,
    equation_sentence,
    gap_line,
    headline,
    place_sentence,
    poor_fit_sentence,
    proof_sentences,
    story,
)
from hfanalysis.diagnose.diagnosis import plain_names
from hfanalysis.effects import effect, library
from hfanalysis.products.diagnosis import ClosedFraction, Diagnosis
from hfanalysis.quantity import Quantity


def product(label: str, **more: Any) -> Diagnosis:
    """A small product of a verdict."""
    gains = {
        "none": (("nozzle_throat_erosion", -20.0),),
        "named": (("nozzle_throat_erosion", 20.0),),
        "ambiguous": (("nozzle_throat_erosion", 20.0), ("load_cell_drift", 19.8)),
    }
    found = eroded() if label == "unknown" else probable(*gains[label])
    verdict = verdict_of(found)
    fractions = {"same": 0.98, "held_out": 0.9, "other_test": None, "placebo": 0.1}
    rms = {name: 2.0 * size for name, size in made.NOISE.items()}
    given = {
        "verdict": label,
        "partners": {},
        "by_equation": by_equation(verdict.posterior, found),
        "posterior": {"unknown": 0.97, "none": 0.03} if label == "unknown" else verdict.posterior,
        "set90": ["unknown"] if label == "unknown" else verdict.set90,
        "effects": effects_product(verdict, eroded().bench.observed) if label in ("named", "ambiguous") else [],
        "localisation": places(verdict, found) if label != "none" else [],
        "compared": {"chi_square": 0.9},
        "leftover": 0.9,
        "gap": {"before": rms, "after": made.NOISE, "noise": made.NOISE, "closed_fraction": fractions},
        "not_it": ["tank_heat"],
        "decisive_measurements": [] if label == "none" else ["throat that erodes: the throat's diameter"],
        "called": plain_names(library()),
        **more,
    }
    return filled(Diagnosis, given)


@pytest.mark.parametrize("label", ["none", "named", "ambiguous", "unknown"])
def test_every_verdict_is_said_in_sentences(label: str) -> None:
    given = product(label)
    said, probability = story(given), given.posterior.get("nozzle_throat_erosion", 0.0)
    assert all(line.endswith(".") and "None" not in line and "nan" not in line for line in said)
    expected = {
        "none": "Nothing is missing",
        "named": f"Missing from the model, with probability: throat that erodes ({probability:.2f})",
        "ambiguous": "cannot be excluded",
        "unknown": "Something is missing that has no name in the library (probability 0.97)",
    }
    assert expected[label] in " ".join(said[:2])
    assert (len(said) == 1) == (label == "none")
    assert not any("_" in line for line in said)
    assert all(len(sentence.split()) <= 25 for line in said for sentence in line.split(". "))
    if label == "unknown":
        assert "It is not heat into the tank." in said


def test_what_is_likelier_than_none_is_said_where_nothing_is_claimed() -> None:
    odds = {"none": 0.1, "unknown": 0.7, "tank_heat": 0.2}
    stated = product("none", posterior=odds, set90=["unknown", "tank_heat"])
    assert headline(stated).startswith("Nothing is claimed to be missing")
    assert "Something without a name (0.70) is more probable" in headline(stated)
    assert headline(stated.but(posterior={**odds, "none": 0.6})).startswith("Nothing is missing from the model")


def test_more_than_noise_is_told_where_nothing_explains_it() -> None:
    restless = product("none", compared={"chi_square": 2.2})
    before = {**restless.gap.before, "thrust": 9.0 * made.NOISE["thrust"]}
    said = story(restless.but(gap=restless.gap.but(before=before)))
    assert len(said) == 3
    assert "chi-square 2.2 per observation, most of it in thrust" in said[1]
    assert all("chi-square" not in line for line in story(product("named", compared={"chi_square": 2.2})))


def test_sentences_give_sizes_in_the_units_of_engineers() -> None:
    row = places(verdict_of(eroded()), eroded())[0]
    assert " N more thrust" in place_sentence(row) or " N less thrust" in place_sentence(row)
    heat = row.but(equation="tank_energy", source=Quantity(900.0, "W", 150.0))
    assert "0.90 ± 0.15 kW of heat enters the tank that the model does not have" in place_sentence(heat)
    colder = heat.but(source=Quantity(-900.0, "W", 150.0))
    assert "0.90 ± 0.15 kW of heat leaves the tank" in place_sentence(colder)
    assert "thrust reads" in place_sentence(row.but(channel="thrust"))
    ends = row.t_end.value or 0.0
    assert place_sentence(row, ends).startswith(f"From {row.t_start.value:.1f} s on")
    assert f"to {ends:.1f} s" in place_sentence(row, 2.0 * ends)
    assert place_sentence(row.but(beside=True)).endswith("still open.")
    assert gap_line("thrust", product("named").gap) == "Thrust misfit: 10 N refitted, 5 N with the effects; noise 5 N."
    assert proof_sentences(product("named"))[0] == "98 % of the misfit goes on the data that named it."
    assert proof_sentences(filled(Diagnosis, {})) == []


@pytest.mark.parametrize(
    ("same", "said"),
    [(-0.04, "The misfit that is left is another one."), (None, "No channel is off by more than its noise.")],
)
def test_an_effect_that_closes_next_to_nothing_is_explained(same: float | None, said: str) -> None:
    found = product("named")
    found = found.but(gap=found.gap.but(closed_fraction=filled(ClosedFraction, {"same": same})))
    assert proof_sentences(found)[-2] == said
    assert proof_sentences(found)[-1].startswith("What names the effect is smaller than the noise")
    assert proof_sentences(found.but(effects=())) == proof_sentences(found)[:-2]


@pytest.mark.parametrize(("seconds", "said"), [(0.06, True), (0.012, False)])
def test_a_fire_that_dies_slowly_is_said_beside_what_an_empty_chamber_takes(seconds: float, said: bool) -> None:
    compared = {
        "chi_square": 0.9,
        "fuel_fade": Quantity(seconds, "s", 0.35 * seconds),
        "abrupt_end": Quantity(0.011, "s"),
    }
    text = " ".join(story(product("named", compared=compared)))
    assert ("fall within 60 ms. A chamber of this volume empties within 11 ms." in text) == said


def test_an_impossible_size_is_said() -> None:
    row = effects_product(verdict_of(eroded()), eroded().bench.observed)[0]
    given = product("named")
    said = " ".join(effect_sentences(row, given))
    assert "Its size is plausible: rate " in said
    assert "(limit 0.4 mm/s)." in said
    unlikely = row.but(plausibility=judged(size_of(effect("nozzle_throat_erosion").at(rate=2e-3))))
    said = " ".join(effect_sentences(unlikely, given))
    assert "hard to believe" in said
    assert "2 mm/s is beyond 0.4 mm/s" in said


def test_the_headline_is_of_the_most_probable() -> None:
    assert "throat that erodes" in headline(product("named"))


def test_names_that_an_unknown_does_not_exclude_are_in_the_headline() -> None:
    odds = {"unknown": 0.7, "tank_heat": 0.25, "none": 0.05}
    said = headline(product("unknown", posterior=odds, set90=["unknown", "tank_heat"]))
    assert said.endswith("(probability 0.70). Heat into the tank (0.25) cannot be excluded.")


def test_a_gap_that_a_wrong_effect_closes_as_well_proves_nothing() -> None:
    gap = product("named").gap
    arms = ClosedFraction(same=0.9, held_out=0.8, other_test=None, placebo=None)
    alike, wider = (gap.but(closed_fraction=arms.but(placebo=placebo)) for placebo in (0.85, -0.16))
    said = " ".join(proof_sentences(product("named", gap=alike)))
    assert "The best wrong effect takes away 85 %." in said
    assert "proves nothing here" in said
    said = " ".join(proof_sentences(product("named", gap=wider)))
    assert "The best wrong effect adds 16 % to it." in said
    assert "proves nothing" not in said


@pytest.mark.parametrize(
    ("verdict", "names", "by_equation", "said"),
    [
        ("ambiguous", (0.5, 0.45), 0.95, ["Whatever its name, it is in the gas's energy (0.95)."]),
        ("ambiguous", (0.5, 0.3), 0.8, []),  # it may be elsewhere
        ("ambiguous", (0.95, 0.03), 0.98, []),  # the name says it
        ("named", (0.5, 0.45), 0.95, []),
    ],
)
def test_where_names_leave_a_choice_the_equation_may_be_sure(
    verdict: str, names: tuple[float, float], by_equation: float, said: list[str]
) -> None:
    posterior = dict(zip(("combustion_efficiency", "chamber_heat_loss"), names, strict=True))
    given = {"verdict": verdict, "posterior": posterior, "by_equation": {"chamber_energy": by_equation, "grain": 0.01}}
    assert equation_sentence(filled(Diagnosis, given)) == said


def test_it_is_said_that_no_model_comes_near_a_test_and_which_comes_nearest() -> None:
    rows = [(["n2_purge"], False, 80.0), (["n2_purge", "tank_heat"], False, 90.0), (["offset of p_tank"], True, 95.0)]
    tried = [{"names": names, "unknown": strange, "log_evidence": gain} for names, strange, gain in rows]
    assert poor_fit_sentence(filled(Diagnosis, {"leftover": 2.0, "tried": tried})) == []
    said = poor_fit_sentence(filled(Diagnosis, {"leftover": 18.76, "tried": tried}))
    assert "The best with names (n2 purge and tank heat) leaves a chi-square of 18.8 per observation." in said
    bare = poor_fit_sentence(filled(Diagnosis, {"leftover": 18.76, "tried": tried[2:]}))
    assert "The best with names leaves a chi-square of 18.8 per observation." in bare


@pytest.mark.parametrize("forms", [*_LACKING.values(), *_NAMED_PLACES.values()])
def test_what_a_source_says_names_what_it_is_of_on_either_side(forms: tuple[str, str]) -> None:
    """Each stands in a sentence of its own: nothing before it says what "it" is."""
    for form in forms:
        assert form.count("{size}") == 1
        assert not form.startswith(("it ", "It "))


@pytest.mark.parametrize(
    ("part", "words"),
    [
        (0.0043, "0.43 % of"),
        (0.15, "15 % of"),
        (0.99, "99 % of"),
        (0.997, "all of"),
        (3.61, "3.6 times"),
        (140.0, "140 times"),
    ],
)
def test_a_part_is_said_in_figures_that_are_read(part: float, words: str) -> None:
    assert _part_of(part) == words
