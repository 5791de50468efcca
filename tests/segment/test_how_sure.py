"""How sure the phases are of an opening that the engineer states, and of what counts from it."""

from __future__ import annotations

import numpy as np
import pytest
from tests.segment.stand import definition, fire, log_of

from hfanalysis.segment.phases import find_phases
from hfanalysis.units import Value


@pytest.mark.parametrize("std", [0.005, 0.05])
def test_a_stated_opening_is_as_sure_as_it_is_stated_and_so_is_what_counts_from_it(std: float) -> None:
    """The end of the liquid adds what it is known to itself, which is a millisecond."""
    log = log_of(fire(rate=200.0), white=5e3)
    found = find_phases(log, definition(segments={"t_open": Value(100.0, std)}))
    assert found.t_open.std == pytest.approx(std)
    alone = find_phases(log, definition(segments={"t_open": Value(100.0, 1e-6)})).events["t_v"].std
    assert alone is not None
    assert alone < 0.01
    assert found.events["t_v"].std == pytest.approx(np.hypot(alone, std), rel=0.02)
