"""Pressure transducers whose zero is not that of the atmosphere before ignition."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Believable, Channels, Effect, Parameter

CHANNELS = ("p_tank", "p_run", "p_chamber")


def _distort(times: Array, channels: Channels, values: Mapping[str, float]) -> dict[str, Array]:
    share = np.where(np.asarray(times) > 0.0, 1.0, values["before"])
    return {**channels, **{name: channels[name] + share * values[name] for name in CHANNELS if name in channels}}


EFFECT = Effect(
    name="pressure_transducer_offset",
    plain_name="pressure transducer off its zero",
    equation="sensor",
    meaning="one or several pressure transducers read a constant amount too much",
    reference="Doebelin, Measurement Systems, chapters 3 and 6: zero shift of diaphragm transducers",
    formula="p_read = p + offset, for each of p_tank, p_run, p_chamber; b offset before the opening",
    sites=CHANNELS,
    parameters=(
        *(Parameter(name, "Pa", f"offset of {name}", typical=0.5e5, low=-10e5, high=10e5) for name in CHANNELS),
        Parameter("before", "-", "part of it that was there before the opening", 0.5, center=0.5, low=0.0, high=1.0),
    ),
    strengths=3,
    phases=("liquid", "vapor", "nitrogen"),
    distort=_distort,
    twins=(),
    decisive="all transducers at one known pressure, before or after the test",
    believable=Believable("p_tank", 3e5, "that much would show before the test", unit="bar", factor=1e-5),
)
