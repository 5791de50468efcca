"""What an explanation can do without is left out, and only that."""

from __future__ import annotations

from tests.inference import made

from hfanalysis.diagnose.naming.dropping import dropped
from hfanalysis.diagnose.naming.localise import Smooth, linear_sources
from hfanalysis.effects import effect
from hfanalysis.inference.candidate import FINEST, Bench, candidate
from hfanalysis.inference.fitting.fit import fit


def test_a_source_called_like_the_effect_that_is_left_out_stays() -> None:
    test = made.observed()
    found = fit(made.hypothesis().with_effect(effect("tank_heat")), test)
    source = next(s for s in linear_sources(found, test) if s.site.name == "tank_heat" and isinstance(s, Smooth))
    both = fit(source.added_to(found.hypothesis)[0], test)
    less = dropped(candidate(("tank_heat", source.site.name), both, FINEST, unknown=True), Bench(test))
    assert less.names == ("tank_heat",)
    assert less.unknown
    assert less.fit.hypothesis.blocks
    assert not any(name.startswith("tank_heat.") for name in less.fit.hypothesis.names)
