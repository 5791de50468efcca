"""Sensitivities of a run: how every state and output moves with every parameter, right through the events.

Along a finished run the variational equation S' = f_y S + f_p is linear. It is integrated over the run's own steps
by the three-stage Radau IIA method (order 5, stiffly accurate); f_y and f_p are forward differences of the same
compiled equations at the nodes, so that outputs' sensitivities out_y S + out_p come along. Where an event g(y, p) =
0 changes the equations, its time moves by dt = -(g_y S + g_p) / (g_y f + g_t), and S jumps by change_y (S + f dt) +
change_p - f_after dt.

A parameter is anything that changes the engine's constants or its initial state: it is given as a second set of them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from hfanalysis.arrays import Array, Integers
from hfanalysis.compiled import compiled, inner
from hfanalysis.engine.equations import IMPULSE, KEEPS, OUTPUTS, Equations, address_of, rates_at
from hfanalysis.engine.phases import INCREMENT, LIQUID_OUT, OWN_EVENTS, TICK, RunHistory, change, events_at
from hfanalysis.engine.rosenbrock import copy, factorize, interpolate, substitute

NUDGE = 1e-6
"""Difference with which an event's change of the state is followed, relative to a state or to its scale [-]."""

INSIDE = 1e-3
"""Part of a step by which slopes are formed beside an event, on the step's own side: differences of the state at the
event itself might lead to the other."""

_ROOT = np.sqrt(6.0)
NODES = np.array([(4.0 - _ROOT) / 10.0, (4.0 + _ROOT) / 10.0, 1.0])
"""Where in a step its three stages lie [-]. Source: Radau IIA, order 5 (Hairer and Wanner, Solving Ordinary
Differential Equations II, table IV.5.6)."""

RADAU = np.array(
    [
        [(88.0 - 7.0 * _ROOT) / 360.0, (296.0 - 169.0 * _ROOT) / 1800.0, (-2.0 + 3.0 * _ROOT) / 225.0],
        [(296.0 + 169.0 * _ROOT) / 1800.0, (88.0 + 7.0 * _ROOT) / 360.0, (-2.0 - 3.0 * _ROOT) / 225.0],
        [(16.0 - _ROOT) / 36.0, (16.0 + _ROOT) / 36.0, 1.0 / 9.0],
    ]
)
"""Coefficients of Radau IIA, order 5 [-]. Source: Hairer and Wanner, Solving Ordinary Differential Equations II, table
IV.5.6."""


class Parameters(NamedTuple):
    """``shifted`` (parameters, constants) are the constants with each parameter moved by ``steps``; ``acting``
    (parameters, 2) from when to when [s] that changes any rate or output at all."""

    shifted: Array
    steps: Array
    acting: Array
    scales: Array


class Slopes(NamedTuple):
    """Derivatives of the rates and of the outputs by the states and by the parameters, at one point."""

    f_y: Array
    f_p: Array
    out_y: Array
    out_p: Array


class Spare(NamedTuple):
    """Rates and outputs at a point, and at one beside it."""

    f: Array
    out: Array
    moved: Array
    moved_out: Array


@inner
def with_constants(m: Equations, c: Array) -> Equations:
    """The equations of an engine with other constants ``c`` (CONSTANTS and effects' parameters,) [SI]."""
    return Equations(m.rates, m.events, m.saturation, m.gas, m.drag, c, m.terms, m.env, m.site, m.kept)


@inner
def quotient(spare: Spare, step: float, f_column: Array, out_column: Array) -> None:
    """Difference quotients of rates and outputs by a ``step`` [SI], into columns (states,) and (outputs,)."""
    for i in range(f_column.size):
        f_column[i] = (spare.moved[i] - spare.f[i]) / step
    for i in range(out_column.size):
        out_column[i] = (spare.moved_out[i] - spare.out[i]) / step


@inner
def linearize(
    t: float, y: Array, liquid: bool, burning: bool, m: Equations, p: Parameters, moving: Integers, slopes: Slopes,
    spare: Spare,
) -> None:  # fmt: skip
    """All the slopes [SI] at one point ``y`` (states,) at ``t`` [s], by forward differences; those with the ``moving``
    states only."""
    model = address_of(m)
    rates_at(t, y, liquid, burning, model, spare.f, spare.out)
    m.kept[KEEPS] = 0.0
    for j in moving:
        before = y[j]
        y[j] = before + INCREMENT * max(abs(before), p.scales[j])
        step = y[j] - before
        rates_at(t, y, liquid, burning, model, spare.moved, spare.moved_out)
        y[j] = before
        quotient(spare, step, slopes.f_y[:, j], slopes.out_y[:, j])
    for k in range(p.steps.size):
        if p.acting[k, 0] <= t <= p.acting[k, 1]:
            other = address_of(with_constants(m, p.shifted[k]))
            rates_at(t, y, liquid, burning, other, spare.moved, spare.moved_out)
            quotient(spare, p.steps[k], slopes.f_p[:, k], slopes.out_p[:, k])
        else:
            slopes.f_p[:, k] = 0.0
            slopes.out_p[:, k] = 0.0
    m.kept[KEEPS] = 1.0


@inner
def moving_states(s: Array) -> Integers:
    """States that any parameter moves, of sensitivities ``s`` (states, parameters); not the impulse, on which nothing
    depends."""
    found, n = np.empty(s.shape[0], dtype=np.int64), 0
    for i in range(s.shape[0]):
        if i != IMPULSE and not_zero(s[i]):
            found[n] = i
            n += 1
    return found[:n].copy()


@inner
def not_zero(row: Array) -> bool:
    """Whether any of the numbers is other than 0."""
    found = False
    for value in row:
        found = found or value != 0.0
    return found


@inner
def joined(moving: Integers, slopes: Slopes) -> Integers:
    """``moving`` (k,), and the states that parameters or moving states begin to move at one of the nodes of a step."""
    size = slopes.f_y.shape[1]
    known = np.zeros(size, dtype=np.bool_)
    known[IMPULSE] = True
    for j in moving:
        known[j] = True
    found, n = np.empty(size, dtype=np.int64), 0
    for i in range(size):
        begins = False
        for b in range(3):
            if not known[i] and not begins:
                begins = not_zero(slopes.f_p[b, i])
                for j in moving:
                    begins = begins or slopes.f_y[b, i, j] != 0.0
        if begins or (known[i] and i != IMPULSE):
            found[n] = i
            n += 1
    return found[:n].copy()


@inner
def radau_matrix(h: float, f_y: Array, moving: Integers, matrix: Array) -> None:
    """1 - h (RADAU x f_y) of the moving states, (3 moving, 3 moving), for a step ``h`` [s]; ``f_y`` (nodes, states,
    states)."""
    m = moving.size
    for a in range(3):
        for b in range(3):
            for i in range(m):
                for j in range(m):
                    matrix[a * m + i, b * m + j] = -h * RADAU[a, b] * f_y[b, moving[i], moving[j]]
    for i in range(3 * m):
        matrix[i, i] += 1.0


@inner
def radau_stages(
    h: float, k: int, s: Array, f_p: Array, moving: Integers, lu: Array, pivots: Integers, u: Array
) -> None:
    """Sensitivities ``u`` (3 moving,) of the moving states at the three nodes of a step ``h`` [s] to parameter
    ``k``."""
    m = moving.size
    for a in range(3):
        for i in range(m):
            total = s[moving[i], k]
            for b in range(3):
                total += h * RADAU[a, b] * f_p[b, moving[i], k]
            u[a * m + i] = total
    substitute(lu, pivots, u)


@inner
def spread(h: float, k: int, s: Array, slopes: Slopes, moving: Integers, u: Array, states: Array) -> None:
    """The stages of parameter ``k`` of a step ``h`` [s] into ``states`` (nodes, states, parameters); the impulse is a
    quadrature."""
    m = moving.size
    for a in range(3):
        for i in range(s.shape[0]):
            states[a + 1, i, k] = s[i, k]
        for i in range(m):
            states[a + 1, moving[i], k] = u[a * m + i]
    for b in range(3):
        rate = slopes.f_p[b, IMPULSE, k]
        for j in range(m):
            rate += slopes.f_y[b, IMPULSE, moving[j]] * u[b * m + j]
        for a in range(3):
            states[a + 1, IMPULSE, k] += h * RADAU[a, b] * rate


@inner
def outputs_of(s: Array, moving: Integers, out_y: Array, out_p: Array, result: Array) -> None:
    """Sensitivities of the outputs (outputs, parameters) [SI]: out_y S + out_p."""
    copy(out_p, result, out_p.size)
    for o in range(out_y.shape[0]):
        for j in moving:
            slope = out_y[o, j]
            if slope != 0.0:
                for p in range(s.shape[1]):
                    result[o, p] += slope * s[j, p]


@inner
def at_node(slopes: Slopes, node: int) -> Slopes:
    """Of slopes at several points, those at one."""
    return Slopes(slopes.f_y[node], slopes.f_p[node], slopes.out_y[node], slopes.out_p[node])


@inner
def empty_slopes(size: int, number: int) -> Slopes:
    """Room for the slopes at four points: NODES, and the start of a step."""
    outs = len(OUTPUTS)
    return Slopes(
        np.zeros((4, size, size)), np.zeros((4, size, number)), np.zeros((4, outs, size)), np.zeros((4, outs, number))
    )


@inner
def copy_slopes(slopes: Slopes, source: int, target: int) -> None:
    """What holds at a step's end holds at the start of the next."""
    copy(slopes.f_y[source], slopes.f_y[target], slopes.f_y[source].size)
    copy(slopes.f_p[source], slopes.f_p[target], slopes.f_p[source].size)
    copy(slopes.out_y[source], slopes.out_y[target], slopes.out_y[source].size)
    copy(slopes.out_p[source], slopes.out_p[target], slopes.out_p[source].size)


@inner
def linearize_step(
    n: int, run: RunHistory, y: Array, m: Equations, p: Parameters, moving: Integers, slopes: Slopes, spare: Spare
) -> None:
    """Slopes [SI] at the nodes of step ``n``, and at its start where an event comes before it; ``y`` (states,) is
    scratch."""
    t, h = run.times[n, 0], run.times[n, 1] - run.times[n, 0]
    liquid, burning = run.phases[n, 0] == 1, run.phases[n, 1] == 1
    if n == 0 or run.events[n - 1] >= 0:
        interpolate(INSIDE, run.begin[n], run.end[n], run.dense[n], y)
        linearize(t + INSIDE * h, y, liquid, burning, m, p, moving, at_node(slopes, 3), spare)
    for k in range(3):
        theta = min(NODES[k], 1.0 - INSIDE if run.events[n] >= 0 else 1.0)
        interpolate(theta, run.begin[n], run.end[n], run.dense[n], y)
        linearize(t + theta * h, y, liquid, burning, m, p, moving, at_node(slopes, k), spare)


@compiled(nogil=True)
def propagate(
    run: RunHistory, m: Equations, shifted: Array, steps: Array, acting: Array, scales: Array, start: Array
) -> tuple[Array, Array, Array]:
    """Sensitivities [SI] at four nodes of every step (its start and NODES) and of the event times [s].

    ``shifted``, ``steps`` and ``acting`` as in Parameters, ``start`` (states, parameters) the sensitivities of the
    initial state. States that no parameter moves (no nitrogen, no cold gas yet) take no part; one that begins to move
    within a step is found by its slopes, and the step is taken anew with it. Returns those of the states (n, 4, states,
    parameters), of the outputs (n, 4, outputs, parameters), and of the time of the event at each step's end (n,
    parameters; 0 without one).
    """
    count, size, number, outs = run.times.shape[0], run.begin.shape[1], steps.size, len(OUTPUTS)
    states, outputs = np.zeros((count, 4, size, number)), np.zeros((count, 4, outs, number))
    moments = np.zeros((count, number))
    p, slopes = Parameters(shifted, steps, acting, scales), empty_slopes(size, number)
    spare = Spare(np.zeros(size), np.zeros(outs), np.zeros(size), np.zeros(outs))
    s, y, old = start.copy(), np.zeros(size), -1
    for n in range(count):
        h = run.times[n, 1] - run.times[n, 0]
        if n > 0:
            copy_slopes(slopes, 2, 3)
        moving = moving_states(s)
        linearize_step(n, run, y, m, p, moving, slopes, spare)
        more = joined(moving, slopes)
        while more.size > moving.size:
            moving = more
            linearize_step(n, run, y, m, p, moving, slopes, spare)
            more = joined(moving, slopes)
        if moving.size != old:
            old = moving.size
            matrix, pivots = np.zeros((3 * old, 3 * old)), np.zeros(3 * old, dtype=np.int64)
            stage = np.zeros(3 * old)
        radau_matrix(h, slopes.f_y, moving, matrix)
        factorize(matrix, pivots)
        copy(s, states[n, 0], s.size)
        outputs_of(s, moving, slopes.out_y[3], slopes.out_p[3], outputs[n, 0])
        for k in range(number):
            radau_stages(h, k, s, slopes.f_p, moving, matrix, pivots, stage)
            spread(h, k, s, slopes, moving, stage, states[n])
        for a in range(3):
            outputs_of(states[n, a + 1], moving, slopes.out_y[a], slopes.out_p[a], outputs[n, a + 1])
        copy(states[n, 3], s, s.size)
        if run.events[n] >= 0:
            through_event(n, run, m, p, spare, s, moments[n])
    return states, outputs, moments


@inner
def event_value(
    event: int, t: float, y: Array, liquid: bool, burning: bool, m: Equations, spare: Spare, values: Array
) -> float:
    """Value [SI] of an event at ``t`` [s] in ``y`` (states,); leaves the rates in ``spare.moved``."""
    model = address_of(m)
    rates_at(t, y, liquid, burning, model, spare.moved, spare.moved_out)
    events_at(t, y, liquid, burning, model, spare.moved_out, values)
    return float(values[event])


@inner
def event_slopes(
    event: int, here: float, t: float, y: Array, liquid: bool, burning: bool, m: Equations, p: Parameters, s: Array,
    spare: Spare, values: Array, moment: Array,
) -> None:  # fmt: skip
    """How the time [s] of an event moves with every parameter, into ``moment`` (parameters,): -(g_y S + g_p) / (g_y f +
    g_t)."""
    slope = (event_value(event, t + TICK, y, liquid, burning, m, spare, values) - here) / TICK
    for k in range(p.steps.size):
        moved = event_value(event, t, y, liquid, burning, with_constants(m, p.shifted[k]), spare, values)
        moment[k] = (moved - here) / p.steps[k]
    for i in range(y.size):
        if i != IMPULSE:
            kept, step = y[i], INCREMENT * max(abs(y[i]), p.scales[i])
            y[i] = kept + step
            by_state = (event_value(event, t, y, liquid, burning, m, spare, values) - here) / step
            y[i] = kept
            slope += by_state * spare.f[i]
            for k in range(moment.size):
                moment[k] += by_state * s[i, k]
    for k in range(p.steps.size):
        moment[k] = -moment[k] / slope if slope != 0.0 else 0.0


@inner
def through_event(n: int, run: RunHistory, m: Equations, p: Parameters, spare: Spare, s: Array, moment: Array) -> None:
    """Move ``s`` (states, parameters) across the event at the end of step ``n``; into ``moment`` (parameters,) how its
    time [s] moves."""
    t, y, event = run.times[n, 1], run.end[n].copy(), run.events[n]
    liquid, burning = run.phases[n, 0] == 1, run.phases[n, 1] == 1
    values = np.ones(OWN_EVENTS + m.terms.shape[0])
    here = event_value(event, t, y, liquid, burning, m, spare, values)
    f, after = spare.f, spare.moved
    copy(spare.moved, f, f.size)
    event_slopes(event, here, t, y, liquid, burning, m, p, s, spare, values, moment)
    if n + 1 == run.times.shape[0]:
        return
    y_after, liquid, burning = run.begin[n + 1].copy(), run.phases[n + 1, 0] == 1, run.phases[n + 1, 1] == 1
    rates_at(t, y_after, liquid, burning, address_of(m), after, spare.moved_out)
    base = y.copy()
    change(event, m, base)
    for k in range(p.steps.size):
        for i in range(y.size):
            s[i, k] += f[i] * moment[k]
        follow(event, m, p, k, y, s, base)
        for i in range(y.size):
            s[i, k] -= after[i] * moment[k]


@inner
def follow(event: int, m: Equations, p: Parameters, k: int, y: Array, s: Array, base: Array) -> None:
    """Column ``k`` of ``s`` (states, parameters) across the change of the state [SI], from ``y`` to ``base``, that an
    event makes."""
    largest, changed = 1e-300, y.copy()
    for i in range(y.size):
        largest = max(largest, abs(s[i, k]) / max(abs(y[i]), p.scales[i]))
    for i in range(y.size):
        changed[i] = y[i] + NUDGE / largest * s[i, k]
    change(event, m, changed)
    for i in range(y.size):
        s[i, k] = (changed[i] - base[i]) / (NUDGE / largest)
    if event == LIQUID_OUT:
        copy(y, changed, y.size)
        change(event, with_constants(m, p.shifted[k]), changed)
        for i in range(y.size):
            s[i, k] += (changed[i] - base[i]) / p.steps[k]


@compiled
def at_times(at: Array, times: Array, values: Array) -> Array:
    """Sensitivities (times, rows, parameters) at increasing times ``at`` [s]: cubics through each step's four nodes.

    ``times`` (n, 2): starts and ends of the steps [s]; ``values`` (n, 4, rows, parameters).
    """
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
