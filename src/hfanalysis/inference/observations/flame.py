"""Whether the chamber still burns, by its pressure over the flow: until when a model that burns says anything of it.

Fuel that ends together with the liquid, or fades for a second, leaves no fall of chamber pressure and thrust against
the feed that could be dated. But cold nitrous oxide has a fifth of the characteristic velocity: for the flow that
enters, the pressure of a chamber without a flame is a fifth of what it was. Where that ratio falls to the end of the
log and does not come so low, nobody knows whether the chamber still burns: a flame is shown up to where the fall
begins.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

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

BEFORE, SHORTEST = 0.6, 0.5
"""Seconds; and the part of them for which the change of a mixture is taken at least, where fewer are there to see."""

RANGE = 1e5, 70e5
"""Pressures [Pa] between which the table of nitrous oxide is asked."""

OVER, STANDS = 8, 0.2
"""Instants over which the tank's fall is taken, and the part of what it was below which it stands."""

FALLS = 3
"""Instants in a row without a flame."""

FIRST = 1.5
"""Seconds over which the ratio of a flame is taken."""

SETTLES = 0.1
"""Seconds after the end of the liquid before the flow is that of vapor alone: knees are rounded."""

SMOOTH = 5
"""Instants over which the ratio is averaged before a fall that does not become cold is believed."""

CHOKED = 1.9
"""Chamber over ambient pressure below which its nozzle is not choked and the ratio no characteristic velocity [-].
Source: ((gamma + 1) / 2)^(gamma / (gamma - 1)), 1.8 for gamma 1.2 to 1.3, and a margin."""


@dataclass(frozen=True)
class FlameOut:
    """From when on the flame fades and when it is out [s after the opening]."""

    begins: float
    out: float

    @property
    def std(self) -> float:
        """Standard deviation [s] of the end of the fuel, which lies somewhere between."""
        return (self.out - self.begins) / float(np.sqrt(12.0))


LIQUID, SETTLING, VAPOR = range(3)
"""What flows at an instant; SETTLING: neither is known to, or not alone."""


@dataclass(frozen=True)
class OverFlow:
    """The chamber's pressure over what enters, up to a constant (n,), nan where hardly anything flows.

    ``times`` [s after the opening]; ``tank`` and ``chamber`` (n,) [Pa]; ``phase`` (n,): LIQUID, SETTLING or VAPOR.
    """

    times: Array
    tank: Array
    chamber: Array
    ratio: Array
    phase: NDArray[np.int64]

    @classmethod
    def of(
        cls, tank: Signal, run: Signal | None, chamber: Signal, saturation: Saturation, t_v: float | None, end: float
    ) -> OverFlow | None:
        """Of pressures [Pa] with times after the opening; None where too little is there to look at.

        Without ``run``, the pressure before the injector, that of the tank stands for it: what is lost between goes by
        the square of the flow as well, and the ratio is compared within one test. ``t_v`` and the ``end`` of what is
        looked at [s after the opening].
        """
        ahead = tank if run is None else run
        last = min(end, *(float(s.time[-1]) for s in (tank, ahead, chamber)))
        times = np.arange(SETTLED, last - LOOK, LOOK)
        if times.size < 4 * FALLS:
            return None
        p_t, p_r, p_c = (_means(s, times) for s in (tank, ahead, chamber))
        dry = np.inf if t_v is None else t_v
        ratio = _ratio(p_t, p_r, p_c, saturation, times < dry)
        return cls(times, p_t, p_c, ratio, (times >= dry) * SETTLING + (times >= dry + SETTLES) * (VAPOR - SETTLING))

    @property
    def usual(self) -> float:
        """The ratio of the flame at first, while liquid flows; nan where that is not known."""
        first = self.ratio[(self.phase == LIQUID) & (self.times < self.times[0] + FIRST)]
        return float(np.nanmedian(first)) if np.isfinite(first).any() else np.nan

    @property
    def wet(self) -> int:
        """How many of the instants come before the end of the liquid."""
        return int((self.phase == LIQUID).sum())

    def smooth(self) -> OverFlow:
        """The same with running means of the ratio, each over instants of one phase."""
        parts = [_running(self.ratio[self.phase == phase]) for phase in (LIQUID, SETTLING, VAPOR)]
        return replace(self, ratio=np.concatenate(parts))

    def falls(self, at: int, within: float = BEFORE) -> bool:
        """Whether the ratio has fallen to that of an instant by more than a mixture moves it ``within`` some seconds,
        in one phase."""
        before = self.ratio[self._before(at, within)]
        if self.phase[at] == SETTLING or not before.size:
            return False
        part = max(before.size * LOOK / BEFORE, SHORTEST)
        return bool(self.ratio[at] <= BURNING**part * before.max())

    def goes_on_falling(self, at: int) -> bool:
        """Whether it falls to that of an instant, and still does in the last of it."""
        return self.falls(at) and self.falls(at, SHORTEST * BEFORE)

    def _before(self, at: int, within: float) -> NDArray[np.intp]:
        """Instants of the same phase ``within`` some seconds before one, of which the ratio is known."""
        recent = (self.times[:at] >= self.times[at] - within) & (self.phase[:at] == self.phase[at])
        return np.flatnonzero(recent & np.isfinite(self.ratio[:at]))

    def began(self, at: int) -> int:
        """From when on the ratio falls that is low at an instant: from the end of the liquid, or before it, where the
        fall lasts longer than the flame has burnt with vapor, for that shows no flame that burnt evenly."""
        first = self._back(at)
        return self._in_liquid(first) if at - first >= self._with_vapor(first) else first

    def began_slowly(self, at: int) -> int:
        """As :meth:`began`, of a slow fall: it was begun at the top, before the ratio is low, and what burns with vapor
        for less time than shows a fall is not known to burn evenly."""
        first = self._back(at)
        top = self._before(first, BEFORE)
        first = int(top[np.argmax(self.ratio[top])]) if top.size else first
        least = max(at - first, SHORTEST * BEFORE / LOOK)
        return self._in_liquid(first) if least >= self._with_vapor(first) else first

    def _with_vapor(self, first: int) -> int:
        """Instants since the end of the liquid, if vapor alone is known to have flowed at one of them; 0 if not."""
        return first - self.wet if (self.phase[self.wet : first] == VAPOR).any() else 0

    def _in_liquid(self, first: int) -> int:
        """Where a fall begins that goes back to the end of the liquid; ``first`` where there is no liquid before it."""
        return self._back(self.wet - 1) if 1 < self.wet <= first else first

    def _back(self, at: int) -> int:
        while at > 1 and self.falls(at):
            at -= 1
        return at


def flame_out(seen: OverFlow) -> FlameOut | None:
    """When the flame goes out while oxidizer still flows; None where it does not, or where that cannot be told."""
    usual = seen.usual
    cold = np.nan_to_num(seen.ratio, nan=np.inf) < np.where(seen.phase == LIQUID, COLD_IN_LIQUID, COLD) * usual
    run_of = np.convolve(cold, np.ones(FALLS), mode="valid") == FALLS
    if not run_of.any():
        return None
    out = int(np.argmax(run_of))
    if not _flows_on(seen.times, seen.tank, out):
        return None
    return FlameOut(float(seen.times[seen.began(out)]), float(seen.times[out]))


def shown_to_burn(seen: OverFlow, ambient: float, end: float | None) -> float | None:
    """Until when a flame is shown [s after the opening], where the ratio falls to the end, or through the end of the
    liquid: a flow of liquid that fails is one of vapor then, and no longer falls. None where it burns on.

    ``ambient``: pressure [Pa]; ``end``: of the flow [s after the opening], if it is known.
    """
    even = seen.smooth()
    flows = even.times < (np.inf if end is None else end - LOOK)
    choked = np.flatnonzero(np.isfinite(even.ratio) & flows & (even.chamber > CHOKED * ambient))
    if not choked.size:
        return None
    last, with_liquid = int(choked[-1]), even.wet - 1
    if even.goes_on_falling(last):  # what a gauge lags behind the liquid's end falls at first only
        return float(even.times[even.began_slowly(last)])
    if not (0 < with_liquid < last and even.goes_on_falling(with_liquid)):
        return None
    through = any(even.goes_on_falling(at) for at in range(even.wet, last))
    return float(even.times[even.began_slowly(with_liquid)]) if through else None


def _flows_on(times: Array, p_t: Array, out: int) -> bool:
    """Whether the tank goes on emptying: a valve behind p_run that closes leaves a chamber without pressure as well."""
    back, ahead = max(out - OVER, 0), min(out + OVER, times.size - 1)
    if ahead <= out or back >= out:
        return False
    before = (p_t[back] - p_t[out]) / (times[out] - times[back])
    return bool((p_t[out] - p_t[ahead]) / (times[ahead] - times[out]) > STANDS * before)


def _ratio(p_t: Array, p_r: Array, p_c: Array, saturation: Saturation, wet: NDArray[np.bool_]) -> Array:
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


def _running(values: Array) -> Array:
    """Running means (n,) over SMOOTH values, fewer at the ends; nan where none of them is known."""
    known = np.isfinite(values)
    if not values.size:
        return values
    kernel = np.ones(SMOOTH)
    count = np.convolve(known, kernel, mode="full")[SMOOTH // 2 :][: values.size]
    total = np.convolve(np.where(known, values, 0.0), kernel, mode="full")[SMOOTH // 2 :][: values.size]
    return np.where(known, total / np.maximum(count, 1.0), np.nan)
