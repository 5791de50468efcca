"""Logs whose phases are known exactly: what tells how often the intervals of the phases hold (benchmarks/phases.py).

As simulated/stand.py, but the fire fades as it likes, nitrogen comes when it likes, and loggers are from slow to fast.
What the search assumes of a fade or of a line that fills is not what is drawn here.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from math import inf, nan, pi, sqrt
from pathlib import Path

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.signal import lfilter
from scipy.special import betainc
from simulated.stand import AMBIENT, HOLE_AREA, PSI, Array, Truth, draw_truth, empties, noise

from hfanalysis.products.segments import EVENTS
from hfanalysis.record.definition import FileSpec, LogSpec, Test, TestDefinition
from hfanalysis.record.log import Channel, TestLog
from hfanalysis.record.sections import Injector, NozzleSection, Purge, Site, Tank
from hfanalysis.units import Value

STEP = 1e-4
LONGEST = 25.0
RATES = (20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0)
BITS = (0, 0, 10, 12, 16)
FUELS = ("before", "before", "before", "with", "after", "left")
PURGES = ("late", "late", "early", "absent")
FULL_SCALE = 100e5
CHARACTERISTIC_VELOCITY = 1400.0
CLOSE = 1.80 * AMBIENT
SMOOTH = 0.06
APART = 1.0


@dataclass(frozen=True)
class Drawn:
    """What kind of log it is: ``fade`` [s] of the fire, ``lag`` [s] of the pressures, ``jitter`` of the samples' times
    [periods], ``bits`` of the readings (0: none lost), ``slow`` noise over white, ``taken`` of the ``firings``."""

    rate: float
    jitter: float
    bits: int
    slow: float
    lag: float
    fuel: str
    fade: float
    purge: str
    firings: int
    taken: int


@dataclass(frozen=True)
class Case:
    """A log, what its engineer states, what kind it is, and when its events are [s after the opening] (None: never)."""

    log: TestLog
    definition: TestDefinition
    drawn: Drawn
    truth: dict[str, float | None]


@dataclass(frozen=True)
class _Firing:
    """Histories [SI] every STEP from the opening on, at rest before it, and its events [s]."""

    stand: Truth
    rest: dict[str, float]
    curves: dict[str, Array]
    truth: dict[str, float | None]


def draw(seed: int) -> Case:
    """A log; the same for the same seed."""
    rng = np.random.default_rng([20261128, seed])
    drawn = _drawn(rng)
    one = [_firing(rng, drawn) for _ in range(drawn.firings)]
    taken = one[drawn.taken - 1]
    return Case(_log(rng, drawn, one), _stated(rng, drawn, taken.stand), drawn, taken.truth)


def _drawn(rng: np.random.Generator) -> Drawn:
    firings = 2 if rng.random() < 0.2 else 1
    return Drawn(
        rate=float(rng.choice(RATES)),
        jitter=float(rng.choice([0.0, 0.0, 0.3])),
        bits=int(rng.choice(BITS)),
        slow=float(rng.choice([0.0, 0.1, 0.3])),
        lag=float(rng.choice([0.0, rng.uniform(0.0, 2e-3)])),
        fuel=str(rng.choice(FUELS)),
        fade=float(np.exp(rng.uniform(np.log(0.03), np.log(2.0)))),
        purge=str(rng.choice(PURGES)),
        firings=firings,
        taken=int(rng.integers(1, firings + 1)),
    )


def _firing(rng: np.random.Generator, drawn: Drawn) -> _Firing:
    """The first engine drawn that is over in time."""
    while True:
        stand = draw_truth(rng)
        fired = _fired(rng, drawn, replace(stand, rate=drawn.rate))
        if fired is not None:
            return fired


def _fired(rng: np.random.Generator, drawn: Drawn, stand: Truth) -> _Firing | None:
    time = STEP * np.arange(int(LONGEST / STEP))
    lights, drift, flush = rng.uniform(0.05, 0.4), rng.uniform(-0.2, 0.2), rng.uniform(0.002, 0.01)
    burning = stand.chamber_slope * (1.0 - 0.7 * np.exp(-time / lights)) * (1.0 + drift * time / 10.0)
    full = 1.0 - np.exp(-time / stand.fill_time)
    *_, t_v, _, _ = empties(stand, burning, full, STEP, (inf, nan, inf), flush)
    if not 1.0 < t_v < LONGEST - 10.0:
        return None
    out = {"before": rng.uniform(0.3, 0.9) * t_v, "with": t_v + rng.uniform(-0.05, 0.05), "left": inf}.get(
        drawn.fuel, t_v + rng.uniform(0.1, 1.0)
    )
    gone = np.clip((time - out) / drawn.fade, 0.0, 1.0) if out < inf else np.zeros(time.size)
    share = betainc(*np.exp(rng.uniform(-0.2, 0.7, 2)), gone)
    slope = burning * (1.0 - (1.0 - rng.uniform(0.2, 0.45)) * share)
    late = {"early": t_v - rng.uniform(0.1, 1.0), "absent": inf}.get(drawn.purge, nan)
    shut = t_v + rng.uniform(1.0, 5.0)
    full = full * np.exp(-np.maximum(time - shut, 0.0) / rng.uniform(0.01, 0.1))
    fades = rng.uniform(1.0, 6.0)
    flow, t_v, t_purge, at_purge = empties(stand, slope, full, STEP, (rng.uniform(0.25, 1.0), late, fades), flush)
    if not t_v < shut:
        return None
    return _sensed(stand, drawn, time, flow, (t_v, t_purge, at_purge, fades, out))


def _sensed(
    stand: Truth, drawn: Drawn, time: Array, flow: Array, times: tuple[float, float, float, float, float]
) -> _Firing:
    t_v, t_purge, at_purge, fades, out = times
    tank, run, chamber, mass, _ = flow
    supply = (at_purge or float(tank[0])) + stand.cracking
    sag = 0.3 * (1.0 - np.exp(-np.maximum(time - t_purge, 0.0) / (0.3 * fades)))
    curves = {"p_tank": tank, "p_run": run, "p_chamber": chamber, "p_purge": supply * (1.0 - sag)}
    rest = {"p_tank": float(tank[0]), "p_run": AMBIENT, "p_chamber": AMBIENT, "p_purge": supply, "thrust": 0.0}
    truth = {
        "t_feed": _full(time, run, t_v), "t_v": t_v, "t_purge": t_purge if t_purge < LONGEST else None,
        "t_fuel_out": out if out < inf else None, "t_fuel_gone": out + drawn.fade if out < inf else None,
        "t_end": _unchoked(time, chamber),
    }  # fmt: skip
    curves = {name: _lagged(curve, rest[name], drawn.lag) for name, curve in curves.items()}
    throat = CHARACTERISTIC_VELOCITY / stand.chamber_slope
    curves["thrust"] = 1.4 * throat * np.maximum(chamber - AMBIENT, 0.0)
    curves["m_tank"], rest["m_tank"] = mass, stand.mass
    return _Firing(stand, rest, curves, truth)


def _full(time: Array, run: Array, t_v: float) -> float:
    """When the line, smoothed, first reaches 98 % of its maximum before t_v: t_feed as it is defined."""
    smooth = uniform_filter1d(run[time < t_v], round(SMOOTH / STEP), mode="nearest")
    return float(time[int(np.argmax(smooth >= 0.98 * smooth.max()))])


def _unchoked(time: Array, chamber: Array) -> float | None:
    """When the chamber is below 1.8 times ambient for good: for a second at least; what comes then is purge gas."""
    above = np.flatnonzero(chamber > CLOSE)
    if not above.size:
        return None
    runs = np.split(above, np.flatnonzero(np.diff(above) * STEP > APART) + 1)
    last = max(runs, key=lambda run: float((chamber[run] - CLOSE).sum()))[-1]
    return float(time[last]) if last < time.size - round(APART / STEP) else None


def _lagged(curve: Array, rest: float, lag: float) -> Array:
    """As a sensor of a time constant [s] reads it."""
    if not lag:
        return curve
    part = 1.0 - np.exp(-STEP / lag)
    return np.asarray(rest + lfilter([part], [1.0, part - 1.0], curve - rest))


def _log(rng: np.random.Generator, drawn: Drawn, fired: list[_Firing]) -> TestLog:
    """All firings one after another, each with its rest before it, as the logger has them."""
    times, values = [], {name: [] for name in fired[0].curves}  # type: ignore[var-annotated]
    at = rng.uniform(-0.5, 0.5)
    for firing in fired:
        ends = firing.truth["t_end"] or LONGEST - 1.0
        last = min(max(x for x in firing.truth.values() if x is not None), LONGEST - 1.0)
        last = max(last, min(ends, LONGEST - 1.0)) + rng.uniform(2.0, 5.0)
        before = rng.uniform(3.0, 8.0)
        after = np.arange(-before, min(last, LONGEST - 0.1), 1.0 / drawn.rate)
        after = after + drawn.jitter * rng.uniform(-0.5, 0.5, after.size) / drawn.rate
        times.append(at + before + after)
        at = float(times[-1][-1]) + rng.uniform(3.0, 8.0)
        grid = STEP * np.arange(firing.curves["p_tank"].size)
        for name, curve in firing.curves.items():
            values[name].append(np.where(after < 0.0, firing.rest[name], np.interp(after, grid, curve)))
    if len(fired) > 1:
        _between(times, values, drawn.rate, fired[1].rest)
    time = np.concatenate(times)
    channels = {name: _channel(rng, drawn, fired[0].stand, name, time, np.concatenate(v)) for name, v in values.items()}
    return TestLog(channels)


def _between(times: list[Array], values: dict[str, list[Array]], rate: float, rest: dict[str, float]) -> None:
    """The pause, in which the stand is made ready again."""
    pause = np.arange(times[0][-1] + 1.0 / rate, times[1][0], 1.0 / rate)
    part = np.linspace(0.0, 1.0, pause.size)
    times.insert(1, pause)
    for name, parts in values.items():
        until = 0.7 if name in ("p_tank", "p_purge", "m_tank") else 0.1
        share = np.clip(part / until, 0.0, 1.0)
        parts.insert(1, parts[0][-1] + share * (rest[name] - parts[0][-1]))


def _channel(rng: np.random.Generator, drawn: Drawn, stand: Truth, name: str, time: Array, value: Array) -> Channel:
    pressure = name.startswith("p_")
    if name == "p_chamber":
        phase = 2.0 * pi * np.cumsum(rng.uniform(20.0, 80.0) + 5.0 * rng.standard_normal(time.size)) / drawn.rate
        value = value + stand.oscillation * (value - AMBIENT) * np.sin(phase)
    unit = PSI if pressure else 5.0 if name == "thrust" else 0.1
    white = stand.white / PSI * unit if pressure else unit
    bias = 2.0 * unit * rng.standard_normal() if pressure else 0.0
    read = value + bias + noise(rng, time.size, drawn.rate, white, (drawn.slow * white) ** 2)
    if drawn.bits and pressure:
        step = FULL_SCALE / 2**drawn.bits
        read = np.round(read / step) * step
    accuracy = 2.0 * PSI if pressure else unit
    flags = np.zeros(time.size, dtype=np.uint8)
    return Channel(
        name, "Pa" if pressure else "N" if name == "thrust" else "kg", time, read, flags, accuracy, True, name
    )


def _stated(rng: np.random.Generator, drawn: Drawn, stand: Truth) -> TestDefinition:
    mass_std, volume_std = 0.004 * stand.mass, 0.002 * stand.volume
    throat = sqrt(CHARACTERISTIC_VELOCITY / stand.chamber_slope / pi)
    return TestDefinition(
        Test("T", "hot_fire"),
        LogSpec((FileSpec("log.csv"),), firing=drawn.taken if drawn.firings > 1 else None),
        {},
        tank=Tank(
            Value(stand.volume + volume_std * rng.standard_normal(), volume_std),
            Value(stand.mass + mass_std * rng.standard_normal(), mass_std),
        ),
        injector=Injector(stand.holes, Value(HOLE_AREA)),
        purge=Purge(Value(stand.cracking)),
        nozzle=NozzleSection(Value(throat), Value(1.6 * throat)),
        site=Site(ambient_pressure=Value(AMBIENT, 0.0)),
        path=Path("T/test.toml"),
        sha256="0" * 64,
    )


def as_found(case: Case) -> dict[str, object]:
    """Truth and kind of a log beside what the search finds of it, as JSON has them."""
    from hfanalysis.segment.phases import find_phases

    found = find_phases(case.log, case.definition)
    events = {name: found.events[name].to_json() for name in EVENTS}
    return {"kind": asdict(case.drawn), "truth": case.truth, "found": events}
