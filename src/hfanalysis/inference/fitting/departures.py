"""What a model would read if the table of nitrous oxide were another one, or a law of an equation: no test tells the
one from heat of some watts, nor the other from an effect of some per cent.

These departures are constants of every hypothesis, and linear: a run with each of them says what it adds to the
channels, to the instant at which the liquid ends, and to how wide the port is when the fuel does. Where a fit has laws
for which that is wrong by more than the noise, the engine is run by these laws instead.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.hypothesis import OF_LAW, OF_TABLE, Departures, Free, Hypothesis
from hfanalysis.inference.fitting.laws import LAWS, engine_by_laws
from hfanalysis.inference.fitting.predict import FINE, port_radius, predict, readings
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.thermo.departures import DEPARTURES, departed

MOST = 2.0
"""Standard deviations by which a law may depart. Source: a law that is off by more is no other law but something that
is missing, and a run with one deviation does not tell what ten would do."""

BENT = 1.0
"""Square of what departures add to the whitened residual beside what a run by these laws does, from which on the engine
is run by them [-]. Source: half of it is log probability. Evidence: in SB03 (docs/worlds.md), which hides nothing, an
unknown source had been stated at 0.99 for it."""


def with_departures(hypothesis: Hypothesis, observed: Observed, start: Array | None = None) -> Hypothesis:
    """The hypothesis with the departures free, and what these add at ``start`` (parameters,), in prior standard
    deviations: where it starts by default.

    One that cannot be run there is left as it is: its fit will say so.
    """
    start = np.zeros(hypothesis.size) if start is None else start
    found = _departures(hypothesis, observed, start)
    if found is None:
        return hypothesis
    free = (
        *(Free(f"{OF_TABLE}{by.name}", 0.0, 1.0) for by in DEPARTURES),
        *(Free(f"{OF_LAW}{law.name}", 0.0, 1.0, least=-MOST, most=MOST) for law in LAWS.parameters),
    )
    return replace(hypothesis, free=(*hypothesis.free, *free), departures=found)


def with_its_laws(found: Fit, observed: Observed) -> Hypothesis | None:
    """The hypothesis of a fit with an engine that is run by the laws themselves, and what tables add made anew; None
    where what laws add is as linear as was taken, or an engine of these laws cannot be run."""
    hypothesis, known = found.hypothesis, found.hypothesis.departures
    if known is None or known.run:
        return None
    try:
        linear, run = (
            predict(one, observed, found.x, tangents=False, accuracy=FINE).residual
            for one in (hypothesis, _run(hypothesis, known))
        )
    except (ValueError, ArithmeticError):
        return None
    off = run - linear
    if float(off @ off) < BENT or (made := _departures(hypothesis, observed, found.x)) is None:
        return None
    return _run(hypothesis, made)


def _run(hypothesis: Hypothesis, departures: Departures) -> Hypothesis:
    return replace(hypothesis, departures=replace(departures, run=True))


def _departures(hypothesis: Hypothesis, observed: Observed, x: Array) -> Departures | None:
    """What departures add at ``x`` (parameters,), in standard deviations; None where that cannot be run."""
    engine, bare = hypothesis.engine, replace(hypothesis, departures=None)
    tables = [replace(engine, saturation=departed(engine.saturation, by)) for by in DEPARTURES]
    laws = [engine_by_laws(engine, one) for one in np.eye(len(LAWS.parameters))]
    try:
        here, *others = (
            predict(replace(bare, engine=one), observed, x, tangents=False).burnt for one in (engine, *tables, *laws)
        )
    except (ValueError, ArithmeticError):
        return None
    read, more = readings(observed, here), [readings(observed, other) for other in others]
    reads = {c.name: np.column_stack([one[c.name] - read[c.name] for one in more]) for c in observed.channels}
    gone = [other.liquid_out for other in others]
    later = np.array([0.0 if g is None or here.liquid_out is None else g - here.liquid_out for g in gone])
    ends = [at for name, (at, _) in observed.events.items() if name != "t_v"]
    wider = np.array([port_radius(other, ends[0]) - port_radius(here, ends[0]) if ends else 0.0 for other in others])
    return Departures(reads, later, wider)
