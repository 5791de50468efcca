"""Sensitivities of a run: how every state and output moves with every parameter, right through the events.

Along a finished run the variational equation S' = f_y S + f_p is linear. It is integrated over the run's own steps
by the three-stage Radau IIA method (order 5, stiffly accurate); f_y and f_p are forward differences of the same
compiled equations at the nodes, so that outputs' sensitivities out_y S + out_p come along. Where an event g(y, p) =
0 changes the equations, its time moves by dt = -(g_y S + g_p) / (g_y f + g_t), and S jumps by change_y (S + f dt) +
change_p - f_after dt.

A parameter is anything that changes the engine's constants or its initial state: it is given as a second set of them.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from hfanalysis.engine.course import INCREMENT, OWN_EVENTS, change, event_values
from hfanalysis.engine.model import ALTITUDE, FLIES, IMPULSE, OUTPUTS, SPEED, Tables, Work, rates
from hfanalysis.engine.rosenbrock import factorize, interpolate, substitute
from hfanalysis.engine.sites import ENVIRONMENT, SITES

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

_ROOT = np.sqrt(6.0)
NODES = np.array([(4.0 - _ROOT) / 10.0, (4.0 + _ROOT) / 10.0, 1.0])
RADAU = np.array(
    [
        [(88.0 - 7.0 * _ROOT) / 360.0, (296.0 - 169.0 * _ROOT) / 1800.0, (-2.0 + 3.0 * _ROOT) / 225.0],
        [(296.0 + 169.0 * _ROOT) / 1800.0, (88.0 + 7.0 * _ROOT) / 360.0, (-2.0 - 3.0 * _ROOT) / 225.0],
        [(16.0 - _ROOT) / 36.0, (16.0 + _ROOT) / 36.0, 1.0 / 9.0],
    ]
)
"""Radau IIA, order 5 (Hairer and Wanner, Solving Ordinary Differential Equations II, table IV.5.6)."""


@njit(cache=True, error_model="numpy")
def linearize(
    t: float, y: Array, liquid: bool, burning: bool, tables: Tables, c: Array, shifted: Array, steps: Array,
    used: Integers, scales: Array, terms: Integers, work: Work, f: Array, out: Array, moved: Array, moved_out: Array,
    f_y: Array, f_p: Array, out_y: Array, out_p: Array,
) -> None:  # fmt: skip
    """f, f_y (of the ``used`` states), f_p and the same of the outputs, by forward differences."""
    rates(t, y, liquid, burning, tables, c, terms, work, f, out)
    for column in range(used.size):
        j = used[column]
        kept = y[j]
        step = INCREMENT * max(abs(kept), scales[j])
        y[j] = kept + step
        step = y[j] - kept
        rates(t, y, liquid, burning, tables, c, terms, work, moved, moved_out)
        y[j] = kept
        for i in range(y.size):
            f_y[i, column] = (moved[i] - f[i]) / step
        for i in range(out.size):
            out_y[i, column] = (moved_out[i] - out[i]) / step
    for k in range(steps.size):
        rates(t, y, liquid, burning, tables, shifted[k], terms, work, moved, moved_out)
        for i in range(y.size):
            f_p[i, k] = (moved[i] - f[i]) / steps[k]
        for i in range(out.size):
            out_p[i, k] = (moved_out[i] - out[i]) / steps[k]


@njit(cache=True, error_model="numpy")
def used_states(size: int, flies: bool) -> Integers:
    """All states but the impulse, on which nothing depends, and on a stand the rocket's."""
    out = np.empty(size, dtype=np.int64)
    n = 0
    for i in range(size):
        if i == IMPULSE or (i in (ALTITUDE, SPEED) and not flies):
            continue
        out[n] = i
        n += 1
    return out[:n].copy()


@njit(cache=True, nogil=True, error_model="numpy")
def propagate(
    times: Array, begin: Array, end: Array, dense: Array, phases: Integers, events: Integers, tables: Tables, c:
    Array, shifted: Array, steps: Array, scales: Array, terms: Integers, start: Array, ) -> tuple[Array, Array,
    Array]:  # fmt: skip
    """Sensitivities at four nodes of every step (its start and NODES) and of the event times.

    ``shifted`` (parameters, constants) are the constants with each parameter moved by ``steps``, ``start`` (states,
    parameters) the sensitivities of the initial state. Returns those of the states (n, 4, states, parameters), of the
    outputs (n, 4, outputs, parameters), and of the time of the event at each step's end (n, parameters; 0 without
    one).
    """
    count, size, number = times.shape[0], begin.shape[1], steps.size
    outs = len(OUTPUTS)
    states = np.zeros((count, 4, size, number))
    outputs = np.zeros((count, 4, outs, number))
    moments = np.zeros((count, number))
    used = used_states(size, c[FLIES] > 0.0)
    m = used.size
    s = start.copy()
    work = (np.zeros(len(ENVIRONMENT)), np.zeros(len(SITES)))
    f, out, moved, moved_out, y = np.zeros(size), np.zeros(outs), np.zeros(size), np.zeros(outs), np.zeros(size)
    f_y, f_p = np.zeros((4, size, m)), np.zeros((4, size, number))
    out_y, out_p = np.zeros((4, outs, m)), np.zeros((4, outs, number))
    matrix, pivots = np.zeros((3 * m, 3 * m)), np.zeros(3 * m, dtype=np.int64)
    stage = np.zeros(3 * m)
    for n in range(count):
        t, h = times[n, 0], times[n, 1] - times[n, 0]
        liquid, burning = phases[n, 0] == 1, phases[n, 1] == 1
        restarted = n == 0 or events[n - 1] >= 0
        if restarted:
            y[:] = begin[n]
            linearize(t, y, liquid, burning, tables, c, shifted, steps, used, scales, terms, work, f, out, moved,
                      moved_out, f_y[3], f_p[3], out_y[3], out_p[3])  # fmt: skip
        states[n, 0] = s
        _outputs_of(s, used, out_y[3], out_p[3], outputs[n, 0])
        for k in range(3):
            interpolate(NODES[k], begin[n], end[n], dense[n], y)
            linearize(t + NODES[k] * h, y, liquid, burning, tables, c, shifted, steps, used, scales, terms, work, f,
                      out, moved, moved_out, f_y[k], f_p[k], out_y[k], out_p[k])  # fmt: skip
        for a in range(3):
            for b in range(3):
                for i in range(m):
                    for j in range(m):
                        matrix[a * m + i, b * m + j] = -h * RADAU[a, b] * f_y[b, used[i], j]
            for i in range(m):
                matrix[a * m + i, a * m + i] += 1.0
        factorize(matrix, pivots)
        for p in range(number):
            for a in range(3):
                for i in range(m):
                    total = s[used[i], p]
                    for b in range(3):
                        total += h * RADAU[a, b] * f_p[b, used[i], p]
                    stage[a * m + i] = total
            substitute(matrix, pivots, stage)
            for a in range(3):
                states[n, a + 1, :, p] = s[:, p]
                for i in range(m):
                    states[n, a + 1, used[i], p] = stage[a * m + i]
            # the impulse: a quadrature
            for a in range(3):
                total = s[IMPULSE, p]
                for b in range(3):
                    rate = f_p[b, IMPULSE, p]
                    for j in range(m):
                        rate += f_y[b, IMPULSE, j] * stage[b * m + j]
                    total += h * RADAU[a, b] * rate
                states[n, a + 1, IMPULSE, p] = total
        s[:] = states[n, 3]
        for a in range(3):
            _outputs_of(states[n, a + 1], used, out_y[a], out_p[a], outputs[n, a + 1])
        f_y[3], f_p[3], out_y[3], out_p[3] = f_y[2], f_p[2], out_y[2], out_p[2]
        if events[n] >= 0:
            y[:] = end[n]
            _through_event(times[n, 1], y, events[n], liquid, burning, n + 1 < count, begin[min(n + 1, count - 1)],
                           phases[min(n + 1, count - 1)], tables, c, shifted, steps, scales, terms, work, s,
                           moments[n])  # fmt: skip
    return states, outputs, moments


@njit(cache=True, error_model="numpy")
def _outputs_of(s: Array, used: Integers, out_y: Array, out_p: Array, result: Array) -> None:
    for o in range(out_y.shape[0]):
        for p in range(s.shape[1]):
            total = out_p[o, p]
            for j in range(used.size):
                total += out_y[o, j] * s[used[j], p]
            result[o, p] = total


@njit(cache=True, error_model="numpy")
def _through_event(
    t: float, y: Array, event: int, liquid: bool, burning: bool, goes_on: bool, y_after: Array, phase_after: Integers,
    tables: Tables, c: Array, shifted: Array, steps: Array, scales: Array, terms: Integers, work: Work, s: Array,
    moment: Array,
) -> None:  # fmt: skip
    """Move ``s`` across an event, and tell how its time moves."""
    size, number, kinds = y.size, steps.size, OWN_EVENTS + terms.shape[0]
    f, f_after, dy, out = np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(len(OUTPUTS))
    here, there = np.ones(kinds), np.ones(kinds)
    rates(t, y, liquid, burning, tables, c, terms, work, f, out)
    event_values(t, y, liquid, burning, tables, c, terms, work, out, here)
    g_y = np.zeros(size)
    for i in range(size):
        if i == IMPULSE:
            continue
        kept = y[i]
        step = INCREMENT * max(abs(kept), scales[i])
        y[i] = kept + step
        rates(t, y, liquid, burning, tables, c, terms, work, dy, out)
        event_values(t, y, liquid, burning, tables, c, terms, work, out, there)
        y[i] = kept
        g_y[i] = (there[event] - here[event]) / step
    tick = 1e-6
    rates(t + tick, y, liquid, burning, tables, c, terms, work, dy, out)
    event_values(t + tick, y, liquid, burning, tables, c, terms, work, out, there)
    slope = (there[event] - here[event]) / tick
    for i in range(size):
        slope += g_y[i] * f[i]
    if slope == 0.0:
        return
    for p in range(number):
        rates(t, y, liquid, burning, tables, shifted[p], terms, work, dy, out)
        event_values(t, y, liquid, burning, tables, shifted[p], terms, work, out, there)
        total = (there[event] - here[event]) / steps[p]
        for i in range(size):
            total += g_y[i] * s[i, p]
        moment[p] = -total / slope
    if not goes_on:
        return
    rates(t, y_after.copy(), phase_after[0] == 1, phase_after[1] == 1, tables, c, terms, work, f_after, out)
    base, changed = y.copy(), y.copy()
    change(event, c, tables[0], base)
    for p in range(number):
        # the state where the shifted run meets the event, changed as it would be, then back to the unshifted time
        small = 1e-6
        largest = 0.0
        for i in range(size):
            changed[i] = s[i, p] + f[i] * moment[p]
            largest = max(largest, abs(changed[i]) / max(abs(y[i]), scales[i]))
        scale = small / max(largest, 1e-300)
        for i in range(size):
            changed[i] = y[i] + scale * changed[i]
        change(event, c, tables[0], changed)
        for i in range(size):
            s[i, p] = (changed[i] - base[i]) / scale
        if event == 0:
            changed[:] = y
            change(event, shifted[p], tables[0], changed)
            for i in range(size):
                s[i, p] += (changed[i] - base[i]) / steps[p]
        for i in range(size):
            s[i, p] -= f_after[i] * moment[p]


@njit(cache=True, error_model="numpy")
def at_times(at: Array, times: Array, values: Array) -> Array:
    """Sensitivities (times, rows, parameters) at increasing times: cubics through each step's four nodes."""
    out = np.empty((at.size, values.shape[2], values.shape[3]))
    nodes = np.array([0.0, NODES[0], NODES[1], NODES[2]])
    k, last = 0, times.shape[0] - 1
    weights = np.empty(4)
    for i in range(at.size):
        while k < last and at[i] > times[k, 1]:
            k += 1
        t = min(max(at[i], times[0, 0]), times[last, 1])
        theta = (t - times[k, 0]) / (times[k, 1] - times[k, 0])
        for a in range(4):
            weights[a] = 1.0
            for b in range(4):
                if a != b:
                    weights[a] *= (theta - nodes[b]) / (nodes[a] - nodes[b])
        for r in range(values.shape[2]):
            for p in range(values.shape[3]):
                total = 0.0
                for a in range(4):
                    total += weights[a] * values[k, a, r, p]
                out[i, r, p] = total
    return out
