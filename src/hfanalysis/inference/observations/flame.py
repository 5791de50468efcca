"""Whether the chamber still burns, by its pressure over the flow: until when a model that burns says anything of it.

Fuel that ends together with the liquid, or fades for a second, leaves no fall of chamber pressure and thrust against
the feed that could be dated. But cold nitrous oxide has a fifth of the characteristic velocity: for the flow that
enters, the pressure of a chamber without a flame is a fifth of what it was.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.record.signals import Signal
from hfanalysis.thermo.saturation import Saturation

LOOK, SETTLED = 0.04, 0.3
"""Seconds between the instants that are looked at, and after the opening from which on it burns as it will."""

COLD, COLD_IN_LIQUID = 0.36, 0.55
"""Chamber pressure over flow, relative to what it was, below which there is no flame [-]; and while liquid flows, which
chokes no injector so suddenly. Source: c* is 340 m/s for
nitrous oxide at 270 K (sqrt(R T) / Gamma, gamma 1.3), 1300 to 1600 m/s in a flame, whose fuel adds a tenth to the
flow: 0.18 to 0.24 without a flame. A vapor that chokes in the injector, whose flow is then 0.53 of the incompressible
orifice's, leaves 0.5 of a flame's."""

FLOWING = 0.15
"""Part of the tank's pressure by which p_run has to exceed the chamber's for a flow to be told from it [-]."""

BURNING = 0.94
"""Of the ratio within the last BEFORE, down to which the chamber burns on as before [-]. Evidence: in worlds whose fuel
lasts (simulated/worlds, development set) the mixture moves it by less within that time."""

BEFORE = 0.6
"""Seconds."""

RANGE = 1e5, 70e5
"""Pressures [Pa] between which the table of nitrous oxide is asked."""

OVER, STANDS = 8, 0.2
"""Instants over which the tank's fall is taken, and the part of what it was below which it stands."""

FALLS = 3
"""Instants in a row without a flame."""

AT_LIQUID_OUT = 0.35
"""Seconds after the end of the liquid within which a flame that is out then went out with it, or before."""


@dataclass(frozen=True)
class FlameOut:
    """From when on the flame fades and when it is out [s after the opening]."""

    begins: float
    out: float

    @property
    def std(self) -> float:
        """Standard deviation [s] of the end of the fuel, which lies somewhere between."""
        return (self.out - self.begins) / float(np.sqrt(12.0))


def flame_out(
    tank: Signal, run: Signal, chamber: Signal, saturation: Saturation, t_v: float | None, end: float
) -> FlameOut | None:
    """When the flame goes out while oxidizer still flows; None where it does not, or where that cannot be told.

    Signals [Pa] with times after the opening; ``t_v`` and the ``end`` of what is looked at [s after the opening].
    """
    times = np.arange(SETTLED, min(end, *(float(s.time[-1]) for s in (tank, run, chamber))) - LOOK, LOOK)
    if times.size < 4 * FALLS:
        return None
    p_t, p_r, p_c = (_means(s, times) for s in (tank, run, chamber))
    wet = times < (np.inf if t_v is None else t_v)
    ratio = _over_flow(p_t, p_r, p_c, saturation, wet)
    usual = float(np.nanmedian(ratio[times < min(times[-1], t_v or np.inf, times[0] + 1.5)]))
    cold = np.nan_to_num(ratio, nan=np.inf) < np.where(wet, COLD_IN_LIQUID, COLD) * usual
    run_of = np.convolve(cold, np.ones(FALLS), mode="valid") == FALLS
    if not np.isfinite(usual) or not run_of.any():
        return None
    out = int(np.argmax(run_of))
    if not _flows_on(times, p_t, out):
        return None
    return FlameOut(_began(times, ratio, out, usual, t_v), float(times[out]))


def _flows_on(times: Array, p_t: Array, out: int) -> bool:
    """Whether the tank goes on emptying: a valve behind p_run that closes leaves a chamber without pressure as well."""
    back, ahead = max(out - OVER, 0), min(out + OVER, times.size - 1)
    if ahead <= out or back >= out:
        return False
    before = (p_t[back] - p_t[out]) / (times[out] - times[back])
    return bool((p_t[out] - p_t[ahead]) / (times[ahead] - times[out]) > STANDS * before)


def _began(times: Array, ratio: Array, out: int, usual: float, t_v: float | None) -> float:
    """From when on the ratio falls that is that of cold gas at ``out``; from the liquid's end at the latest,
    where it is so right after."""
    first = out
    if t_v is not None and 0.0 < times[out] - t_v < AT_LIQUID_OUT:
        first = max(int(np.searchsorted(times, t_v)) - 1, 1)
    while first > 1:
        window = ratio[(times >= times[first] - BEFORE) & (times < times[first])]
        if not np.isfinite(window).any() or ratio[first] > BURNING * np.nanmax(window):
            break
        first -= 1
    return float(times[first])


def _over_flow(p_t: Array, p_r: Array, p_c: Array, saturation: Saturation, wet: NDArray[np.bool_]) -> Array:
    """Chamber pressure over what the orifice passes, up to a constant (n,); nan where hardly anything flows."""
    temperature = saturation.temperature(np.clip(p_t, *RANGE))
    density = np.where(wet, saturation.liquid_density(temperature), saturation.vapor_density(temperature))
    drop = p_r - p_c
    flow = np.sqrt(density * np.maximum(drop, 1.0))
    return np.where(drop > FLOWING * p_t, p_c / flow, np.nan)


def _means(signal: Signal, times: Array) -> Array:
    """Means over LOOK about instants (n,); between samples that lie farther apart, by interpolation."""
    found = np.array([signal.mean(t - 0.5 * LOOK, t + 0.5 * LOOK) for t in times])
    missing = ~np.isfinite(found)
    found[missing] = signal.at(times[missing])
    return found
