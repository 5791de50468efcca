"""Make one case: draw the stand, set the strength by detectability, run it, and say what is true."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import kernel, nitrous
from . import sensors as se
from . import slots as s
from . import stand as st
from .detect import LIBRARY_NAMES, Detector, observed, rivals
from .effects import EFFECTS, Hidden, drawn, named_shape
from .plan import Case

Array = NDArray[np.float64]

HISTORY_STEP = 50
"""Milliseconds between the values of a recorded source (20 Hz)."""
ONSET = 0.05
"""Share of a source's peak at which it is said to begin."""


@dataclass(frozen=True)
class Built:
    """Everything about a case: what the engineer gets, and the answer."""

    case: Case
    stand: st.Stand
    instruments: se.Instruments
    hidden: tuple[Hidden, ...]
    true: st.Histories
    channels: Array
    log: se.Log
    detectability: dict[str, Any]
    weighed: dict[str, float]


BURNS_OUT = 0.15
"""Share of the stands whose fuel is gone early, whatever is hidden: burn-out must not give an effect away."""


def _needs(case: Case) -> dict[str, Any]:
    """What a stand must be like for the effect to exist at all."""
    out = np.random.default_rng([case.stand_seed, 2]).uniform() < BURNS_OUT
    return {"burns_out": out or "fuel_sliver" in case.effects, "purge": True if "n2_purge" in case.effects else None}


def build(case: Case) -> Built:
    """The same case from the same seeds, always."""
    rng = np.random.default_rng(case.stand_seed)
    stand = st.draw(rng, **_needs(case))
    instruments = se.draw(rng, case.family)
    all_rivals = rivals(rng)
    hidden = tuple(drawn(EFFECTS[name], rng) for name in case.effects)
    own = {h.effect.name: h for h in hidden}
    detector = Detector(stand, instruments, [own.get(r.effect.name, r) for r in all_rivals]) if hidden else None
    hidden = _set_strengths(detector, hidden, case)
    own_rng = np.random.default_rng([case.seed, 1])
    if case.second:
        stand, instruments = st.other_load(own_rng, stand), se.draw(own_rng, case.family)
        own = {h.effect.name: h for h in hidden}
        detector = Detector(stand, instruments, [own.get(r.effect.name, r) for r in all_rivals])
    channels, true = observed(stand, hidden)
    log = se.write_log(own_rng, stand, true, channels, instruments)
    fuel = stand.fuel_mass - float(true.trace(s.FUEL).sum()) * kernel.STEP
    weighed = {"oxidizer_mass": stand.mass + float(own_rng.normal(0.0, 0.01)),
               "fuel_mass_after": max(max(fuel, 0.0) + float(own_rng.normal(0.0, 0.005)), 0.0)}  # fmt: skip
    return Built(case, stand, instruments, hidden, true, channels, log, _detectability(detector, hidden), weighed)


def _set_strengths(detector: Detector | None, hidden: tuple[Hidden, ...], case: Case) -> tuple[Hidden, ...]:
    if detector is None:
        return ()
    names = [h.effect.name for h in hidden]
    among = {"outside": list(LIBRARY_NAMES)}.get(case.kind, [])
    out = []
    for h in hidden:
        others = [n for n in names if n != h.effect.name]
        # the library's part of what an outsider looks like is found at one strength and corrected at the next
        out.append(detector.solve(h, case.target, [*among, *others])[0])
    return tuple(out)


def _detectability(detector: Detector | None, hidden: tuple[Hidden, ...]) -> dict[str, Any]:
    """d' of all that is hidden, left against every rival, and (of two) of each given the other."""
    if detector is None:
        return {"d_prime": 0.0, "against": {}, "given_others": {}, "after_best_of_library": None}
    detector = detector.on_axis_of(hidden, detector.d_prime(hidden)[1])
    fit = detector.lowest(hidden)
    d = sqrt(fit.chi2)
    names = [h.effect.name for h in hidden]
    # a rival's column is at its nominal strength, its own shape; those of the hidden effects are the hidden ones
    against = {r: detector.against(fit, r) for r in detector.rivals if r not in names}
    given = {n: detector.against(fit, o) for n in names for o in names if o != n}
    library = min((v for r, v in against.items() if r in LIBRARY_NAMES), default=d)
    return {"d_prime": d, "against": against, "given_others": given, "after_best_of_library": min(library, d)}


PHASES = ("liquid", "vapor", "purge")


def phase_spans(b: Built) -> dict[str, tuple[float, float]]:
    """From and to [s]; purge is the part of the vapour phase in which nitrogen could enter."""
    t_v, end = b.true.t_v, b.stand.closing
    t_p = b.true.t_purge if np.isfinite(b.true.t_purge) else end
    return {"liquid": (0.0, t_v), "vapor": (t_v, max(t_v, t_p)), "purge": (max(t_v, t_p), end)}


def _apparent_tank_power(b: Built) -> Array:
    """Power [W] with which an equilibrium tank would show this pressure: dU/dt + mdot h_l at its temperature."""
    o, table = b.true.traces, nitrous.table()
    grid = nitrous.LOWEST + nitrous.STEP * np.arange(table.shape[1])
    t = np.interp(o[:, s.P_TANK], table[nitrous.P], grid)
    row = {
        k: np.interp(t, grid, table[k]) for k in (nitrous.RHO_L, nitrous.RHO_V, nitrous.U_L, nitrous.U_V, nitrous.H_L)
    }
    mass = o[:, s.M_TANK]
    v_l, v_v = 1.0 / row[nitrous.RHO_L], 1.0 / row[nitrous.RHO_V]
    x = (b.stand.volume / mass - v_l) / (v_v - v_l)
    energy = mass * (row[nitrous.U_L] + x * (row[nitrous.U_V] - row[nitrous.U_L]))
    power = np.gradient(energy, kernel.STEP) + o[:, s.TANK_FLOW] * row[nitrous.H_L]
    return np.where(b.true.time < b.true.t_v - 2 * kernel.STEP, power, 0.0)


def _partial_pressure(b: Built) -> Array:
    """Pressure in the tank beyond that of the nitrous oxide at its temperature [Pa], liquid phase."""
    o, table = b.true.traces, nitrous.table()
    grid = nitrous.LOWEST + nitrous.STEP * np.arange(table.shape[1])
    beyond = o[:, s.P_TANK] - np.interp(o[:, s.T_TANK], grid, table[nitrous.P])
    return np.where(b.true.time < b.true.t_v - 2 * kernel.STEP, beyond, 0.0)


def source(b: Built, hidden: Hidden) -> tuple[Array, str, str | None]:
    """What an effect does to its equation over time, at the true state; its unit; for sensors, the channel."""
    o, name = b.true.traces, hidden.effect.name
    if hidden.effect.distortion is not None:
        clean = o[:, : len(s.CHANNELS)]
        d = hidden.effect.distortion(clean, b.true, hidden.strength, hidden.shape) - clean  # type: ignore[arg-type]
        size = np.abs(d).max(axis=0) / [se.SIZE[se.UNITS[c]] for c in s.CHANNELS]
        i = int(np.argmax(size))
        return d[:, i], {"psi": "Pa", "lbf": "N", "kg": "kg"}[se.UNITS[s.CHANNELS[i]]], s.CHANNELS[i]
    if name in ("tank_nonequilibrium", "tank_stratification"):
        return _apparent_tank_power(b), "W", None
    if name == "dissolved_nitrogen":
        return _partial_pressure(b), "Pa", None
    made = {
        "tank_energy": lambda: (o[:, s.TANK_HEAT], "W"),
        "tank_volume": lambda: (o[:, s.TANK_SOURCE], "kg/s"),
        "injector": lambda: (o[:, s.FLOW] - o[:, s.FLOW_BASE], "kg/s"),
        "feed": lambda: (o[:, s.LOSS] - o[:, s.LOSS_BASE], "Pa"),
        "grain": lambda: (o[:, s.FUEL] - o[:, s.FUEL_BASE], "kg/s"),
        "chamber_mass": lambda: (o[:, s.CHAMBER_SOURCE], "kg/s"),
        "chamber_energy": lambda: (o[:, s.CHAMBER_POWER], "W"),
        "nozzle": lambda: (o[:, s.THRUST] - o[:, s.THRUST_BASE], "N"),
    }
    return *made[hidden.effect.equation](), None


def effect_record(b: Built, hidden: Hidden) -> dict[str, Any]:
    """One hidden effect: parameters, equation, source over time, when and in which phases."""
    values, unit, channel = source(b, hidden)
    values = np.where(b.true.time < b.stand.closing, values, 0.0) if channel is None else values
    size = np.abs(values)
    coarse = values[: len(values) // HISTORY_STEP * HISTORY_STEP].reshape(-1, HISTORY_STEP).mean(axis=1)
    peak = float(np.percentile(size, 99.5))
    active = np.flatnonzero(size > ONSET * peak) if peak > 0.0 else np.array([], dtype=int)
    time = b.true.time
    return {
        "name": hidden.effect.name,
        "inside_library": hidden.effect.inside,
        "strength": hidden.strength,
        "strength_unit": hidden.effect.unit,
        "at_most_plausible": hidden.strength >= hidden.effect.most,
        "shape": named_shape(hidden.shape),
        "equation": hidden.effect.equation,
        "equations_accepted": list(hidden.effect.equations),
        "citation": hidden.effect.source or None,
        "onset": float(time[active[0]]) if len(active) else None,
        "end": float(time[active[-1]]) if len(active) else None,
        "onset_kind": "step" if hidden.effect.sudden else "gradual",
        "phases": phases_of(b, size),
        "source": {"unit": unit, "channel": channel, "start": 0.5 * HISTORY_STEP * kernel.STEP,
                   "step": HISTORY_STEP * kernel.STEP, "values": [float(f"{v:.6g}") for v in coarse]},
    }  # fmt: skip


def phases_of(b: Built, size: Array) -> list[str]:
    """Phases with at least 15 % of the source's squared size, the strongest first."""
    square = {
        k: float((size[(b.true.time >= lo) & (b.true.time < hi)] ** 2).sum()) for k, (lo, hi) in phase_spans(b).items()
    }
    total = sum(square.values())
    return sorted((k for k in PHASES if total > 0.0 and square[k] >= 0.15 * total), key=lambda k: -square[k])


def answer(b: Built) -> dict[str, Any]:
    """All that is hidden."""
    o, x = b.true.traces, b.stand

    def instant(t: float) -> float | None:
        return float(t) if np.isfinite(t) else None

    return {
        "id": b.case.id, "kind": b.case.kind, "seed": b.case.seed, "stand_seed": b.case.stand_seed,
        "stand": b.case.stand,
        "effects": [effect_record(b, h) for h in b.hidden],
        "target_d_prime": b.case.target, **b.detectability,
        "noise": b.instruments.record(), "opening": b.log.t_open,
        "truth": {
            "C_i": x.C_i, "m": x.m, "a": x.a, "n": x.n, "K_loss": x.K_loss, "oxidizer_mass": x.mass,
            "temperature": x.temperature, "fuel_mass": x.fuel_mass, "volume": x.volume, "port_radius": x.port_radius,
            "throat_radius": x.throat_radius, "throat_radius_after": float(o[-1, s.THROAT]),
            "ambient_pressure": x.ambient,
            "t_v": instant(b.true.t_v), "t_purge": instant(b.true.t_purge), "t_fuel_out": instant(b.true.t_fuel_out),
            "t_close": x.closing, "total_impulse": float(o[:, s.THRUST].sum() * kernel.STEP),
            "p_chamber_peak": float(o[:, s.P_CHAMBER].max()), "thrust_peak": float(o[:, s.THRUST].max()),
            "fuel_mass_after": x.fuel_mass - float(o[:, s.FUEL].sum() * kernel.STEP),
            "phases": phase_spans(b),
        },
    }  # fmt: skip
