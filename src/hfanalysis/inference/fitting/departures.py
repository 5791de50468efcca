"""What a model would read if the table of nitrous oxide were another one, or a law of an equation: no test tells the
one from heat of some watts, nor the other from an effect of some per cent.

These departures are constants of every hypothesis, and linear: a run with each of them says what it adds to the
channels' blocks, to the instant at which the liquid ends, and to how wide the port is when the fuel does.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.inference.fitting.hypothesis import DEPARTURE, OF_LAW, Free, Hypothesis
from hfanalysis.inference.fitting.laws import LAWS
from hfanalysis.inference.fitting.predict import port_radius, predict, readings
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.thermo.departures import DEPARTURES, departed

MOST = 2.0
"""Standard deviations by which a law may depart. Source: a law that is off by more is no other law but something that
is missing, and a run with one deviation does not tell what ten would do."""


def with_departures(
    hypothesis: Hypothesis, observed: Observed, start: Array | None = None
) -> tuple[Hypothesis, Observed]:
    """The hypothesis with the departures free, and the observations with what these add at ``start`` (parameters,), in
    prior standard deviations: where it starts by default.

    One that cannot be run there is left as it is: its fit will say so.
    """
    engine = hypothesis.engine
    start = np.zeros(hypothesis.size) if start is None else start
    tables = {
        f"{DEPARTURE}table: {by.name}": replace(engine, saturation=departed(engine.saturation, by)) for by in DEPARTURES
    }
    laws = {
        f"{OF_LAW}{law.name}": replace(engine, effects=(*engine.effects, LAWS.at(**{law.name: law.typical})))
        for law in LAWS.parameters
    }
    try:
        here, *others = (
            predict(replace(hypothesis, engine=one), observed, start, tangents=False).burnt
            for one in (engine, *tables.values(), *laws.values())
        )
    except (ValueError, ArithmeticError):
        return hypothesis, observed
    read = readings(observed, here)
    more = [{name: values - read[name] for name, values in readings(observed, other).items()} for other in others]
    channels = tuple(
        replace(c, departures=np.column_stack([c.averaged(added[c.name]) for added in more])) for c in observed.channels
    )
    gone = [other.liquid_out for other in others]
    later = np.array([0.0 if g is None or here.liquid_out is None else g - here.liquid_out for g in gone])
    ends = [at for name, (at, _) in observed.events.items() if name != "t_v"]
    wider = np.array([port_radius(other, ends[0]) - port_radius(here, ends[0]) if ends else 0.0 for other in others])
    free = (
        *(Free(name, 0.0, 1.0) for name in tables),
        *(Free(name, 0.0, 1.0, least=-MOST, most=MOST) for name in laws),
    )
    return replace(hypothesis, free=(*hypothesis.free, *free)), replace(
        observed, channels=channels, later=later, wider=wider
    )
