"""What an explanation can do without is left out, and only that."""

from __future__ import annotations

from tests.inference import made

from hfanalysis.diagnose.naming.dropping import dropped
from hfanalysis.effects import effect
from hfanalysis.inference.candidate import FINEST, Bench, candidate
from hfanalysis.inference.fitting.fit import fit
from hfanalysis.inference.unknowns import in_slopes
from hfanalysis.inference.unknowns.smooth_source import SmoothSource


def test_a_source_called_like_the_effect_that_is_left_out_stays() -> None:
    test = made.observed()
    found = fit(made.hypothesis().with_effect(effect("tank_heat")), test)
    source = next(s for s in in_slopes(found, test) if s.place.name == "tank_heat" and isinstance(s, SmoothSource))
    both = fit(source.added_to(found)[0], test)
    less = dropped(candidate(("tank_heat", source.place.name), both, FINEST, source), Bench(test))
    assert less.names == ("tank_heat",)
    assert less.unknown
    assert less.fit.hypothesis.blocks
    assert not any(name.startswith("tank_heat.") for name in less.fit.hypothesis.names)


def test_what_was_added_last_and_is_hardly_there_is_left_out() -> None:
    """It may have shown the others the way: they stay, with the constants that it led to."""
    heat, lag = effect("tank_heat"), effect("chamber_tap_lag")
    test = made.observed(heat.at(power=5000.0))
    both = fit(made.hypothesis().with_effect(heat).with_effect(lag), test)
    less = dropped(candidate(("tank_heat", "chamber_tap_lag"), both, FINEST), Bench(test))
    assert less.names == ("tank_heat",)
    assert less.log_evidence > candidate(("tank_heat", "chamber_tap_lag"), both, FINEST).log_evidence
