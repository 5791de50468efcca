"""A chamber pressure that reaches its transducer late, through a tap and a tube."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled
from hfanalysis.engine.effect import Believable, Channels, Effect, Parameter

REFERENCE = 10e5
"""Pressure [Pa] at which the lag is stated. Source: by definition of the lag."""

LEAST_TAP_PRESSURE = 0.5e5
"""Pressure [Pa] below which a tube fills no slower."""


@compiled
def lagged(times: Array, true: Array, lags: Array) -> Array:
    """What a sensor of first order reads that starts at rest, (n,), in the unit of ``true`` (n,).

    Exact for values taken linear between ``times`` [s], (n,). ``lags`` [s], (n,): those of the stretches that end at
    ``times``.
    """
    out = np.empty_like(true)
    behind = 0.0
    for i in range(true.size):
        if i > 0:
            h, lag = times[i] - times[i - 1], lags[i]
            if h > 0.0:
                kept = np.exp(-h / lag) if lag > 0.0 else 0.0
                behind = behind * kept - lag * (true[i] - true[i - 1]) / h * (1.0 - kept)
            else:
                behind -= true[i] - true[i - 1]
        out[i] = true[i] + behind
    return out


def _distort(times: Array, channels: Channels, values: Mapping[str, float]) -> dict[str, Array]:
    true = np.ascontiguousarray(channels["p_chamber"], dtype=np.float64)
    lags = values["lag"] * (REFERENCE / np.maximum(true, LEAST_TAP_PRESSURE)) ** values["thinning"]
    return {**channels, "p_chamber": lagged(np.ascontiguousarray(times, dtype=np.float64), true, lags)}


EFFECT = Effect(
    name="chamber_tap_lag",
    plain_name="chamber pressure that is read late",
    equation="sensor",
    meaning="the chamber's pressure transducer lags behind, at the end of a tap and tube",
    reference="Doebelin, Measurement Systems, chapters 3 and 6: first-order lag of transducer and tubing; Bergh and "
    "Tijdeman, NLR-TR F.238 (1965), for the tube itself: a laminar one fills the slower the thinner the gas (k = 1), "
    "an orifice by the root (k = 1/2), a transducer lags alike at any pressure (k = 0)",
    formula="tau dp_read/dt = p_c - p_read,  tau = lag (10 bar / p_c)^k",
    sites=("p_chamber",),
    parameters=(
        Parameter("lag", "s", "time constant of tap, tube and transducer at 10 bar", typical=0.03, low=0.0, high=2.0),
        Parameter(
            "thinning", "-", "power with which it grows as the pressure falls", 0.35, center=0.5, low=0.0, high=1.0
        ),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    distort=_distort,
    far_starts=(0.15,),  # while the channel rises a small lag is a later opening
    twins=("nozzle_throat_erosion",),
    decisive="a second transducer flush with the chamber's wall, or the throat's diameter after the test",
    believable=Believable(
        "lag", 0.5, "a tap and a tube of a meter lag some hundredths of a second", unit="ms", factor=1e3
    ),
)
