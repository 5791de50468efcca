"""A second opinion: the same equations integrated by CVODE (backward differentiation formulas), a solver of others.

Ten times slower than :mod:`hfanalysis.engine.phases`, for every evaluation passes through Python; it is what the own
integrator is checked with.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Composition, compose
from hfanalysis.engine.equations import OUTPUTS, STATES, evaluate_rates
from hfanalysis.engine.phases import FUEL_OUT, GROUND, LIQUID_OUT, OWN_EVENTS, SCALES, change, evaluate_events
from hfanalysis.engine.unsteady import Engine, check, constants, initial


@dataclass(frozen=True)
class Course:
    """Times and states at CVODE's steps, and the times of the events by their numbers."""

    time: Array
    states: Array
    events: dict[int, float]


def burn_by_cvode(engine: Engine, longest: float = 120.0, rtol: float = 1e-8, run_on: bool = False) -> Course:
    """As :func:`hfanalysis.engine.unsteady.burn`; raises ArithmeticError where CVODE gives up."""
    check(engine)
    composition = compose(engine.effects, constants(engine), len(STATES))
    t, y, liquid, burning = 0.0, initial(engine, composition), True, True
    times, states, events = [np.array([t])], [y[np.newaxis]], {}
    while t < longest and (burning or run_on):
        found_t, found_y, event = _phase(engine, composition, t, y, longest, liquid, burning, rtol)
        times.append(found_t[1:])
        states.append(found_y[1:])
        t, y = float(found_t[-1]), np.array(found_y[-1])
        if event is None:
            break
        events[event] = t
        change(event, engine.equations(composition), y)
        liquid, burning = liquid and event != LIQUID_OUT, burning and event != FUEL_OUT
    return Course(np.concatenate(times), np.concatenate(states), events)


def _phase(
    engine: Engine, composition: Composition, start: float, y: Array, longest: float, liquid: bool, burning: bool,
    rtol: float,
) -> tuple[Array, Array, int | None]:  # fmt: skip
    from sksundae.cvode import CVODE

    m, out = engine.equations(composition), np.zeros(len(OUTPUTS))
    own = np.ones(OWN_EVENTS + len(composition.terms))
    watched = (LIQUID_OUT, FUEL_OUT, GROUND)

    def rhs(t: float, state: Array, dy: Array) -> None:
        evaluate_rates(t, state, liquid, burning, m, dy, out)

    def events(t: float, state: Array, values: Array) -> None:
        rhs(t, state, np.empty_like(state))
        evaluate_events(t, state, liquid, burning, m, out, own)
        values[:] = own[list(watched)]

    events.terminal = [True] * len(watched)  # type: ignore[attr-defined]
    scales = np.concatenate([SCALES, composition.scales])
    solver = CVODE(
        rhs,
        method="BDF",
        rtol=rtol,
        atol=rtol * scales,
        eventsfn=events,
        num_events=len(watched),
        max_num_steps=100_000,
    )
    solution = solver.solve(np.array([start, longest]), y)
    if not solution.success and solution.status < 0:
        raise ArithmeticError(f"CVODE stops at {solution.t[-1]:.4f} s: {solution.message}")
    hit = solution.i_events[-1] if solution.i_events is not None and len(solution.i_events) else None
    event = None if hit is None else watched[int(np.flatnonzero(hit)[0])]
    return solution.t, solution.y, event
