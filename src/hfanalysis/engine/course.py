"""The course of a run: phases and events, step by step, in one compiled loop.

Phase changes are events: the end of the liquid, the end of the fuel, a rocket that falls back onto its pad, a
nozzle that unchokes, and the switches of effects. A step that passes one is shortened to end on it; equations
change only between steps.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from hfanalysis.engine.model import (
    ALTITUDE,
    CHAMBER_NITROGEN,
    COLD,
    COLD_ENERGY,
    COMPRESSIBILITY,
    ENTHALPY,
    EXIT_AREA,
    EXPONENT,
    FLIES,
    FUEL,
    IMPULSE,
    LAUNCH_ALTITUDE,
    NITROGEN,
    O_AMBIENT,
    O_CHAMBER_PRESSURE,
    O_GAMMA,
    OUTER_RADIUS,
    OUTPUTS,
    OXIDIZER,
    OXIDIZER_ENTHALPY,
    PAD,
    POLYTROPIC_EXPONENT,
    RADIUS,
    SPEED,
    STATES,
    TANK,
    TEMPERATURE,
    THROAT_AREA,
    VOLUME,
    Table,
    Tables,
    Work,
    rates,
)
from hfanalysis.engine.nozzle import mach_at_area, pressure_ratio
from hfanalysis.engine.rosenbrock import (
    DENSE,
    GAMMA,
    STAGES,
    TIME,
    TIME_SLOPE,
    A,
    C,
    factorize,
    interpolate,
    substitute,
)
from hfanalysis.engine.sites import (
    ENVIRONMENT,
    PARAMETERS_AT,
    SITES,
    STATES_AT,
    SWITCH_ADDRESS,
    THROAT_FACTOR,
    call_switch,
)
from hfanalysis.engine.tank import SPECIFIC_GAS_CONSTANT, liquid_mass
from hfanalysis.thermo.saturation import LN_PRESSURE, LN_VAPOR_CP, LN_VAPOR_CV, evaluate

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

SCALES = np.array([1e-2, 1e-1, 1e-4, 1e-6, 1e-6, 1e-1, 1e-2, 1.0, 1e-3, 1e-6, 1.0, 1e-6, 1e-1, 1e-3, 1e-3])
"""What counts as small of each state [SI]: absolute tolerances are the relative one times this."""

LIQUID_OUT, FUEL_OUT, GROUND, CHOKING = range(4)
"""Events of the engine; those from OWN_EVENTS on are the switches of its terms."""
OWN_EVENTS = 4

REACHED_END, BURNT_OUT, GIVEN_UP, STUCK = range(4)
"""How a run ends."""

MOST_STEPS = 8000
"""Steps after which an engine is given up; a burn takes about a hundred."""

FIRST_STEP = 1e-5
"""Seconds; after an event a step begins anew with ten times this at most."""

LEAST_STEP = 1e-13

INCREMENT = 1e-7
"""Relative to a state, or to its scale: the difference with which Jacobians are formed."""


@njit(cache=True, error_model="numpy")
def active_states(c: Array, y: Array, liquid: bool, burning: bool, terms: Integers) -> Integers:
    """Indices of the states that move in a phase; the others stay, and the linear algebra is spared them."""
    out = np.empty(y.size, dtype=np.int64)
    n = 0
    for i in range(y.size):
        moves = i in (TANK, TEMPERATURE, OXIDIZER, FUEL, IMPULSE) or i >= len(STATES)
        if i == RADIUS:
            moves = burning
        elif i in (ALTITUDE, SPEED):
            moves = c[FLIES] > 0.0
        elif i in (NITROGEN, CHAMBER_NITROGEN):
            moves = terms.shape[0] > 0
        elif i == ENTHALPY:
            moves = np.isnan(c[OXIDIZER_ENTHALPY])
        elif i in (COLD, COLD_ENERGY):
            moves = not burning
        if moves:
            out[n] = i
            n += 1
    return out[:n].copy()


@njit(cache=True, error_model="numpy")
def event_values(
    t: float, y: Array, liquid: bool, burning: bool, tables: Tables, c: Array, terms: Integers, work: Work, out: Array,
    values: Array,
) -> None:  # fmt: skip
    """Positive before an event and negative after (switches: either way); ``work`` and ``out`` are those of
    ``rates`` at ``y``."""
    values[LIQUID_OUT] = liquid_mass(tables[0], c[VOLUME], y[TANK], y[TEMPERATURE]) if liquid else 1.0
    values[FUEL_OUT] = c[OUTER_RADIUS] - y[RADIUS] if burning else 1.0
    values[GROUND] = y[ALTITUDE] - c[LAUNCH_ALTITUDE] + PAD if c[FLIES] > 0.0 else 1.0
    subsonic = mach_at_area(c[EXIT_AREA] / (c[THROAT_AREA] * work[1][THROAT_FACTOR]), out[O_GAMMA], False)
    values[CHOKING] = out[O_CHAMBER_PRESSURE] * pressure_ratio(subsonic, out[O_GAMMA]) - out[O_AMBIENT]
    for k in range(terms.shape[0]):
        address = terms[k, SWITCH_ADDRESS]
        value = 1.0
        if address != 0:
            value = call_switch(address, t, work[0], c, terms[k, PARAMETERS_AT], y, terms[k, STATES_AT])  # type: ignore[call-arg]
        values[OWN_EVENTS + k] = value


@njit(cache=True, error_model="numpy")
def change(event: int, c: Array, sat: Table, y: Array) -> None:
    """What an event does to the state."""
    if event == LIQUID_OUT:
        p = np.exp(evaluate(sat[0], sat[1], sat[2], sat[3], LN_PRESSURE, y[TEMPERATURE])[0])
        y[COMPRESSIBILITY] = p * c[VOLUME] / (y[TANK] * SPECIFIC_GAS_CONSTANT * y[TEMPERATURE])
        y[EXPONENT] = c[POLYTROPIC_EXPONENT]
        if np.isnan(y[EXPONENT]):
            cv = evaluate(sat[0], sat[1], sat[2], sat[3], LN_VAPOR_CV, y[TEMPERATURE])[0]
            cp = evaluate(sat[0], sat[1], sat[2], sat[3], LN_VAPOR_CP, y[TEMPERATURE])[0]
            y[EXPONENT] = np.exp(cp - cv)
    elif event == GROUND:
        y[ALTITUDE], y[SPEED] = c[LAUNCH_ALTITUDE], 0.0


@njit(cache=True, error_model="numpy")
def jacobian(
    t: float, y: Array, f: Array, active: Integers, scales: Array, liquid: bool, burning: bool, tables: Tables,
    c: Array, terms: Integers, work: Work, out: Array, moved: Array, jac: Array,
) -> None:  # fmt: skip
    """df/dy of the active states by forward differences; the impulse moves nothing."""
    moved[:] = 0.0
    for column in range(active.size):
        j = active[column]
        if j == IMPULSE:
            jac[:, column] = 0.0
            continue
        kept = y[j]
        step = INCREMENT * max(abs(kept), scales[j])
        y[j] = kept + step
        step = y[j] - kept
        rates(t, y, liquid, burning, tables, c, terms, work, moved, out)
        y[j] = kept
        for row in range(active.size):
            jac[row, column] = (moved[active[row]] - f[active[row]]) / step


@njit(cache=True, error_model="numpy")
def stages(
    t: float, y: Array, h: float, f: Array, slope: Array, jac: Array, active: Integers, liquid: bool, burning: bool,
    tables: Tables, c: Array, terms: Integers, work: Work, out: Array, u: Array, dy: Array,
    trial: Array, lu: Array, pivots: Integers,
) -> bool:  # fmt: skip
    """The eight stages ``u`` of a step and its result ``trial``; the last stage is the error. False: singular."""
    n = active.size
    for i in range(n):
        for j in range(n):
            lu[i, j] = -jac[i, j]
        lu[i, i] += 1.0 / (h * GAMMA)
    if not factorize(lu, pivots):
        return False
    for s in range(STAGES):
        trial[:] = y
        for k in range(s):
            if A[s, k] != 0.0:
                for i in range(n):
                    trial[active[i]] += A[s, k] * u[k, i]
        if s == 0:
            dy[:] = f
        else:
            rates(t + TIME[s] * h, trial, liquid, burning, tables, c, terms, work, dy, out)
        for i in range(n):
            total = dy[active[i]] + h * TIME_SLOPE[s] * slope[active[i]]
            for k in range(s):
                total += C[s, k] / h * u[k, i]
            u[s, i] = total
        substitute(lu, pivots, u[s])
    for i in range(n):
        trial[active[i]] += u[STAGES - 1, i]
    return True


@njit(cache=True, error_model="numpy")
def error_norm(y: Array, trial: Array, u: Array, active: Integers, scales: Array, rtol: float, counted: int) -> float:
    """Root mean square of the error in units of its tolerance; of the first ``counted`` states."""
    total, n = 0.0, 0
    for i in range(active.size):
        j = active[i]
        if j < counted:
            unit = rtol * (scales[j] + max(abs(y[j]), abs(trial[j])))
            total += (u[STAGES - 1, i] / unit) ** 2
            n += 1
    return float(np.sqrt(total / n))


@njit(cache=True, nogil=True, error_model="numpy")
def integrate(
    y0: Array, longest: float, run_on: bool, rtol: float, scales: Array, tables: Tables, c: Array, terms: Integers
) -> tuple[int, int, Array, Array, Array, Array, Array, Integers, Integers, Array, Integers]:
    """From ignition until the fuel is gone, or on to ``longest`` seconds where it is to ``run_on``.

    Returns how it ended, the number of steps n, and per step: times (n, 2) of start and end, states at start and end,
    outputs at start and end (before an event changes the equations), interpolants (n, 3, states), phases (n, 2: liquid,
    burning), the event at its end (-1: none); and the number of every event's last occurrence with its time.
    """
    size, kinds = y0.size, OWN_EVENTS + terms.shape[0]
    room = 256
    times, begin, end = np.empty((room, 2)), np.empty((room, size)), np.empty((room, size))
    outputs = np.empty((room, 2, len(OUTPUTS)))
    dense = np.zeros((room, 3, size))
    phases, events = np.empty((room, 2), dtype=np.int64), np.empty(room, dtype=np.int64)
    work, out = (np.zeros(len(ENVIRONMENT)), np.zeros(len(SITES))), np.zeros(len(OUTPUTS))
    f, g, trial, middle = np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size)
    moved, slope, later = np.zeros(size), np.zeros(size), np.zeros(size)
    before, after, values = np.ones(kinds), np.ones(kinds), np.ones(kinds)
    happened = np.full(kinds, np.nan)
    y = y0.copy()
    t, n, h, liquid, burning, ending = 0.0, 0, FIRST_STEP, True, True, REACHED_END
    counted = size
    active = active_states(c, y, liquid, burning, terms)
    u, jac = np.zeros((STAGES, active.size)), np.zeros((active.size, active.size))
    lu, pivots = np.zeros((active.size, active.size)), np.zeros(active.size, dtype=np.int64)
    rates(t, y, liquid, burning, tables, c, terms, work, f, out)
    event_values(t, y, liquid, burning, tables, c, terms, work, out, before)
    old_error, rejected, attempts = 1.0, False, 0
    fresh = True
    start_out = out.copy()
    while t < longest:
        if attempts > MOST_STEPS:
            ending = GIVEN_UP
            break
        attempts += 1
        if fresh:
            jacobian(t, y, f, active, scales, liquid, burning, tables, c, terms, work, out, moved, jac)
            slope[:] = 0.0
            if terms.shape[0] > 0:
                tick = 1e-6
                rates(t + tick, y, liquid, burning, tables, c, terms, work, later, out)
                for i in range(size):
                    slope[i] = (later[i] - f[i]) / tick
            fresh = False
        h = min(h, longest - t)
        if h < LEAST_STEP * max(1.0, t) and longest - t > LEAST_STEP * max(1.0, t) * 2.0:
            ending = STUCK
            break
        fine = stages(t, y, h, f, slope, jac, active, liquid, burning, tables, c, terms, work, out, u, g, trial,
                      lu, pivots)  # fmt: skip
        error = error_norm(y, trial, u, active, scales, rtol, counted) if fine else np.inf
        if not error <= 1.0:
            h *= max(0.2, 0.9 * error**-0.2) if np.isfinite(error) else 0.1
            rejected = True
            continue
        rates(t + h, trial, liquid, burning, tables, c, terms, work, g, out)
        event_values(t + h, trial, liquid, burning, tables, c, terms, work, out, after)
        event, theta = -1, 1.0
        # the interpolant, for events and for output
        if n == room:
            room *= 2
            times, begin, end = _longer(times, room), _longer(begin, room), _longer(end, room)
            outputs, dense = _longer3(outputs, room), _longer3(dense, room)
            more, more_events = np.empty((room, 2), dtype=np.int64), np.empty(room, dtype=np.int64)
            more[:n], more_events[:n] = phases, events
            phases, events = more, more_events
        _dense(u, active, dense[n])
        for k in range(kinds):
            passed = before[k] > 0.0 >= after[k] if k < OWN_EVENTS else before[k] * after[k] < 0.0
            if passed:
                low, high, low_value, high_value = 0.0, theta, before[k], after[k]
                if theta < 1.0:
                    interpolate(theta, y, trial, dense[n], middle)
                    rates(t + theta * h, middle, liquid, burning, tables, c, terms, work, moved, out)
                    event_values(t + theta * h, middle, liquid, burning, tables, c, terms, work, out, values)
                    high_value = values[k]
                    if low_value * high_value > 0.0:
                        continue
                for turn in range(60):
                    guess = (
                        low + (high - low) * low_value / (low_value - high_value)
                        if turn % 3 < 2
                        else 0.5 * (low + high)
                    )
                    guess = min(max(guess, low), high)
                    interpolate(guess, y, trial, dense[n], middle)
                    rates(t + guess * h, middle, liquid, burning, tables, c, terms, work, moved, out)
                    event_values(t + guess * h, middle, liquid, burning, tables, c, terms, work, out, values)
                    if values[k] * low_value > 0.0:
                        low, low_value = guess, values[k]
                    else:
                        high, high_value = guess, values[k]
                    if (high - low) * h < 1e-12 * max(1.0, t) or values[k] == 0.0:
                        break
                event, theta = k, high
        if event >= 0 and theta < 1.0:
            h *= theta
            stages(t, y, h, f, slope, jac, active, liquid, burning, tables, c, terms, work, out, u, g, trial, lu,
                   pivots)  # fmt: skip
            _dense(u, active, dense[n])
            rates(t + h, trial, liquid, burning, tables, c, terms, work, g, out)
            event_values(t + h, trial, liquid, burning, tables, c, terms, work, out, after)
        times[n, 0], times[n, 1] = t, t + h
        begin[n], end[n] = y, trial
        outputs[n, 0], outputs[n, 1] = start_out, out
        phases[n, 0], phases[n, 1], events[n] = int(liquid), int(burning), event
        n += 1
        t += h
        y[:], f[:] = trial, g
        beyond = -1e-300 if event >= 0 and before[event] > 0.0 else 1e-300
        before[:] = after
        start_out[:] = out
        fresh = True
        if event >= 0:
            happened[event] = t
            if event == FUEL_OUT:
                if not run_on:
                    ending = BURNT_OUT
                    break
                burning = False
            elif event == LIQUID_OUT:
                liquid = False
            change(event, c, tables[0], y)
            if burning and y[RADIUS] >= c[OUTER_RADIUS]:
                happened[FUEL_OUT] = t
                if not run_on:
                    ending = BURNT_OUT
                    break
                burning = False
            active = active_states(c, y, liquid, burning, terms)
            u, jac = np.zeros((STAGES, active.size)), np.zeros((active.size, active.size))
            lu, pivots = np.zeros((active.size, active.size)), np.zeros(active.size, dtype=np.int64)
            rates(t, y, liquid, burning, tables, c, terms, work, f, out)
            start_out[:] = out
            event_values(t, y, liquid, burning, tables, c, terms, work, out, before)
            if event >= CHOKING:
                before[event] = beyond  # by definition, or the same crossing would be found again
            if event != CHOKING:
                h = min(h, 10.0 * FIRST_STEP)
            old_error, rejected = 1.0, False
            continue
        factor = 0.9 * max(error, 1e-10) ** -0.14 * old_error**0.08
        h *= min(max(factor, 0.2), 1.0 if rejected else 6.0)
        old_error, rejected = max(error, 1e-4), False
    if ending == REACHED_END and n == 0:
        ending = STUCK
    return (ending, n, times[:n].copy(), begin[:n].copy(), end[:n].copy(), outputs[:n].copy(), dense[:n].copy(),
            phases[:n].copy(), events[:n].copy(), happened, active)  # fmt: skip


@njit(cache=True, error_model="numpy")
def _dense(u: Array, active: Integers, dense: Array) -> None:
    dense[:] = 0.0
    for i in range(active.size):
        for s in range(STAGES):
            for k in range(3):
                dense[k, active[i]] += DENSE[k, s] * u[s, i]


@njit(cache=True, error_model="numpy")
def _longer(rows: Array, room: int) -> Array:
    out = np.empty((room, rows.shape[1]))
    out[: rows.shape[0]] = rows
    return out


@njit(cache=True, error_model="numpy")
def _longer3(rows: Array, room: int) -> Array:
    out = np.zeros((room, rows.shape[1], rows.shape[2]))
    out[: rows.shape[0]] = rows
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def sample(
    at: Array, times: Array, begin: Array, end: Array, dense: Array, phases: Integers, tables: Tables, c: Array,
    terms: Integers,
) -> tuple[Array, Array]:  # fmt: skip
    """States and outputs at increasing times, from the steps' interpolants; the ends are held."""
    states, outputs = np.empty((at.size, begin.shape[1])), np.empty((at.size, len(OUTPUTS)))
    work, dy = (np.zeros(len(ENVIRONMENT)), np.zeros(len(SITES))), np.zeros(begin.shape[1])
    k, last = 0, times.shape[0] - 1
    for i in range(at.size):
        while k < last and at[i] > times[k, 1]:
            k += 1
        t = min(max(at[i], times[0, 0]), times[last, 1])
        theta = (t - times[k, 0]) / (times[k, 1] - times[k, 0])
        interpolate(theta, begin[k], end[k], dense[k], states[i])
        rates(t, states[i], phases[k, 0] == 1, phases[k, 1] == 1, tables, c, terms, work, dy, outputs[i])
    return states, outputs
