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
