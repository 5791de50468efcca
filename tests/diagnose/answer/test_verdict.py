"""Probabilities, plausible sizes, the proof, and what is said of them."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from tests.diagnose.naming.test_naming import catalogue
from tests.engine.stand import engine_on_stand
from tests.inference import made

from hfanalysis.diagnose.answer import posterior
from hfanalysis.diagnose.answer import verdict as verdict_module
from hfanalysis.diagnose.answer.effect_source import Acting, acting
from hfanalysis.diagnose.answer.plausible import MOST_LOST, judged, size_of
from hfanalysis.diagnose.answer.posterior import (
    ABOVE_CHANCE,
    BEFORE,
    LEAST_EVIDENCE,
    POOR_FIT,
    SET,
    UNSEEN,
    EvidenceScale,
    above_chance,
    evidences_of,
    kind,
    poor_fit,
    scale,
    smallest_set,
)
from hfanalysis.diagnose.answer.proof import OtherTest, Proof, prove
from hfanalysis.diagnose.answer.source_places import likeliest_place, of_acting, places
from hfanalysis.diagnose.answer.standing import COURSE, LAW_ERROR
from hfanalysis.diagnose.answer.verdict import _claimed, _within, effects_product, verdict_of
from hfanalysis.diagnose.answer.where import by_equation, elsewhere, likeliest_of
from hfanalysis.diagnose.answer.words import place_sentence
from hfanalysis.diagnose.diagnosis import LIKELY, _decisive, _not_it
from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.diagnose.naming.naming import Naming, name_effects
from hfanalysis.diagnose.naming.variants import VARIANTS, settings_of
from hfanalysis.effects import effect, library
from hfanalysis.engine.effect import Active, Believable
from hfanalysis.errors import InputError
from hfanalysis.inference import gap
from hfanalysis.inference.candidate import Bench, Candidate
from hfanalysis.inference.fitting.fit import Fit, fit
from hfanalysis.inference.places import PLACES
from hfanalysis.inference.splines import Splines
from hfanalysis.inference.unknowns.smooth_source import SmoothSource, sensor_place

labels = some.dictionaries(
    some.sampled_from(("none", "unknown", "tank_heat", "load_cell_drift", "n2_purge")),
    some.floats(-500.0, 500.0),
    min_size=1,
)
EROSION = effect("nozzle_throat_erosion").at(rate=2e-4)


@cache
def eroded() -> Naming:
    tried = catalogue(("load_cell_drift", "nozzle_throat_erosion"))
    return name_effects(made.hypothesis(), made.observed(EROSION), tried)


@given(labels, some.floats(0.5, 20.0), some.floats(0.0, 5.0), some.floats(0.0, POOR_FIT))
def test_probabilities_sum_to_one(evidences: dict[str, float], t: float, more: float, leftover: float) -> None:
    found = EvidenceScale(t, more).probabilities(evidences, leftover)
    assert set(found) == set(evidences)
    assert sum(found.values()) == pytest.approx(1.0)
    little = "none" in evidences and not above_chance(evidences)
    order = sorted((k for k in evidences if k != "unknown" or not little), key=lambda k: evidences[k])
    assert all(found[a] <= found[b] for a, b in pairwise(order))
    assert not little or found.get("unknown", 0.0) <= found["none"]


@given(labels)
def test_the_set_is_the_smallest_that_holds_nine_tenths(evidences: dict[str, float]) -> None:
    found = EvidenceScale().probabilities(evidences, 1.0)
    names = smallest_set(found)
    assert sum(found[n] for n in names) >= SET - 1e-12
    assert sum(found[n] for n in names[:-1]) < SET
    assert min(found[n] for n in names) >= max((p for n, p in found.items() if n not in names), default=0.0)


def test_a_temperature_takes_evidences_less_seriously() -> None:
    evidences = {"none": 0.0, "tank_heat": 10.0}
    cold, warm = (EvidenceScale(t).probabilities(evidences, 1.0) for t in (1.0, 5.0))
    assert cold["tank_heat"] == pytest.approx(1.0 / (1.0 + np.exp(-10.0)))
    assert warm["tank_heat"] == pytest.approx(1.0 / (1.0 + np.exp(-2.0)))
    left = EvidenceScale(1.0, 4.0)
    assert left.probabilities(evidences, 0.8) == cold
    assert left.probabilities(evidences, 2.0) == warm


@given(some.floats(-20.0, 5000.0), some.floats(-20.0, 5000.0), some.floats(POOR_FIT, 100.0))
def test_of_a_test_that_no_model_comes_near_names_keep_a_share(name: float, strange: float, leftover: float) -> None:
    evidences = {"none": 0.0, "tank_heat": name, "unknown": strange}
    near, far = (EvidenceScale().probabilities(evidences, left) for left in (1.0, leftover))
    assert sum(far.values()) == pytest.approx(1.0)
    for label in ("none", "tank_heat"):
        assert far[label] == pytest.approx(near[label] * POOR_FIT / leftover)
    assert far["unknown"] >= 1.0 - POOR_FIT / leftover


def test_far_from_all_models_a_name_is_claimed_only_where_no_source_is_found() -> None:
    stated = EvidenceScale().probabilities({"none": 0.0, "tank_heat": 8000.0, "unknown": 4000.0}, 19.0)
    assert _claimed(stated, {"none": 0.0, "tank_heat": 8000.0, "unknown": 4000.0}, poor_fit(19.0)) == "unknown"
    assert _claimed(stated, {"none": 0.0, "tank_heat": 8000.0, "unknown": -5.0}, poor_fit(19.0)) == "tank_heat"
    assert _claimed(stated, {"none": 0.0, "tank_heat": 8.0, "unknown": -5.0}, poor_fit(19.0)) == "none"
    assert _claimed(stated, {"none": 0.0, "tank_heat": 8000.0, "unknown": -5.0}) == "none"


def test_where_evidence_misleads_nothing_is_certain() -> None:
    evidences = {"none": 0.0, "tank_heat": 400.0, "n2_purge": 3.0, "unknown": -5.0}
    found = EvidenceScale(misled=0.1).probabilities(evidences, 1.0)
    assert sum(found.values()) == pytest.approx(1.0)
    assert found["none"] == pytest.approx(0.1 * BEFORE["none"])
    assert found["n2_purge"] == pytest.approx(0.1 * BEFORE["named"] / 2.0)
    assert found["tank_heat"] == pytest.approx(0.9 + 0.1 * BEFORE["named"] / 2.0)


@pytest.mark.parametrize("evidence", [LEAST_EVIDENCE - 0.01, LEAST_EVIDENCE])
def test_faint_evidence_misleads_in_a_share_of_its_own(evidence: float) -> None:
    evidences = {"none": 0.0, "tank_heat": evidence, "unknown": -5.0}
    found = EvidenceScale(misled=0.01, misled_faint=0.2).probabilities(evidences, 1.0)
    share = 0.2 if evidence < LEAST_EVIDENCE else 0.01
    assert sum(found.values()) == pytest.approx(1.0)
    assert found["none"] == pytest.approx(share * BEFORE["none"], abs=2e-4)


def test_effects_that_were_not_tried_are_less_probable_than_those_that_were() -> None:
    found = eroded()
    evidences = evidences_of(replace(found, equations={**found.equations, "tank_heat": "tank_energy"}, unknown=()))
    assert evidences["tank_heat"] == evidences["unknown"]
    assert evidences["tank_heat"] <= min(UNSEEN, min(evidences.values()))


def test_an_offset_of_a_kind_shifts_its_odds() -> None:
    shifted = EvidenceScale(offsets={"none": 2.0, "named": 0.0, "unknown": 0.0}).probabilities(
        {"none": 0.0, "n2_purge": 2.0}, 1
    )
    assert shifted["none"] == pytest.approx(0.5)
    assert [kind(label) for label in ("none", "unknown", "n2_purge")] == ["none", "unknown", "named"]


def test_what_was_not_seen_is_as_good_as_none_but_for_its_own_offset() -> None:
    offsets = {"none": 0.0, "named": 1.0, "unknown": 0.0, "unseen named": -3.0}
    seen = {"none": 0.0, "n2_purge": 4.0, "tank_heat": UNSEEN, "fuel_sliver": UNSEEN - 20.0}
    found = EvidenceScale(temperature=2.0, offsets=offsets).probabilities(seen, 1.0)
    assert found["tank_heat"] == found["fuel_sliver"] == pytest.approx(found["none"] * np.exp(-3.0))
    assert found["n2_purge"] == pytest.approx(found["none"] * np.exp(1.0 + 4.0 / 2.0))
    without = EvidenceScale(temperature=2.0, offsets={"none": 0.0, "named": 1.0, "unknown": 0.0}).probabilities(
        seen, 1.0
    )
    assert without["fuel_sliver"] < without["tank_heat"]


def test_unknown_has_to_explain_more_than_closures_get_wrong() -> None:
    offsets = {"none": 0.0, "named": 0.0, "unknown": -1.0}

    def odds(name: float, unknown: float) -> float:
        evidences = {"none": 0.0, "tank_heat": name, "unknown": unknown}
        found = EvidenceScale(2.0, offsets=offsets, unexplained=0.5).probabilities(evidences, 1.0)
        return float(np.log(found["unknown"] / found["tank_heat"]))

    assert odds(64.0, 67.0) == pytest.approx(-1.0 + (3.0 - 4.0) / 2.0)
    assert odds(256.0, 259.0) == pytest.approx(-1.0 + (3.0 - 8.0) / 2.0)
    assert odds(0.0, 10.0) == pytest.approx(-1.0 + 10.0 / 2.0)
    assert odds(-3.0, 10.0) == pytest.approx(-1.0 + 13.0 / 2.0)  # a name that explains nothing leaves nothing


def test_a_source_in_another_equation_is_nothing_that_a_closure_gets_wrong() -> None:
    evidences = {"none": 0.0, "injector_two_phase": 100.0, "unknown": 108.0}

    def odds(apart: float | None) -> float:
        found = EvidenceScale(2.0, unexplained=1.0).probabilities(evidences, 1.0, apart)
        return float(np.log(found["unknown"] / found["injector_two_phase"]))

    assert odds(None) == pytest.approx((8.0 - 10.0) / 2.0)
    assert odds(90.0) == odds(None)  # one at the same place explains more, even so
    assert odds(103.0) == pytest.approx(3.0 / 2.0)
    assert odds(108.0) == pytest.approx(8.0 / 2.0)


def test_where_nothing_is_seen_unknown_is_not_more_probable_than_none() -> None:
    """Else a verdict of none would stand beside a probability of nine tenths for unknown."""

    def odds(unknown: float, name: float = 1.0, offset: float = 0.0) -> float:
        offsets = {"none": 0.0, "named": 0.0, "unknown": offset}
        found = EvidenceScale(offsets=offsets).probabilities({"none": 0.0, "tank_heat": name, "unknown": unknown}, 1.0)
        return float(np.log(found["unknown"] / found["none"]))

    least = ABOVE_CHANCE["unknown"]
    assert odds(least - 0.1) == pytest.approx(0.0)
    assert odds(least) == pytest.approx(least)
    assert odds(6.0, name=ABOVE_CHANCE["named"]) == pytest.approx(6.0)  # something is there
    assert odds(6.0, offset=-8.0) == pytest.approx(-2.0)  # what is less probable anyhow stays as it is


@pytest.fixture
def stored(monkeypatch: pytest.MonkeyPatch, tmp_path):  # type: ignore[no-untyped-def]
    """A folder in place of the package's, whose probabilities.json a test may write."""
    monkeypatch.setattr(posterior, "files", lambda name: tmp_path)
    scale.cache_clear()
    yield tmp_path
    scale.cache_clear()


def test_without_constants_evidences_are_taken_as_they_are(stored) -> None:  # type: ignore[no-untyped-def]
    assert scale() == EvidenceScale()


def test_constants_are_read_from_their_file(stored) -> None:  # type: ignore[no-untyped-def]
    offsets = {"none": 1.0, "named": 0.0, "unknown": -1.0}
    text = json.dumps({"temperature": 3.0, "temperature_per_leftover": 0.2, "offsets": offsets, "cases": 9})
    (stored / "probabilities.json").write_text(text, encoding="utf-8")
    assert scale() == EvidenceScale(3.0, 0.2, offsets)


def test_none_is_the_zero_of_evidence_and_a_set_counts_for_its_first_name() -> None:
    found = eroded()
    evidences = evidences_of(found)
    assert evidences["none"] == 0.0
    single = found.singles[0]
    pair = replace(single, names=("nozzle_throat_erosion", "tank_heat"), log_evidence=single.log_evidence + 7.0)
    with_set = evidences_of(replace(found, sets=(pair,)))
    assert with_set["nozzle_throat_erosion"] == pytest.approx(evidences["nozzle_throat_erosion"] + 7.0)
    assert "tank_heat" not in with_set


def of_size(name: str, size: float) -> Active:
    """An effect of the library, its believable strength that many times the largest believable one."""
    known = effect(name)
    assert known.believable is not None
    return known.at(**{known.believable.parameter: size * known.believable.most})


def test_a_size_beyond_belief_costs_evidence() -> None:
    for name in library():
        typical, huge = of_size(name, 0.9), of_size(name, 5.0)
        assert size_of(typical).lost == 0.0, name
        assert 1.0 < size_of(huge).lost <= MOST_LOST, name
        assert size_of(of_size(name, -5.0)).lost == size_of(huge).lost, name
        assert judged(size_of(huge)).plausible is False, name
        assert judged(size_of(typical)).plausible is True, name
    assert size_of(effect("tank_heat").at(power=1e9)).lost == MOST_LOST


def test_an_effect_of_a_team_is_judged_by_what_it_says_itself() -> None:
    silent = replace(effect("tank_heat"), name="of_a_team", believable=None).at(power=1e9)
    assert size_of(silent) is None
    assert judged(size_of(silent)).plausible is None
    spoken = replace(effect("tank_heat"), name="of_a_team", believable=Believable("power", 500.0, "no pump", "W"))
    assert judged(size_of(spoken.at(power=600.0))).why == "power 600 W is beyond 500 W. No pump"


def test_what_is_believable_is_of_a_strength_and_every_effect_has_a_plain_name() -> None:
    for name, known in library().items():
        assert known.believable is not None, name
        assert known.believable.parameter in [p.name for p in known.parameters[: known.strengths]], name
        assert known.plain_name, name
        assert "_" not in known.plain_name, name


def test_an_impossible_size_makes_a_name_less_probable() -> None:
    """Throat erosion of a millimeter a second, and the same evidence."""
    found = eroded()
    single = found.singles[0]
    engine = single.fit.burnt.steps.engine
    worn = replace(engine, effects=(effect("nozzle_throat_erosion").at(rate=1.2e-3),))
    burnt = replace(single.fit.burnt, steps=replace(single.fit.burnt.steps, engine=worn))
    large = replace(single, fit=replace(single.fit, burnt=burnt))
    odds = [verdict_of(replace(found, singles=(c,))).evidences["nozzle_throat_erosion"] for c in (single, large)]
    assert odds[0] - odds[1] == pytest.approx(size_of(effect("nozzle_throat_erosion").at(rate=1.2e-3)).lost)


def unnamed(place: str, fitted: Fit, evidence: float) -> Candidate:
    """An unknown source somewhere, which explains so much."""
    sensors = [sensor_place(made.observed(), name) for name in made.NOISE]
    at = next(p for p in (*PLACES, *sensors) if p.name == place)
    nothing = np.zeros(4)
    source = SmoothSource(at, 0.0, np.zeros(fitted.x.size), at.typical, 1.5, nothing, Splines.over(0.0, 1.0, 1.0))
    return Candidate((place,), fitted, evidence, source=source)


def probable(*gains: tuple[str, float]) -> Naming:
    """A naming in which these names have such log evidences beyond none."""
    found, single = eroded(), eroded().singles[0]
    base = found.base.log_evidence
    singles = tuple(replace(single, names=(n,), log_evidence=base + g) for n, g in gains if n != "unknown")
    strange = tuple(unnamed("tank_leak", single.fit, base + g) for n, g in gains if n == "unknown")
    equations = found.equations | {n: effect(n).equation for n, _ in gains if n != "unknown"}
    return replace(found, singles=singles, sets=(), unknown=strange, equations=equations)


@pytest.mark.parametrize(
    ("gains", "label"),
    [
        ((("tank_heat", 20.0), ("n2_purge", 3.0)), "named"),
        ((("tank_heat", 20.0), ("n2_purge", 19.5)), "ambiguous"),
        ((("tank_heat", -20.0),), "none"),
        ((("tank_heat", 20.0), ("unknown", 30.0)), "unknown"),
        ((("tank_heat", 9.2),), "named"),
        ((("tank_heat", 8.8),), "none"),
        ((("unknown", 9.8),), "none"),
        ((("unknown", 9.2), ("tank_heat", 5.2)), "unknown"),
        ((("unknown", 8.8), ("tank_heat", 5.2)), "none"),
        ((("unknown", 8.8), ("tank_heat", 9.2)), "ambiguous"),
        ((("unknown", 10.2),), "unknown"),
        ((("unknown", 10.2), ("tank_heat", 4.8)), "unknown"),
    ],
)
def test_the_verdict_follows_from_the_odds(gains, label: str, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr(verdict_module, "scale", EvidenceScale)  # evidences as they are
    verdict = verdict_of(probable(*gains))
    assert verdict.label == label
    assert sum(verdict.posterior.values()) == pytest.approx(1.0)
    if label == "none":
        assert verdict.chosen.names == ()
    if label == "named":
        assert verdict.chosen.names == (verdict.top,)


def test_what_is_too_little_for_a_claim_is_no_place_but_the_likeliest(monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr(verdict_module, "scale", EvidenceScale)
    found = probable(("nozzle_throat_erosion", 8.8))
    verdict = verdict_of(found)
    assert (verdict.label, verdict.chosen.names) == ("none", ())
    assert verdict.posterior["nozzle_throat_erosion"] > 0.9
    assert places(verdict, found) == ()
    place = likeliest_place(verdict, found, ["nozzle"])
    assert place is not None
    assert place.equation == "nozzle"


TIME = np.linspace(0.0, 10.0, 201)


@pytest.mark.parametrize(
    ("begins", "rises", "since"),
    [
        (4.0, 0.0, 3.8),  # all at once
        (3.0, 2.0, 3.1 - 0.2 - (4.8 - 3.1 - 0.2)),  # seen at 3.1 s, risen at 4.8 s
        (3.0, 6.5, 0.0),  # it may have begun with the fire
        (-1.0, 0.0, -0.2),
    ],
)
def test_what_rises_slowly_may_have_begun_before_it_is_seen(begins: float, rises: float, since: float) -> None:
    """By as much as it then takes to rise; what is there at once is not."""
    mean = np.clip((TIME - begins + 1e-6) / max(rises, 1e-6), 0.0, 1.0)
    source = Acting("grain", "kg/s", TIME, mean, np.full(TIME.size, 0.025), None)
    phases = {"liquid": 0.0, "end": 10.0}
    row = of_acting("regression_factor", source, 20.0, phases, blur=0.1)
    low, high = row.t_start.interval
    assert low == pytest.approx(since, abs=0.01)
    assert high == pytest.approx(row.t_start.value + 0.196, abs=1e-3)
    assert ("at the latest" in place_sentence(row)) == (rises > 0.0)
    known = of_acting("fuel_sliver", source, 20.0, phases).t_start
    assert known.interval == pytest.approx((known.value - 0.098, known.value + 0.098), abs=1e-3)


def strange(*sources: tuple[str, float]) -> Naming:
    """Throat erosion that explains 20 units, and unknown sources alone at these sites that explain so much."""
    found = probable(("nozzle_throat_erosion", 20.0))
    fit, base = found.singles[0].fit, found.base.log_evidence
    return replace(found, unknown=tuple(unnamed(place, fit, base + gain) for place, gain in sources))


@pytest.mark.parametrize(
    ("sources", "apart"),
    [
        ((("throat_factor", 23.0), ("feed_loss", 18.0)), 18.0),
        ((("feed_loss", 21.0), ("regression_factor", 22.0)), 22.0),
        ((("throat_factor", 23.0), ("thrust_factor", 22.0)), None),
        ((("offset of thrust", 25.0),), None),  # it may be the nozzle's
        ((("offset of p_tank", 25.0),), 25.0),
        ((), None),
    ],
)
def test_sources_elsewhere_are_those_in_no_equation_of_the_best_name(sources, apart: float | None) -> None:  # type: ignore[no-untyped-def]
    found = elsewhere(strange(*sources))
    assert found == (None if apart is None else pytest.approx(apart))


@pytest.mark.parametrize(
    ("equation", "site", "apart"),
    [
        ("tank_energy", "tank_leak", False),
        ("grain", "temperature_factor", False),
        ("chamber_mass", "regression_factor", False),
        ("injector", "feed_loss", True),
        ("tank_volume", "injector_factor", True),
    ],
)
def test_what_shows_in_the_same_pressure_is_not_elsewhere(equation: str, site: str, apart: bool) -> None:
    found = replace(strange((site, 22.0)), equations={"nozzle_throat_erosion": equation})
    assert (elsewhere(found) is not None) == apart


def test_without_a_pressure_between_them_feed_line_and_injector_are_one_place() -> None:
    found = replace(strange(("feed_loss", 22.0)), equations={"nozzle_throat_erosion": "injector"})
    observed = found.bench.observed
    channels = tuple(c for c in observed.channels if c.name != "p_run")
    without_line = replace(found, bench=Bench(replace(observed, channels=channels)))
    assert elsewhere(found) is not None
    assert elsewhere(without_line) is None


def test_a_source_beside_the_name_is_not_elsewhere() -> None:
    found = strange(("feed_loss", 30.0))
    beside = replace(found.unknown[0], names=("nozzle_throat_erosion", "feed_loss"))
    assert elsewhere(replace(found, unknown=(beside,))) is None


def test_an_equation_is_as_probable_as_its_names_together() -> None:
    found = replace(eroded(), equations=dict.fromkeys(("tank_heat", "tank_wall_heat_capacity"), "tank_energy"))
    found = replace(found, equations={**found.equations, "nozzle_throat_erosion": "nozzle"}, unknown=())
    stated = {"none": 0.1, "tank_heat": 0.3, "tank_wall_heat_capacity": 0.2, "nozzle_throat_erosion": 0.4}
    assert by_equation(stated, found) == pytest.approx({"tank_energy": 0.5, "nozzle": 0.4})
    assert list(by_equation(stated, found)) == ["tank_energy", "nozzle"]


def test_where_nothing_is_claimed_the_likeliest_place_is_told_all_the_same(monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr(verdict_module, "scale", EvidenceScale)
    for gain, there in ((3.0, True), (-1.0, False), (20.0, False)):
        found = probable(("nozzle_throat_erosion", gain))
        verdict = verdict_of(found)
        place = likeliest_place(verdict, found, by_equation(verdict.posterior, found))
        assert (place is not None) == there, gain
        if place is not None:
            assert (place.equation, place.phase) == ("nozzle", "liquid")
            assert place.significance == pytest.approx(gain)
            assert "history" not in place


def test_the_likeliest_place_is_in_the_likeliest_equation() -> None:
    found = probable(("nozzle_throat_erosion", 4.0), ("tank_heat", 3.5), ("tank_wall_heat_capacity", 3.4))
    found = replace(
        found,
        equations={"nozzle_throat_erosion": "nozzle"} | dict.fromkeys(("tank_heat", "tank_wall_heat_capacity"), "tank"),
    )
    evidences = evidences_of(found)
    stated = EvidenceScale().probabilities(evidences, 1.0)
    likeliest = likeliest_of(by_equation(stated, found), stated, evidences, found)
    assert likeliest is not None
    assert likeliest.names == ("tank_heat",)


def with_set(gain: float, further: str = "load_cell_drift") -> Naming:
    """Throat erosion, which explains 20 units, and a set with another effect, which explains so much more."""
    found = probable(("nozzle_throat_erosion", 20.0))
    names = ("nozzle_throat_erosion", further)
    both = replace(found.singles[0], names=names, log_evidence=found.named.log_evidence + gain)
    return replace(found, sets=(both,), equations=dict(found.equations) | {n: effect(n).equation for n in names})


@pytest.mark.parametrize(("gain", "claimed"), [(0.9, 1), (2.8, 1), (3.1, 2), (10.0, 2)])
def test_a_second_effect_is_claimed_where_one_does_not_explain_as_much(gain: float, claimed: int, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    """One alone has the probability 1 / (1 + e^(gain / warm)), by what an error of its law and of its course may
    explain, for a cell shows what the nozzle does; and 0.3 is enough."""
    warm = np.linalg.norm([1.0, LAW_ERROR * np.sqrt(20.0), COURSE * 20.0])
    monkeypatch.setattr(verdict_module, "scale", EvidenceScale)
    monkeypatch.setattr(posterior, "scale", EvidenceScale)
    verdict = verdict_of(with_set(gain))
    assert len(verdict.chosen.names) == claimed
    assert verdict.partners["load_cell_drift"] == pytest.approx(1.0 / (1.0 + np.exp(-gain / warm)), abs=1e-6)
    if claimed == 2:
        assert verdict.label == ("named" if gain > 2.2 * warm else "ambiguous")


def test_partners_that_explain_as_much_share_the_probability(monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr(verdict_module, "scale", EvidenceScale)
    monkeypatch.setattr(posterior, "scale", EvidenceScale)
    one, other = with_set(12.0), with_set(12.0, "chamber_tap_lag")
    both = dict(one.equations) | dict(other.equations)
    found = replace(one, sets=(*one.sets, *other.sets), equations=both)
    verdict = verdict_of(found)
    assert verdict.label == "ambiguous"
    assert verdict.partners == pytest.approx({"load_cell_drift": 0.5, "chamber_tap_lag": 0.5}, abs=1e-4)


def test_the_effect_is_given_with_its_size() -> None:
    row = effects_product(verdict_of(eroded()), eroded().bench.observed)[0]
    assert row.name == "nozzle_throat_erosion"
    rate = row.parameters["rate"]
    assert abs(rate.value - 2e-4) < 3.5 * rate.std
    assert rate.unit == "m/s"
    assert row.plausibility.plausible is True


@cache
def sibling(*effects) -> OtherTest:  # type: ignore[no-untyped-def]
    """Another test of the stand: less oxidizer, warmer."""
    engine = engine_on_stand(effects=effects, oxidizer_mass=7.6, temperature=296.0)
    mass = next(f for f in made.hypothesis().free if f.name == "oxidizer_mass")
    free = tuple(replace(f, center=7.62) if f is mass else f for f in made.hypothesis().free)
    free = tuple(replace(f, center=296.0) if f.name == "temperature" else f for f in free)
    return OtherTest("T2", replace(made.hypothesis(), free=free), made.observed(seed=5, engine=engine))


@cache
def proof(eroding: bool) -> Proof:
    return prove(eroded(), verdict_of(eroded()).chosen, sibling(EROSION) if eroding else sibling())


def test_the_gap_closes_on_all_arms_and_hardly_with_a_wrong_effect() -> None:
    fractions = proof(eroding=True).fractions
    assert set(fractions) >= {"same", "held_out", "other_test", "placebo"}
    for arm in ("same", "held_out", "other_test"):
        assert fractions[arm] is not None, arm
        assert 0.8 < fractions[arm] <= 1.0, arm
    assert fractions["placebo"] is not None
    assert fractions["placebo"] < 0.5


def test_an_effect_that_another_test_lacks_does_not_close_its_gap() -> None:
    found = proof(eroding=False)
    assert found.other is not None
    fraction = found.fractions["other_test"]
    assert fraction is None or fraction < 0.0
    assert found.other.after["p_chamber"] > found.other.before["p_chamber"]


def test_the_other_test_keeps_the_constants_that_were_found_here() -> None:
    chosen = verdict_of(eroded()).chosen
    kept = gap.frozen(sibling(EROSION).hypothesis, chosen.fit)
    assert kept.names == made.hypothesis().names
    assert kept.engine.effects[0].named["rate"] == pytest.approx(chosen.fit.values["nozzle_throat_erosion.rate"])


def test_without_another_test_the_proof_says_so() -> None:
    alone = prove(eroded(), verdict_of(eroded()).chosen, None)
    assert alone.fractions["other_test"] is None
    assert any("no other test" in note for note in alone.notes)


def test_the_gap_of_the_truth_is_the_noise() -> None:
    test = made.observed()
    found = fit(made.hypothesis(), test)
    rms, noise = gap.root_mean_square(found, test), gap.noise_of(test)
    for name, value in rms.items():
        assert value == pytest.approx(noise[name], rel=0.2), name
    gaps = [
        gap.total_gap(fit(made.hypothesis(), test), test) for test in (made.observed(seed=seed) for seed in range(5))
    ]
    assert np.median(gaps) == 0.0
    assert max(gaps) < 0.8
    assert gap.closed(0.1, 0.0) is None
    assert gap.closed(10.0, 1.0) == pytest.approx(0.9)


def test_offset_and_gain_of_a_sensor_are_no_gap() -> None:
    test = made.observed()
    found = fit(made.hypothesis(), test)
    shifted = tuple(replace(c, value=1.002 * c.value + 4e3) if c.name == "p_run" else c for c in test.channels)
    biased = gap.root_mean_square(found, replace(test, channels=shifted))
    assert biased["p_run"] < 1.3 * gap.root_mean_square(found, test)["p_run"]


def test_what_an_effect_does_is_given_over_time() -> None:
    found = eroded()
    source = acting(verdict_of(found).chosen.fit, "nozzle_throat_erosion", found.bench.observed)
    assert source.equation == "nozzle"
    assert source.unit == "N"
    assert (source.std > 0.0).all()
    assert abs(source.mean[-1]) > 5.0 * abs(source.mean[2])


def test_the_band_of_a_source_holds_what_its_other_constants_leave_open() -> None:
    """Pressure against a reference that nobody knows: how much of the regression is the effect's is a convention."""
    hidden = effect("grain_pressure_regression").at(exponent=0.3, bend=1.0)
    test = made.observed(hidden)
    found = fit(made.hypothesis().with_effect(effect("grain_pressure_regression")), test)
    source = acting(found, "grain_pressure_regression", test)
    burning = source.time < 0.9 * test.end
    size = np.abs(source.mean[burning])
    there = int(np.argmin(size))
    assert size[there] < 0.1 * size.max()  # the pressure is the reference there, if that is what was assumed
    assert source.std[burning][there] > 0.1 * size.max()


def test_variants_are_known_by_name() -> None:
    assert settings_of("") == VARIANTS[""]
    assert settings_of("white_noise").colored is False
    assert sum(settings_of(name) == settings_of("") for name in VARIANTS) == 1
    with pytest.raises(InputError, match="expected one of no_tempering"):
        settings_of("no_such")


def test_slow_noise_may_stray_further_by_chance() -> None:
    test = made.observed()
    found = fit(made.hypothesis(), test)
    louder = tuple(replace(c, noise_std=0.85 * c.noise_std) for c in test.channels)  # 1.4 times the noise's square
    slower = tuple(replace(c, coherence=20.0) for c in louder)
    assert gap.total_gap(found, replace(test, channels=louder)) > 0.5
    assert gap.total_gap(found, replace(test, channels=slower)) == 0.0


def test_what_slow_noise_may_be_larger_by_is_no_gap() -> None:
    """A quiet time tells its size to a factor only; that of white noise it tells."""
    test = made.observed()
    found = fit(made.hypothesis(), test)
    louder = tuple(replace(c, noise_std=0.85 * c.noise_std) for c in test.channels)
    slow, hardly = (tuple(replace(c, slow=share * np.diag(c.noise_std**2)) for c in louder) for share in (0.8, 0.05))
    assert gap.total_gap(found, replace(test, channels=slow)) == 0.0
    assert gap.total_gap(found, replace(test, channels=hardly)) > 0.5
    far = tuple(replace(c, noise_std=0.5 * c.noise_std, slow=0.2 * np.diag(c.noise_std**2)) for c in test.channels)
    assert gap.total_gap(found, replace(test, channels=far)) > 0.5


def test_what_is_named_beside_the_first_is_not_said_to_be_excluded(monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr(verdict_module, "scale", EvidenceScale)
    monkeypatch.setattr(posterior, "scale", EvidenceScale)
    found = with_set(10.0)
    found = replace(
        found, equations={**found.equations, **dict.fromkeys(("load_cell_drift", "chamber_tap_lag"), "sensor")}
    )
    verdict = verdict_of(found)
    assert verdict.added == ("nozzle_throat_erosion", "load_cell_drift")
    assert verdict.posterior["load_cell_drift"] < LIKELY
    excluded = _not_it(verdict)
    assert "chamber_tap_lag" in excluded
    assert not set(excluded) & set(verdict.added)


def test_an_unknown_source_is_no_effect_of_the_name_of_its_site(monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr(verdict_module, "scale", EvidenceScale)
    found = probable(("nozzle_throat_erosion", 3.0), ("unknown", 40.0))
    at_heat = replace(found.unknown[0], names=("tank_heat",))
    equations = {**found.equations, "tank_heat": "tank_energy"}
    verdict = verdict_of(replace(found, unknown=(at_heat,), equations=equations))
    assert verdict.label == "unknown"
    assert verdict.chosen.names == ("tank_heat",)
    assert verdict.added == ()
    assert _decisive(verdict, Catalogue(library(), {})) == ()
    assert "tank_heat" in _not_it(verdict)


def test_nothing_is_to_be_measured_where_nothing_is_claimed() -> None:
    assert _decisive(verdict_of(probable(("tank_heat", -20.0))), Catalogue(library(), {})) == ()
    assert _decisive(verdict_of(probable(("tank_heat", 40.0))), Catalogue(library(), {}))


def test_an_interval_of_a_parameter_stays_within_its_bounds() -> None:
    share = next(p for p in effect("tank_nonequilibrium").parameters if p.name == "sustained")
    assert _within(share, 0.9, 0.2).ci95 == pytest.approx((0.9 - 1.96 * 0.2, 1.0), abs=1e-3)
    assert _within(share, 0.1, 0.2).ci95 == pytest.approx((0.0, 0.1 + 1.96 * 0.2), abs=1e-3)
