"""What a name has to meet to stand by itself, and what it keeps where it does not."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from tests.diagnose.answer.test_verdict import eroded, probable
from tests.inference import made

from hfanalysis.diagnose.answer import borne_out as borne_out_module
from hfanalysis.diagnose.answer import standing
from hfanalysis.diagnose.answer import verdict as verdict_module
from hfanalysis.diagnose.answer.at_limit import NEAR, at_limit
from hfanalysis.diagnose.answer.borne_out import borne_out, broken
from hfanalysis.diagnose.answer.plausible import IMPOSSIBLE, judged, size_of, sized
from hfanalysis.diagnose.answer.posterior import SET
from hfanalysis.diagnose.answer.standing import (
    KEPT,
    among_partners,
    among_twins,
    beside_a_curve,
    by_laws,
    left_open,
    missed,
    withheld,
)
from hfanalysis.diagnose.answer.verdict import CLAIM, NAMED_FROM, Verdict, effects_product, verdict_of
from hfanalysis.diagnose.answer.words import doubts_sentences, headline
from hfanalysis.diagnose.naming.polish import DEEPER, NotConvergedError, assert_converged, not_converged
from hfanalysis.effects import effect
from hfanalysis.inference.candidate import Candidate, candidate
from hfanalysis.inference.fitting.bounds import on_bounds
from hfanalysis.inference.fitting.fit import fit
from hfanalysis.inference.predictive import Foretold, log_predictive


@pytest.mark.parametrize(
    ("name", "strength"), [("combustion_efficiency", {"deficit": -0.021}), ("nozzle_divergence", {"loss": -0.046})]
)
def test_a_sign_that_cannot_be_is_not_believed(name: str, strength: dict[str, float]) -> None:
    """A combustion above equilibrium, and a nozzle better than the ideal one."""
    active = effect(name).at(**strength)
    assert size_of(active).lost == IMPOSSIBLE
    assert judged(size_of(active)).plausible is False
    assert "cannot be" in str(judged(size_of(active)).why)
    assert size_of(active).kept < 0.01
    (value,) = strength.values()
    assert size_of(effect(name).at(**dict.fromkeys(strength, -value))).kept == 1.0


def test_within_what_tables_know_a_sign_is_no_matter() -> None:
    active = effect("combustion_efficiency").at(deficit=-0.005)
    assert (size_of(active).lost, size_of(active).kept) == (0.0, 1.0)


def test_what_is_hard_to_believe_keeps_less_the_larger_it_is() -> None:
    shares = [size_of(effect("tank_heat").at(power=power)).kept for power in (9.7e3, 11e3, 20e3, 40e3)]
    assert shares == pytest.approx([1.0, 1.0 / 1.21, 0.25, 1.0 / 16.0])


def test_a_drift_is_judged_by_what_it_comes_to_and_not_by_where_it_would_end() -> None:
    """700 N that take a minute are not there after the ten seconds of a firing."""
    test = made.observed(effect("load_cell_drift").at(drift=700.0, time=60.0))
    slow = fit(made.hypothesis().with_effect(effect("load_cell_drift")), test)
    found = sized(slow, "load_cell_drift", test)
    assert found is not None
    assert found.acts
    whole = size_of(next(a for a in slow.burnt.steps.engine.effects if a.effect.name == "load_cell_drift"))
    assert whole is not None
    assert abs(found.value) < abs(whole.value)
    assert "at its largest" in str(judged(found).why)


@pytest.mark.parametrize(
    ("gain", "alone", "near", "sure"),
    [(6.0, 60.0, False, False), (60.0, 60.0, True, True), (6.0, 1.0, False, True),
     (60.0, 500.0, False, True), (60.0, 500.0, True, False), (150.0, 500.0, True, True)],
)  # fmt: skip
def test_a_name_beside_the_first_is_not_what_the_first_s_law_may_get_wrong(
    gain: float, alone: float, near: bool, sure: bool
) -> None:
    """Six beside sixty are what an error of the law explains, beside one they are not; sixty beside five hundred are
    what its course may be wrong by where both act at one place."""
    base, first = eroded().base, eroded().singles[0]
    one = replace(first, log_evidence=base.log_evidence + alone)
    both = replace(first, names=(*first.names, "load_cell_drift"), log_evidence=one.log_evidence + gain)
    told = by_laws({"load_cell_drift": 0.99}, first.names[0], base, (one, both), 0.8, lambda *_: near)
    assert (told["load_cell_drift"] >= SET) == sure


def too_large() -> Candidate:
    """Throat erosion, of a size three times as large as can be believed."""
    single = eroded().singles[0]
    worn = replace(single.fit.burnt.steps.engine, effects=(effect("nozzle_throat_erosion").at(rate=1.2e-3),))
    steps = replace(single.fit.burnt.steps, engine=worn)
    return replace(single, fit=replace(single.fit, burnt=replace(single.fit.burnt, steps=steps)))


@pytest.mark.parametrize(
    ("name", "curve", "elsewhere", "sure"),
    [(191.0, 213.0, None, False), (97.0, 113.0, None, False), (69.0, 78.0, None, False),
     (69.0, 140.0, None, True), (191.0, 213.0, 213.0, True), (20.0, 213.0, None, True)],
)  # fmt: skip
def test_a_free_curve_that_explains_little_more_than_a_name_is_not_surely_something_else(
    name: float, curve: float, elsewhere: float | None, sure: bool
) -> None:
    """It follows what the law gets wrong; in another equation, or where it explains far more, it is something else."""
    before = {"none": 0.0, "tank_heat": 0.001, "feed_line_fill": 0.0, "unknown": 0.999}
    evidences = {"none": 0.0, "tank_heat": name, "feed_line_fill": 5.0, "unknown": curve}
    after = beside_a_curve(before, evidences, elsewhere, 0.8)
    assert (after["unknown"] > 0.9) == sure
    assert sum(after.values()) == pytest.approx(1.0)
    assert after["feed_line_fill"] == 0.0


@pytest.mark.parametrize("evidences", [{"none": 0.0, "unknown": 9.0}, {"none": 0.0, "a": -5.0, "unknown": 9.0},
                                       {"none": 0.0, "a": 12.0, "unknown": 9.0}])  # fmt: skip
def test_where_no_name_comes_before_a_curve_nothing_is_shared(evidences: dict[str, float]) -> None:
    before = dict.fromkeys(evidences, 1.0 / len(evidences))
    assert beside_a_curve(before, evidences, None, 0.8) == before


@pytest.mark.parametrize(
    ("gaps", "open_"), [((5.0, 4.0), True), ((9.0, 2.1), False), ((2.1, 1.7), False), ((0.3, 0.3), False)]
)
def test_a_name_that_closes_little_of_the_gap_is_not_the_whole_story(
    gaps: tuple[float, float], open_: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where what is left is more than noise; a gap within the noise cannot be closed, and tells nothing."""
    base, one, observed = eroded().base, eroded().singles[0], eroded().bench.observed
    told = {id(base.fit): gaps[0], id(one.fit): gaps[1]}
    monkeypatch.setattr(standing, "total_gap", lambda fit, _: told[id(fit)])
    said = left_open(one, base, observed)
    assert bool(said) == open_
    assert all("20 % of the gap between model and test closes" in why for why in said)
    probable = {"none": 0.0, one.names[0]: 0.99, "unknown": 0.01}
    kept = withheld(probable, {one.names[0]: one}, base, observed)
    assert (kept[one.names[0]] < 0.5) == open_


def test_a_size_beyond_belief_is_not_stated_at_99_percent_but_unknown_beside_the_name() -> None:
    verdict = verdict_of(replace(eroded(), singles=(too_large(),), sets=(), unknown=()))
    assert verdict.posterior["nozzle_throat_erosion"] < 0.5
    assert verdict.label == "unknown"
    assert verdict.added == ("nozzle_throat_erosion",)
    assert "beyond" in str(verdict.doubts[0])
    assert effects_product(verdict, eroded().bench.observed) == ()
    assert sum(verdict.posterior.values()) == pytest.approx(1.0)


def on_a_bound() -> Candidate:
    """The same fit with m where it may go no further."""
    single = eroded().singles[0]
    hypothesis, x = single.fit.hypothesis, single.fit.x.copy()
    at = hypothesis.names.index("polytropic_exponent")
    x[at] = hypothesis.free[at].least
    return replace(single, fit=replace(single.fit, x=x))


def test_a_constant_on_its_bound_is_told_by_its_name() -> None:
    assert on_bounds(on_a_bound().fit) == ("m is on its bound (0.95)",)
    assert on_bounds(eroded().singles[0].fit) == ()


def test_no_name_where_a_constant_of_its_model_is_on_a_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    before = verdict_of(eroded())
    assert before.label == "named"
    assert before.doubts == ()
    monkeypatch.setattr(verdict_module, "borne_out", lambda found, _: found)
    verdict = verdict_of(replace(eroded(), singles=(on_a_bound(),), sets=(), unknown=()))
    assert verdict.label == "unknown"
    assert verdict.doubts == ("m is on its bound (0.95)",)
    assert verdict.posterior["nozzle_throat_erosion"] == pytest.approx(KEPT, abs=0.03)


def test_a_channel_that_is_missed_is_told_with_its_size() -> None:
    single, observed = eroded().singles[0], eroded().bench.observed
    assert missed(single.fit, observed) == ()
    bent = tuple(
        replace(c, value=c.value + 1.5e5 * np.sin(3.0 * c.time) * ~c.resting) if c.name == "p_run" else c
        for c in observed.channels
    )
    (told,) = missed(single.fit, replace(observed, channels=bent))
    size, times = re.fullmatch(
        r"run line pressure is missed by ([\d.]+) bar, (\d+) times its noise", str(told)
    ).groups()
    assert float(size) == pytest.approx(1.5 / np.sqrt(2.0), rel=0.1)  # less what its gain may be off
    assert float(times) == pytest.approx(float(size) * 1e5 / made.NOISE["p_run"], rel=0.1)


def test_of_a_quiet_sensor_a_little_beside_the_model_is_no_miss() -> None:
    single, observed = eroded().singles[0], eroded().bench.observed
    quiet = tuple(replace(c, noise_std=0.01 * c.noise_std) for c in observed.channels)
    assert missed(single.fit, replace(observed, channels=quiet)) == ()


@pytest.mark.parametrize(
    ("right", "wrong", "together"), [(26.8, 30.1, True), (8.7, 13.5, True), (31.1, 31.2, True), (20.0, 80.0, False)]
)
def test_twins_are_stated_together_unless_one_explains_far_more(right: float, wrong: float, together: bool) -> None:
    """Evidences of another generator's tests; the last as it has to be for a name alone."""
    found = {"a": wrong, "b": right}
    told = among_twins({"none": 0.01, "a": 0.98, "b": 0.01}, found, found, {"a": ("b",)}, 0.8)
    assert sum(told.values()) == pytest.approx(1.0)
    assert (told["b"] > 1.0 - SET) == together
    assert told["a"] >= told["b"]


def test_twins_are_in_the_set_and_the_verdict_leaves_them_open() -> None:
    found = probable(("tank_heat", 13.5), ("tank_wall_heat_capacity", 8.7))
    twins = {"tank_heat": ("tank_wall_heat_capacity",), "tank_wall_heat_capacity": ("tank_heat",)}
    verdict = verdict_of(found, twins)
    assert verdict.label == "ambiguous"
    assert {"tank_heat", "tank_wall_heat_capacity"} <= set(verdict.set90)


def test_a_right_name_keeps_what_it_promises_on_held_out_data() -> None:
    found = eroded()
    before, after = (log_predictive(c, found.bench) for c in (found.base, found.singles[0]))
    assert before is not None
    assert after is not None
    gain, promised = after.rest - before.rest, after.all - before.all
    assert gain > 10.0
    assert broken(gain, promised, promised) < 0.1 * promised


def test_what_noise_alone_named_is_not_borne_out() -> None:
    """The base model is right: an effect that was fitted to noise foretells nothing."""
    test = made.observed(seed=4)
    base = candidate((), fit(made.hypothesis(), test), eroded().base.form)
    drift = fit(made.hypothesis().with_effect(effect("load_cell_drift")), test)
    named = replace(candidate(("load_cell_drift",), drift, base.form), log_evidence=base.log_evidence + 12.0)
    found = replace(eroded(), base=base, singles=(named,), sets=(), unknown=(), bench=type(eroded().bench)(test))
    verdict = borne_out(found, lambda n: Verdict("named", {}, {}, [], n.singles[0]))
    assert verdict.held_out[("load_cell_drift",)] is not None
    assert verdict.held_out[("load_cell_drift",)] < 3.0


def test_a_name_beside_the_first_has_to_be_borne_out_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """The set keeps nine tenths of all it promises, but nothing of what its second name does."""
    first = eroded().singles[0]
    both = replace(first, names=(*first.names, "load_cell_drift"), log_evidence=first.log_evidence + 20.0)
    told = {(): Foretold(0.0, 0.0), first.names: Foretold(100.0, 100.0), both.names: Foretold(99.0, 125.0)}
    monkeypatch.setattr(borne_out_module, "log_predictive", lambda c, _: told[c.names])
    found = replace(eroded(), sets=(both,), unknown=())
    best = borne_out(found, lambda n: Verdict("named", {}, {}, [], max(n.all, key=lambda c: c.log_evidence)))
    assert best.sets[0].log_evidence - best.singles[0].log_evidence == pytest.approx(20.0 * 2.0 / 25.0)
    assert best.singles[0].log_evidence == first.log_evidence


def test_beside_the_first_a_twin_of_a_size_that_can_be_is_chosen_over_one_of_a_size_that_cannot() -> None:
    """The data are more probable with the one whose size is three times what can be believed."""
    first, test = eroded().singles[0], eroded().bench.observed
    large = replace(too_large(), names=("tank_heat", "nozzle_throat_erosion"), log_evidence=first.log_evidence + 4.0)
    usual = replace(first, names=("tank_heat", "combustion_efficiency"))
    kept = {
        n: verdict_module._size_beside(n, "tank_heat", (large, usual), test) for n in (large.names[1], usual.names[1])
    }
    assert kept == pytest.approx({"nozzle_throat_erosion": 1.0 / 9.0, "combustion_efficiency": 1.0})
    partners = {"nozzle_throat_erosion": 0.7 * kept["nozzle_throat_erosion"], "combustion_efficiency": 0.3}
    assert verdict_module._likeliest_beside(partners, large, (large, usual)) is usual
    assert verdict_module._likeliest_beside({**partners, "nozzle_throat_erosion": 0.7}, usual, (large, usual)) is large


def test_a_twin_that_is_named_already_takes_nothing_from_the_other() -> None:
    """Two twins may both be there: then neither stands in the place of the other."""
    base, first = eroded().base, eroded().singles[0]
    one = replace(first, names=("tank_nonequilibrium",), log_evidence=base.log_evidence + 500.0)
    both = replace(first, names=("tank_nonequilibrium", "tank_stratification"), log_evidence=one.log_evidence + 90.0)
    twins = {"tank_stratification": ("tank_nonequilibrium",)}
    assert among_partners({"tank_stratification": 0.98}, both, (one, both), twins, 0.8) == {"tank_stratification": 0.98}


def test_twins_beside_the_first_are_told_together_too() -> None:
    first = eroded().singles[0]
    sets = tuple(
        replace(first, names=(*first.names, name), log_evidence=first.log_evidence + gain)
        for name, gain in (("chamber_heat_loss", 45.0), ("combustion_efficiency", 41.0))
    )
    found = replace(
        eroded(),
        sets=sets,
        unknown=(),
        equations={
            **eroded().equations,
            **dict.fromkeys(("chamber_heat_loss", "combustion_efficiency"), "chamber_energy"),
        },
    )
    told = verdict_of(found).partners, verdict_of(found, {"chamber_heat_loss": ("combustion_efficiency",)}).partners
    assert told[0]["combustion_efficiency"] < 0.02
    assert 0.2 < told[1]["combustion_efficiency"] < told[1]["chamber_heat_loss"] < 0.8


@pytest.mark.parametrize(("none", "said"), [(CLAIM - 0.5 * NEAR, True), (CLAIM + 0.5 * NEAR, True), (0.02, False)])
def test_a_verdict_at_a_limit_says_so(none: float, said: bool) -> None:
    label = "none" if none >= CLAIM else "named"
    verdict = Verdict(label, {"none": none, "tank_heat": 1.0 - none}, {}, [], eroded().singles[0])
    assert (at_limit(verdict) is not None) == said


@pytest.mark.parametrize(("top", "said"), [(SET - 0.005, True), (NAMED_FROM + 0.005, True), (0.75, False)])
def test_a_name_at_a_limit_says_so(top: float, said: bool) -> None:
    verdict = Verdict(
        "ambiguous", {"none": 0.01, "tank_heat": top, "n2_purge": 0.99 - top}, {}, [], eroded().singles[0]
    )
    assert (at_limit(verdict) is not None) == said


def test_a_search_that_did_not_converge_raises_where_that_must_not_be() -> None:
    assert not_converged(DEEPER) is None
    why = not_converged(31.2)
    with pytest.raises(NotConvergedError, match="deeper in log evidence"):
        assert_converged(why)
    assert_converged(None)
    assert not_converged(eroded().risen) is None


def test_what_stands_beside_a_name_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    from tests.products.filled import filled

    from hfanalysis.products.diagnosis import Diagnosis

    monkeypatch.setattr(standing, "KEPT", 0.4)
    product = filled(Diagnosis, {}).but(
        verdict="unknown", effects=(), posterior={"unknown": 0.6, "tank_heat": 0.4}, set90=("unknown", "tank_heat"),
        unknown_beside=("tank_heat",), doubts=("m is on its bound (0.95)",), at_limit="none has 0.150",
    )  # fmt: skip
    assert "beside tank heat (probability 0.60)" in headline(product)
    told = " ".join(map(str, doubts_sentences(product)))
    assert "With tank heat alone the story is not whole: m is on its bound (0.95)." in told
    assert "at a limit" in told
