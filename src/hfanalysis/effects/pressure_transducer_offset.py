"""Pressure transducers whose zero is not that of the atmosphere before ignition."""

from __future__ import annotations

from collections.abc import Mapping

from hfanalysis.engine.effect import Array, Channels, Effect, Parameter

CHANNELS = ("p_tank", "p_run", "p_chamber")


def _distort(times: Array, channels: Channels, values: Mapping[str, float]) -> dict[str, Array]:
    return {**channels, **{name: channels[name] + values[name] for name in CHANNELS if name in channels}}


EFFECT = Effect(
    name="pressure_transducer_offset",
    equation="sensor",
    meaning="one or several pressure transducers read a constant amount too much",
    reference="Doebelin, Measurement Systems, chapters 3 and 6: zero shift of diaphragm transducers",
    formula="p_read = p + offset, for each of p_tank, p_run, p_chamber",
    sites=CHANNELS,
    parameters=tuple(
        Parameter(name, "Pa", f"offset of {name}", typical=0.5e5, low=-10e5, high=10e5) for name in CHANNELS
    ),
    strengths=3,
    phases=("liquid", "vapor", "nitrogen"),
    distort=_distort,
    twins=(),
    decisive="all transducers at one known pressure, before or after the test",
)
