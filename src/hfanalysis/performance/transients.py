"""How a burn starts and ends: delays, rise, overshoot, and times and impulses by the usual definitions.

A rise is monotone and may have any shape; a fall is a rise backwards.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import medfilt

from hfanalysis.arrays import Array
from hfanalysis.flight.motor import OUT
from hfanalysis.performance.lag import pressure_lag
from hfanalysis.performance.measured import EARLY, Fire, bias
from hfanalysis.performance.thrust import Thrust, thrust_of
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import NORMAL_95, Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.segment.crossing import usual_noise

PLATEAU_TIME = 1.0
"""[s] after the rise whose median is the plateau. Source: by choice: a tank takes seconds to empty."""

RISEN = 0.8
"""Part of the usual pressure from which on it has risen."""

FIRST, LAST = 0.1, 0.9
"""Parts of the plateau between which a pressure rises. Source: the usual rise time."""

ACTION = 0.1
"""Part of the largest thrust between whose first and last passing the action time lies. Source: Sutton and Biblarz,
Rocket Propulsion Elements, figure of burning and action time: 10 % of the maximum."""

HARD = 0.5
"""[s] after the rise in which the largest pressure is the ignition's. Source: it comes of the fuel vapor and oxidizer
that gathered before; a chamber empties in milliseconds."""

ROUGH = 0.1
"""[s] over which a signal is smoothed for a first look."""

CHERNOFF = 0.52
"""Standard deviation of Chernoff's distribution [-]: of a monotone fit, in units of (4 noise^2 step slope)^(1/3).
Source: Groeneboom and Wellner, J. Computational and Graphical Statistics 10(2), 2001."""

MOVED = 1.0
"""Standard deviations of a sample by which the limit is moved to see the slope. Source: by choice."""

PHASES = ("liquid", "vapor", "nitrogen")
"""Of a burn, by what feeds it."""


def transients(log: TestLog, segments: Segments, definition: TestDefinition, fire: Fire) -> dict[str, Quantity]:
    """By name, each with a reason where a channel cannot give it [s, -, N s]."""
    chamber = _Chamber.of(log, segments)
    out = chamber.told(segments) if not isinstance(chamber, str) else _absent(OF_CHAMBER, chamber)
    out |= _drops(log, segments, fire)
    if "thrust" not in log:
        return out | _absent((*OF_THRUST, "pressure_lag"), log.lacks("thrust"))
    thrust = thrust_of(log, segments, definition)
    return out | _of_thrust(thrust, log, segments, fire) | {"pressure_lag": pressure_lag(log, segments, thrust, fire)}


OF_CHAMBER = ("ignition_delay", "rise_time", "ignition_overshoot")
OF_THRUST = ("action_time", "burn_time_5_percent", *(f"impulse_{name}" for name in PHASES), "tail_impulse")


def _drops(log: TestLog, segments: Segments, fire: Fire) -> dict[str, Quantity]:
    """Pressure drop over the injector as part of the chamber's pressure [-], mean of each phase."""
    names = tuple(f"injector_drop_{name}" for name in PHASES[:2])
    missing = [name for name in ("p_run", "p_chamber") if name not in log]
    if missing:
        return _absent(names, log.lacks(missing[0]))
    liquid, purge = (segments.time(name) for name in ("t_v", "t_purge"))
    ends = (segments.time("t_feed") or 0.0, fire.end if liquid is None else min(liquid, fire.end))
    spans = [ends, (ends[1], min(fire.end, fire.end if purge is None else purge))]
    return {name: _drop(log, segments, *span) for name, span in zip(names, spans, strict=True)}


def _drop(log: TestLog, segments: Segments, start: float, end: float) -> Quantity:
    run, chamber = (Signal.of(log[name]).shifted(segments.t_open.value or 0.0) for name in ("p_run", "p_chamber"))
    part = chamber.between(start, end)
    if end - start < ROUGH or part.time.size < 4 or run.time.size < 4:
        return Quantity.absent("the test has no such phase, or too few samples in it")
    drop, level = float((run.at(part.time) - part.value).mean()), float(part.value.mean())
    errors = bias(log["p_run"]) / level, bias(log["p_chamber"]) * (drop + level) / level**2
    return Quantity(drop / level, "", float(np.linalg.norm(errors)), why="(p_run - p_chamber) / p_chamber, means")


def _absent(names: tuple[str, ...], reason: str) -> dict[str, Quantity]:
    return {name: Quantity.absent(reason) for name in names}


@dataclass(frozen=True)
class _Chamber:
    """The chamber's pressure above what it reads at rest [Pa], with its ``plateau`` [Pa] and its deviation."""

    signal: Signal
    plateau: float
    plateau_std: float
    risen: float

    @classmethod
    def of(cls, log: TestLog, segments: Segments) -> _Chamber | str:
        """From a log; or why not."""
        if "p_chamber" not in log:
            return log.lacks("p_chamber")
        signal = Signal.of(log["p_chamber"]).shifted(segments.t_open.value or 0.0)
        rest = signal.between(-np.inf, 0.0)
        burn = signal.between(0.0, segments.time("t_end") or np.inf)
        if rest.time.size < 8 or burn.time.size < 8:
            return "p_chamber has too few samples before the opening or in the burn"
        signal = replace(signal, value=signal.value - float(rest.value.mean()))
        burn = replace(burn, value=burn.value - float(rest.value.mean()))
        # a burn that fades spends most of its time low: the upper half of its pressures is the plateau's
        usual = float(np.percentile(burn.value, 75.0))
        if usual < 5.0 * signal.noise:
            return "p_chamber does not rise above its noise"
        smooth = burn.smooth(max(ROUGH, 4.0 * burn.step))
        risen = float(burn.time[int(np.argmax(smooth > RISEN * usual))])
        part = signal.between(risen, risen + PLATEAU_TIME).value
        if part.size < 4:
            return "p_chamber has too few samples on its plateau"
        plateau, quarters = float(np.median(part)), np.subtract(*np.percentile(part, (75.0, 25.0)))
        noise = usual_noise(part)
        # which pressure the plateau is, is a matter of definition where it is not level
        level = float(np.sqrt(max(quarters**2 - (1.35 * noise) ** 2, 0.0) / 12.0))
        errors = (level, 1.25 * noise / np.sqrt(part.size), usual_noise(rest.value) / np.sqrt(rest.time.size))
        std = float(np.linalg.norm(errors))
        return cls(signal, plateau, std, risen)

    def told(self, segments: Segments) -> dict[str, Quantity]:
        """Delay and rise [s], overshoot [-]."""
        first, last = (self._passes(part) for part in (FIRST, LAST))
        opening = segments.t_open.std or 0.0
        return {
            "ignition_delay": Quantity(
                first[0], "s", float(np.hypot(first[1], opening)), why="opening to 10 % of the plateau of p_chamber"
            ),
            "rise_time": Quantity(
                last[0] - first[0],
                "s",
                float(np.hypot(first[1], last[1])),
                why="10 to 90 % of the plateau of p_chamber",
            ),
            "ignition_overshoot": self._overshoot(first[0]),
        }

    def _passes(self, part: float) -> tuple[float, float]:
        """When the rise passes a part of the plateau [s], and its standard deviation [s]."""
        limit = part * self.plateau
        before = self.signal.between(-ROUGH, self.risen + PLATEAU_TIME)
        top = float(before.time[int(np.argmax(before.smooth(max(0.02, 4.0 * before.step))))])
        before = before.between(-np.inf, max(top, self.risen + ROUGH))
        return rises(before, limit, part * self.plateau_std)

    def _overshoot(self, start: float) -> Quantity:
        """Largest pressure of the ignition over the plateau; whether a single sample belongs to it nobody can tell."""
        part = self.signal.between(start, self.risen + HARD)
        if part.time.size < 5:
            return Quantity.absent("too few samples in the ignition")
        noise, place = usual_noise(part.value), int(np.argmax(medfilt(part.value, 3)[1:-1])) + 1
        # the peak may lie between samples: higher by as much as its neighbors are lower
        beside = max(part.value[place] - min(part.value[place - 1], part.value[place + 1]), 0.0)
        near = part.value[np.abs(part.time - part.time[place]) < max(0.01, 1.5 * part.step)]
        peak = float(near.mean() if near.size > 3 else part.value[place])
        bent = (
            float(np.ptp(np.polyval(np.polyfit(np.arange(near.size), near, 1), (0, near.size - 1))))
            if near.size > 3
            else 0.0
        )
        value_std = peak / self.plateau * self.plateau_std
        std = float(
            np.linalg.norm(
                [noise / np.sqrt(max(near.size, 1)), 0.3 * beside if near.size <= 3 else 0.5 * bent, value_std]
            )
        )
        value, alone = max(peak / self.plateau, 0.0), float(part.value.max())
        low, high = value - NORMAL_95 * std / self.plateau, value + NORMAL_95 * std / self.plateau
        why = "largest of the ignition over the plateau of p_chamber"
        if alone > peak + 5.0 * max(noise, std):
            high, why = max(high, alone / self.plateau), f"{why}; a single sample reads {alone / self.plateau:.2f}"
        return Quantity(value, "", std / self.plateau, (max(low, 0.0), high), why=why)


def rises(part: Signal, limit: float, limit_std: float) -> tuple[float, float]:
    """When a signal rises through a limit, in its unit, that is known to ``limit_std``: [s], and its deviation [s].

    The rise is monotone, whatever its shape: the instant is where a monotone curve through the samples by least squares
    passes the limit, which is the one that best parts below from above.
    """
    noise = usual_noise(part.value)
    by = max(limit_std, MOVED * noise, 1e-9)
    early, at, late = (_parting(part, limit + sign * by) for sign in (-1.0, 0.0, 1.0))
    slope = 2.0 * by / max(late - early, 0.1 * part.step)
    scatter = CHERNOFF * (4.0 * noise**2 * part.step * slope) ** (1.0 / 3.0) / slope
    jump = np.interp(at + part.step, part.time, part.value) - np.interp(at - part.step, part.time, part.value)
    between = part.step * min(abs(jump) / abs(limit), 1.0) / np.sqrt(12.0)
    return at, float(np.linalg.norm([scatter, limit_std / slope, between]))


def _parting(part: Signal, limit: float) -> float:
    """The instant [s] that best parts what is below from what is above, between two samples by a straight line."""
    last = int(np.argmax(np.cumsum(limit - part.value)))
    if last + 1 >= part.time.size:
        return float(part.time[-1])
    low, high = part.value[last], part.value[last + 1]
    share = float(np.clip((limit - low) / (high - low), 0.0, 1.0)) if high > low else 0.5
    return float(part.time[last] + share * (part.time[last + 1] - part.time[last]))


def falls(part: Signal, limit: float, limit_std: float) -> tuple[float, float]:
    """When a signal falls through a limit for good: a rise backwards."""
    back = replace(part, time=-part.time[::-1], value=part.value[::-1])
    instant, std = rises(back, limit, limit_std)
    return -instant, std


def _of_thrust(thrust: Thrust, log: TestLog, segments: Segments, fire: Fire) -> dict[str, Quantity]:
    """Times by parts of the largest thrust, and the impulse of each phase."""
    burn = thrust.signal.between(-ROUGH, np.inf)
    if burn.time.size < 16:
        return _absent(OF_THRUST, "thrust has too few good samples")
    smooth = burn.smooth(max(ROUGH, 4.0 * burn.step))
    peak, zero = float(smooth.max()), bias(log["thrust"])
    if peak < 10.0 * burn.noise:
        return _absent(OF_THRUST, "the thrust does not rise above its noise")
    out = {
        "action_time": _between(
            burn, ACTION, peak, zero, "10 % of the largest thrust, first to last (Sutton and Biblarz)"
        ),
        "burn_time_5_percent": _between(burn, OUT, peak, zero, "5 % of the largest thrust, first to last (NFPA 1125)"),
    }
    return out | _impulses(thrust.signal, segments, fire, zero)


def _between(burn: Signal, part: float, peak: float, zero: float, why: str) -> Quantity:
    """Time [s] from the first to the last passing of a part of the ``peak`` [N]."""
    limit = part * peak
    smooth = burn.smooth(max(ROUGH, 4.0 * burn.step))
    top = float(burn.time[int(np.argmax(smooth))])
    if smooth[-1] > limit:
        return Quantity.absent(f"the log ends with {100.0 * smooth[-1] / peak:.0f} % of the largest thrust")
    first = rises(burn.between(-np.inf, top), limit, zero)
    last = falls(burn.between(top, np.inf), limit, zero)
    return Quantity(last[0] - first[0], "s", float(np.hypot(first[1], last[1])), why=why)


def _impulses(signal: Signal, segments: Segments, fire: Fire, zero: float) -> dict[str, Quantity]:
    """Impulse of each phase, and of all that comes after the liquid [N s]."""
    liquid, purge = (segments.time(name) for name in ("t_v", "t_purge"))
    if liquid is None:
        return _absent(OF_THRUST[2:], f"when the liquid is gone is not known: {segments.t_v.reason}")
    ends = {"liquid": liquid, "vapor": fire.end if purge is None else max(purge, liquid), "nitrogen": fire.end}
    out, start = {}, 0.0
    for name in PHASES:
        end = min(ends[name], fire.end)
        if name == "nitrogen" and purge is None:
            out["impulse_nitrogen"] = Quantity.absent("no nitrogen enters the tank")
            continue
        std = segments.std("t_v") if name != "nitrogen" else segments.std("t_purge")
        out[f"impulse_{name}"] = _impulse(signal, start, end, std, zero)
        start = end
    out["tail_impulse"] = replace(
        _impulse(signal, min(liquid, fire.end), fire.end, segments.std("t_v"), zero), why="after the liquid is gone"
    )
    return out


def _impulse(signal: Signal, start: float, end: float, std: float, zero: float) -> Quantity:
    """Integral of the thrust [N s] between two instants [s], one of them known to ``std`` [s]."""
    if not end > start:
        return Quantity(0.0, "N s", 0.0)
    if signal.time[-1] < end - EARLY:
        return Quantity.absent(f"the good samples of thrust end at {signal.time[-1]:.1f} s, before {end:.1f} s")
    whole = signal.bridged()
    time = np.concatenate(([start], whole.between(start, end).time[1:], [end]))
    value: Array = whole.at(time)
    at_edge = abs(float(whole.at(np.array([start if start > 0.0 else end]))[0]))
    error = float(np.hypot(zero * (end - start), at_edge * std))
    return Quantity(float(np.trapezoid(value, time)), "N s", error)
