"""The course of a run: phases and events, step by step, in one compiled loop.

Phase changes are events: the end of the liquid, the end of the fuel, a rocket that falls back onto its pad, a
shock that enters the nozzle, a nozzle that unchokes, and the switches of effects. A step that passes one is shortened
to end on it; equations change only between steps.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from hfanalysis.arrays import Array, Integers
from hfanalysis.compiled import compiled, inlined, inner, separate
from hfanalysis.engine import equations as eq
from hfanalysis.engine import sites as at
from hfanalysis.engine.equations import EVALUATION, OUTPUTS, Equations, address_of, call, equations_at, rates_at
from hfanalysis.engine.model import PAD
from hfanalysis.engine.nozzle import mach_at_area, pressure_after_shock, pressure_ratio
from hfanalysis.engine.rosenbrock import (
    DENSE,
    GAMMA,
    STAGES,
    TIME,
    TIME_SLOPE,
    A,
    C,
    copy,
    factorize,
    interpolate,
    substitute,
)
from hfanalysis.engine.sites import call_switch
from hfanalysis.engine.tank import liquid_mass, run_dry

SCALES = np.array([1e-2, 1e-1, 1e-4, 1e-5, 1e-5, 1e-1, 1e-2, 1.0, 1e-3, 1e-5, 10.0, 1e-5, 1.0, 1e-3, 1e-3])
"""What counts as small of each state [SI]: absolute tolerances are the relative one times this."""

LIQUID_OUT, FUEL_OUT, GROUND, CHOKING, SHOCK = range(5)
"""Events of the engine; those from OWN_EVENTS on are the switches of its terms."""
OWN_EVENTS = 5
"""Number of the engine's own events."""

REACHED_END, BURNT_OUT, GIVEN_UP, BLOWN_DOWN = range(4)
"""How a run ends."""

MOST_STEPS = 8000
"""Steps after which an engine is given up. Evidence: a burn takes about a hundred."""

FIRST_STEP = 1e-5
"""First step of a run [s]; after an event a step begins anew with ten times this at most."""

LEAST_STEP = 1e-13
"""Shortest step [s], or relative to the time where that is above a second."""

SPENT = 1e-4
"""Excess of a tank's over the ambient pressure, relative [-], at which nothing flows any more that could burn."""

ROOM = 256
"""Steps that there is room for at first."""

TICK = 1e-6
"""Difference in time [s] with which slopes are formed."""

INCREMENT = 1e-7
"""Difference with which Jacobians are formed, relative to a state or to its scale [-]."""

PARTS_OF_OCTAVE = 8
"""Parts of an octave of which the steps' factors are whole numbers. Evidence: what a Jacobian of differences rounds off
is in every error, and by steps that follow it a run's last digit would grow to its tolerance."""

ROUNDED_OFF = 1e-6
"""Part of the tolerance [-] below which an error is what was rounded off."""


@inner
def moves(i: int, burning: bool, c: Array, terms: int) -> bool:
    """Whether a state changes in a phase."""
    if i == eq.RADIUS:
        return burning
    if i in (eq.ALTITUDE, eq.SPEED):
        return bool(c[eq.FLIES] > 0.0)
    if i in (eq.NITROGEN, eq.CHAMBER_NITROGEN):
        return terms > 0 or bool(c[eq.NITROGEN_MASS] > 0.0)
    if i == eq.ENTHALPY:
        return bool(np.isnan(c[eq.OXIDIZER_ENTHALPY]))
    if i in (eq.COLD, eq.COLD_ENERGY):
        return not burning
    return i not in (eq.COMPRESSIBILITY, eq.EXPONENT)


@inner
def active_states(size: int, burning: bool, c: Array, terms: int) -> Integers:
    """Indices (k,) of the states that change in a phase; the others stay, and the linear algebra is spared them.

    ``c`` (CONSTANTS and effects' parameters,) [SI].
    """
    out, n = np.empty(size, dtype=np.int64), 0
    for i in range(size):
        if moves(i, burning, c, terms):
            out[n] = i
            n += 1
    return out[:n].copy()


class Scratch(NamedTuple):
    """Room for a step in one phase.

    ``active`` states; stages ``u``, Jacobian, its factors; rates at the start (``f``), at the end (``g``), on the way
    (``moved``), and their ``slope`` in time; the state tried; outputs at the start and of the last evaluation; values
    of the events at the start, at the end, on the way.
    """

    active: Integers
    u: Array
    jac: Array
    lu: Array
    pivots: Integers
    f: Array
    g: Array
    moved: Array
    slope: Array
    trial: Array
    start_out: Array
    out: Array
    before: Array
    after: Array
    values: Array


class RunHistory(NamedTuple):
    """Steps as :func:`integrate` returns them, with room for more."""

    times: Array
    begin: Array
    end: Array
    outputs: Array
    dense: Array
    phases: Integers
    events: Integers


@separate(EVALUATION)
def event_values(t: float, y: Array, liquid: bool, burning: bool, model: int, out: Array, values: Array) -> None:
    """Positive before an event and negative after (switches: either way) [SI], into ``values`` (events,).

    ``t`` [s], ``y`` (states,) [SI]; ``out`` (outputs,) [SI] and ENVIRONMENT are those of ``rates`` at ``y``.
    """
    m, dry = equations_at(model), 1.0
    c = m.c
    if liquid:
        dry = liquid_mass(m.saturation, c[eq.VOLUME], y[eq.TANK], y[eq.TEMPERATURE])
    values[LIQUID_OUT] = dry
    values[FUEL_OUT] = min(c[eq.OUTER_RADIUS] + c[eq.SPARE_WEB] - y[eq.RADIUS], c[eq.FUEL_END] - t) if burning else 1.0
    values[GROUND] = y[eq.ALTITUDE] - c[eq.LAUNCH_ALTITUDE] + PAD if c[eq.FLIES] > 0.0 else 1.0
    ratio, gamma = c[eq.EXIT_AREA] / (c[eq.THROAT_AREA] * m.site[at.THROAT_FACTOR]), out[eq.O_GAMMA]
    subsonic, supersonic = mach_at_area(ratio, gamma, False), mach_at_area(ratio, gamma, True)
    behind = pressure_ratio(supersonic, gamma) * pressure_after_shock(supersonic, gamma)
    values[CHOKING] = out[eq.O_CHAMBER_PRESSURE] * pressure_ratio(subsonic, gamma) - out[eq.O_AMBIENT]
    values[SHOCK] = out[eq.O_CHAMBER_PRESSURE] * behind - out[eq.O_AMBIENT]
    for k in range(m.terms.shape[0]):
        address = m.terms[k, at.SWITCH_ADDRESS]
        value = 1.0
        if address != 0:
            value = call_switch(address, t, m.env, c, m.terms[k, at.PARAMETERS_AT], y, m.terms[k, at.STATES_AT])  # type: ignore[call-arg]
        values[OWN_EVENTS + k] = value


@inlined
def events_at(t: float, y: Array, liquid: bool, burning: bool, model: int, out: Array, values: Array) -> None:
    """:func:`event_values` at ``t`` [s], for other compiled code: called, not merged into it; ``values`` (events,)."""
    call(equations_at(model).events, t, y, liquid, burning, model, out, values)


@compiled
def evaluate_events(t: float, y: Array, liquid: bool, burning: bool, m: Equations, out: Array, values: Array) -> None:
    """:func:`event_values` at ``t`` [s], for Python; ``values`` (events,)."""
    call(m.events, t, y, liquid, burning, address_of(m), out, values)


@compiled
def change(event: int, m: Equations, y: Array) -> None:
    """What an event does to the state ``y`` (states,) [SI]."""
    if event == LIQUID_OUT:
        run_dry(m, y)
    elif event == GROUND:
        y[eq.ALTITUDE], y[eq.SPEED] = m.c[eq.LAUNCH_ALTITUDE], 0.0


@inner
def enter(t: float, y: Array, liquid: bool, burning: bool, model: int) -> Scratch:
    """Room for the steps of a phase, with rates, outputs and events at its start ``t`` [s] in ``y`` (states,) [SI]."""
    m, size, outs = equations_at(model), y.size, len(OUTPUTS)
    active = active_states(size, burning, m.c, m.terms.shape[0])
    n, kinds = active.size, OWN_EVENTS + m.terms.shape[0]
    s = Scratch(
        active, np.zeros((STAGES, n)), np.zeros((n, n)), np.zeros((n, n)), np.zeros(n, dtype=np.int64),
        np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size),
        np.zeros(outs), np.zeros(outs), np.ones(kinds), np.ones(kinds), np.ones(kinds),
    )  # fmt: skip
    rates_at(t, y, liquid, burning, model, s.f, s.out)
    events_at(t, y, liquid, burning, model, s.out, s.before)
    copy(s.out, s.start_out, outs)
    return s


@inner
def linearize(t: float, y: Array, liquid: bool, burning: bool, scales: Array, model: int, s: Scratch) -> None:
    """Jacobian of the active states and slope in time, by forward differences; the impulse moves nothing.

    ``t`` [s], ``y`` and ``scales`` (states,) [SI]. What the evaluation at ``y`` itself found, which comes before, is
    kept throughout.
    """
    kept_parts = equations_at(model).kept
    kept_parts[eq.KEEPS] = 0.0
    for column in range(s.active.size):
        j = s.active[column]
        if j != eq.IMPULSE:
            kept = y[j]
            y[j] = kept + INCREMENT * max(abs(kept), scales[j])
            step = y[j] - kept
            rates_at(t, y, liquid, burning, model, s.moved, s.out)
            y[j] = kept
            for row in range(s.active.size):
                s.jac[row, column] = (s.moved[s.active[row]] - s.f[s.active[row]]) / step
    if equations_at(model).terms.shape[0] > 0:
        rates_at(t + TICK, y, liquid, burning, model, s.moved, s.out)
        for i in range(y.size):
            s.slope[i] = (s.moved[i] - s.f[i]) / TICK
    kept_parts[eq.KEEPS] = 1.0


@inner
def attempt(t: float, y: Array, h: float, liquid: bool, burning: bool, model: int, s: Scratch) -> bool:
    """The stages ``u`` of a step of ``h`` from ``t`` [s] on, and its result, ``trial``; the last stage is the error.

    ``y`` (states,) [SI]. False: singular.
    """
    n = s.active.size
    for i in range(n):
        for j in range(n):
            s.lu[i, j] = -s.jac[i, j]
        s.lu[i, i] += 1.0 / (h * GAMMA)
    if not factorize(s.lu, s.pivots):
        return False
    for k in range(STAGES):
        stage(k, t, y, h, liquid, burning, model, s)
    for i in range(n):
        s.trial[s.active[i]] += s.u[STAGES - 1, i]
    return True


@inner
def stage(k: int, t: float, y: Array, h: float, liquid: bool, burning: bool, model: int, s: Scratch) -> None:
    """Stage ``k``, from those before it; leaves the state it was evaluated at in ``trial``.

    The step is that of ``h`` from ``t`` on [s], in ``y`` (states,) [SI].
    """
    copy(y, s.trial, y.size)
    for j in range(k):
        if A[k, j] != 0.0:
            for i in range(s.active.size):
                s.trial[s.active[i]] += A[k, j] * s.u[j, i]
    rate = s.f
    if k > 0:
        rates_at(t + TIME[k] * h, s.trial, liquid, burning, model, s.moved, s.out)
        rate = s.moved
    for i in range(s.active.size):
        total = rate[s.active[i]] + h * TIME_SLOPE[k] * s.slope[s.active[i]]
        for j in range(k):
            total += C[k, j] / h * s.u[j, i]
        s.u[k, i] = total
    substitute(s.lu, s.pivots, s.u[k])


@inner
def error_norm(y: Array, scales: Array, rtol: float, s: Scratch) -> float:
    """Root mean square of the error in units of its tolerance [-]; ``y`` and ``scales`` (states,) [SI]."""
    total = 0.0
    for i in range(s.active.size):
        j = s.active[i]
        unit = rtol * (scales[j] + max(abs(y[j]), abs(s.trial[j])))
        total += (s.u[STAGES - 1, i] / unit) ** 2
    return float(np.sqrt(total / s.active.size))


@inner
def arrive(t: float, liquid: bool, burning: bool, model: int, s: Scratch, dense: Array) -> None:
    """Rates, outputs and events at the end ``t`` of a step [s], and its interpolant ``dense`` (3, states) [SI]."""
    rates_at(t, s.trial, liquid, burning, model, s.g, s.out)
    events_at(t, s.trial, liquid, burning, model, s.out, s.after)
    for k in range(3):
        for i in range(s.trial.size):
            dense[k, i] = 0.0
        for i in range(s.active.size):
            for j in range(STAGES):
                dense[k, s.active[i]] += DENSE[k, j] * s.u[j, i]


@inner
def passed(event: int, before: float, after: float) -> bool:
    """Whether an event lies between two values of its function: the engine's own downwards, switches either way."""
    return before > 0.0 >= after if event < OWN_EVENTS else before * after < 0.0


@inner
def value_within(
    event: int, theta: float, t: float, y: Array, h: float, dense: Array, liquid: bool, burning: bool, model: int,
    s: Scratch,
) -> float:  # fmt: skip
    """An event's value [SI] at a fraction ``theta`` of the step of ``h`` from ``t`` on [s]; ``dense`` (3, states)."""
    between = np.empty_like(y)
    interpolate(theta, y, s.trial, dense, between)
    out = np.empty_like(s.out)
    rates_at(t + theta * h, between, liquid, burning, model, s.moved, out)
    events_at(t + theta * h, between, liquid, burning, model, out, s.values)
    return float(s.values[event])


@inner
def locate(
    event: int, latest: float, t: float, y: Array, h: float, dense: Array, liquid: bool, burning: bool, model: int,
    s: Scratch,
) -> float:  # fmt: skip
    """The fraction of a step at which an event happens, by false position and halving; 2 if not up to ``latest``.

    The step is that of ``h`` from ``t`` on [s], in ``y`` (states,) [SI]; ``dense`` (3, states).
    """
    low, low_value, high, high_value = 0.0, s.before[event], latest, s.after[event]
    if latest < 1.0:
        high_value = value_within(event, latest, t, y, h, dense, liquid, burning, model, s)
        if low_value * high_value > 0.0:
            return 2.0
    for turn in range(60):
        share = low_value / (low_value - high_value) if turn % 3 < 2 else 0.5
        theta = min(max(low + (high - low) * share, low), high)
        value = value_within(event, theta, t, y, h, dense, liquid, burning, model, s)
        if value * low_value > 0.0:
            low, low_value = theta, value
        else:
            high, high_value = theta, value
        if (high - low) * h < 1e-12 * max(1.0, t) or value == 0.0:
            break
    return high


@inner
def first_event(
    t: float, y: Array, h: float, dense: Array, liquid: bool, burning: bool, model: int, s: Scratch
) -> tuple[int, float]:
    """The earliest event within a step (-1: none) and the fraction of the step at which it happens.

    The step is that of ``h`` from ``t`` on [s], in ``y`` (states,) [SI]; ``dense`` (3, states).
    """
    event, theta = -1, 1.0
    for k in range(s.before.size):
        if passed(k, s.before[k], s.after[k]):
            found = locate(k, theta, t, y, h, dense, liquid, burning, model, s)
            if found <= 1.0:
                event, theta = k, found
    return event, theta


@inner
def empty_history(room: int, size: int) -> RunHistory:
    """Room for so many steps."""
    return RunHistory(
        np.empty((room, 2)), np.empty((room, size)), np.empty((room, size)), np.empty((room, 2, len(OUTPUTS))),
        np.empty((room, 3, size)), np.empty((room, 2), dtype=np.int64), np.empty(room, dtype=np.int64),
    )  # fmt: skip


@inner
def first(steps: RunHistory, n: int, room: int) -> RunHistory:
    """The first ``n`` steps, with room for ``room``."""
    out = empty_history(room, steps.begin.shape[1])
    copy(steps.times, out.times, 2 * n)
    copy(steps.begin, out.begin, n * steps.begin.shape[1])
    copy(steps.end, out.end, n * steps.end.shape[1])
    copy(steps.outputs, out.outputs, n * 2 * len(OUTPUTS))
    copy(steps.dense, out.dense, n * 3 * steps.begin.shape[1])
    for i in range(n):
        out.phases[i, 0], out.phases[i, 1], out.events[i] = steps.phases[i, 0], steps.phases[i, 1], steps.events[i]
    return out


@inner
def record(
    steps: RunHistory, n: int, t: float, y: Array, h: float, liquid: bool, burning: bool, event: int, s: Scratch
) -> None:
    """Keep step ``n``, of ``h`` from ``t`` on [s], in ``y`` (states,) [SI]."""
    steps.times[n, 0], steps.times[n, 1] = t, t + h
    steps.phases[n, 0], steps.phases[n, 1], steps.events[n] = int(liquid), int(burning), event
    copy(y, steps.begin[n], y.size)
    copy(s.trial, steps.end[n], y.size)
    copy(s.start_out, steps.outputs[n, 0], s.out.size)
    copy(s.out, steps.outputs[n, 1], s.out.size)


@inner
def in_whole_parts(factor: float) -> float:
    """A step's factor as a whole number of parts of an octave: the last digits of an error change no step."""
    return float(2.0 ** (np.floor(PARTS_OF_OCTAVE * np.log2(factor) + 0.5) / PARTS_OF_OCTAVE))


@inner
def shortened(h: float, error: float) -> float:
    """The step [s] to try after one of ``h`` [s] whose error (in units of its tolerance) was too large."""
    return h * in_whole_parts(max(0.2, 0.9 * error**-0.2)) if np.isfinite(error) else 0.1 * h


@inner
def next_step(h: float, error: float, old_error: float, rejected: bool) -> float:
    """The step [s] after an accepted one of ``h`` [s] (PI control); errors in units of their tolerance."""
    most = 1.0 if rejected else 6.0
    if error < ROUNDED_OFF:
        return h * most
    factor = 0.9 * error**-0.14 * old_error**0.08
    return h * in_whole_parts(min(max(factor, 0.2), most))


@inner
def advance(y: Array, s: Scratch) -> None:
    """The end of a step becomes the start of the next: ``y`` (states,) [SI]."""
    copy(s.trial, y, y.size)
    copy(s.g, s.f, y.size)
    copy(s.after, s.before, s.before.size)
    copy(s.out, s.start_out, s.out.size)


@inner
def up_to_event(
    t: float, y: Array, h: float, liquid: bool, burning: bool, model: int, s: Scratch, dense: Array
) -> tuple[int, float]:
    """The first event in a step of ``h`` [s] from ``t`` on (-1: none), and the step that ends there [s]."""
    arrive(t + h, liquid, burning, model, s, dense)
    event, theta = first_event(t, y, h, dense, liquid, burning, model, s)
    if theta < 1.0:
        h *= theta
        attempt(t, y, h, liquid, burning, model, s)
        arrive(t + h, liquid, burning, model, s, dense)
    return event, h


@inner
def leave(event: int, falling: bool, h: float, s: Scratch) -> None:
    """Put an event behind that a step of ``h`` [s] has passed, or the same crossing would be found again.

    Else the step was that much too short, for its interpolant errs: the crossing is still to come.
    """
    passed_by = s.before[event] < 0.0 if falling else s.before[event] > 0.0
    if event >= CHOKING and (passed_by or h < FIRST_STEP):
        s.before[event] = -1e-300 if falling else 1e-300


@compiled(nogil=True)
def integrate(
    y0: Array, longest: float, run_on: bool, rtol: float, scales: Array, m: Equations, liquid: bool, burning: bool
) -> tuple[int, RunHistory, Array]:
    """From ignition (``liquid``, ``burning``) until the fuel is gone, or to ``longest`` [s] if it is to ``run_on``.

    ``y0`` and ``scales`` (states,) [SI]; ``rtol`` the relative tolerance. A tank blown down to ambient pressure ends a
    run too that is not to run on.

    Returns how it ended and per step: times (n, 2) of start and end [s], states (n, states) at start and end, outputs
    (n, 2, outputs) at start and end (before an event changes the equations) [SI], interpolants (n, 3, states), phases
    (n, 2: liquid, burning), the event at its end (n,) (-1: none); and the time [s] of every event's last occurrence
    (NaN: none).
    """
    y, steps = y0.copy(), empty_history(ROOM, y0.size)
    t, n, h, ending, model = 0.0, 0, FIRST_STEP, REACHED_END, address_of(m)
    s = enter(t, y, liquid, burning, model)
    happened = np.full(s.before.size, np.nan)
    old_error, rejected, fresh, attempts = 1.0, False, True, 0
    while t < longest and ending == REACHED_END:
        attempts += 1
        h, least = min(h, longest - t), LEAST_STEP * max(1.0, t)
        if attempts > MOST_STEPS or (h < least and longest - t > 2.0 * least):
            ending = GIVEN_UP
            break
        if fresh:
            linearize(t, y, liquid, burning, scales, model, s)
        error = error_norm(y, scales, rtol, s) if attempt(t, y, h, liquid, burning, model, s) else np.inf
        rejected, fresh = rejected or not error <= 1.0, error <= 1.0
        if not fresh:
            h = shortened(h, error)
            continue
        if n == steps.times.shape[0]:
            steps = first(steps, n, 2 * n)
        whole = h
        event, h = up_to_event(t, y, h, liquid, burning, model, s, steps.dense[n])
        if event == GROUND:
            s.trial[eq.ALTITUDE] = m.c[eq.LAUNCH_ALTITUDE] - PAD  # by definition; the shortened step only comes near
        record(steps, n, t, y, h, liquid, burning, event, s)
        n, t, falling = n + 1, t + h, event >= 0 and s.before[event] > 0.0
        advance(y, s)
        if event < 0:
            h = next_step(h, error, old_error, rejected)
            old_error, rejected = max(error, 1e-4), False
            if not (run_on or liquid) and s.out[eq.O_TANK_PRESSURE] < (1.0 + SPENT) * s.out[eq.O_AMBIENT]:
                ending = BLOWN_DOWN
            continue
        happened[event] = t
        liquid = liquid and event != LIQUID_OUT
        change(event, m, y)
        if burning and (event == FUEL_OUT or y[eq.RADIUS] >= m.c[eq.OUTER_RADIUS] + m.c[eq.SPARE_WEB]):
            burning, happened[FUEL_OUT] = False, t
            ending = REACHED_END if run_on else BURNT_OUT
        s = enter(t, y, liquid, burning, model)
        leave(event, falling, h, s)
        h = whole if event in (CHOKING, SHOCK) else min(whole, 10.0 * FIRST_STEP)
        old_error, rejected = 1.0, False
    return ending, first(steps, n, n), happened


@compiled(nogil=True)
def sample(at: Array, steps: RunHistory, m: Equations) -> tuple[Array, Array]:
    """States (n, states) and outputs (n, outputs) [SI] at increasing times ``at`` (n,) [s], from the steps'
    interpolants; the ends are held."""
    size = steps.begin.shape[1]
    states, outputs, dy = np.empty((at.size, size)), np.empty((at.size, len(OUTPUTS))), np.zeros(size)
    times, phases, model = steps.times, steps.phases, address_of(m)
    k, last = 0, times.shape[0] - 1
    for i in range(at.size):
        while k < last and at[i] > times[k, 1]:
            k += 1
        t = min(max(at[i], times[0, 0]), times[last, 1])
        theta = (t - times[k, 0]) / (times[k, 1] - times[k, 0])
        interpolate(theta, steps.begin[k], steps.end[k], steps.dense[k], states[i])
        rates_at(t, states[i], phases[k, 0] == 1, phases[k, 1] == 1, model, dy, outputs[i])
    return states, outputs
