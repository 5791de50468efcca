"""The tank's calibration with adopted effects acting: on the flow of the liquid phase, and on the vapor's expansion.

The tank alone is run with the effects on the measured chamber pressure, from the opening to t_v. What its injector
passes beside A sqrt(2 rho (p_run - p_c)), and what leaves by another way, enters the balance that gives C_i; where the
run stands at t_v (nitrogen, states of effects, a pressure beside saturation) is where the vapor phase starts, and m is
shot along it with the effects in.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hfanalysis.calibrate.blowdown import Inputs, Reduction, Tables, VaporPhase, reduce
from hfanalysis.calibrate.measured_pressures import MeasuredPressures
from hfanalysis.engine.blowdown import TankAlone, TankRun, tank_alone
from hfanalysis.engine.effect import Active
from hfanalysis.engine.equations import NITROGEN, STATES
from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.record.definition import TestDefinition
from hfanalysis.thermo.saturation import Saturation

ROUNDS = 6
"""C_i, K_loss and the flow that the effects leave them are found in turns."""

LIQUID_STEPS = 400
"""Steps of the tank alone over the liquid phase: seconds of smooth course."""


def acting(
    histories: MeasuredPressures, tables: Tables, saturation: Saturation, definition: TestDefinition, inputs: Inputs,
    effects: Sequence[Active],
) -> tuple[Inputs, VaporPhase | None]:  # fmt: skip
    """The inputs as the effects leave them for the balance that gives C_i, and the vapor phase with them in.

    The load counts less what left by another way than the injector, its area times the mean of what the effects make of
    the flow. No vapor phase where C_i has no answer. Raises ArithmeticError where the tank's model cannot be run.
    """
    balance, phase, share = inputs, None, 1.0
    for _ in range(ROUNDS):
        found = reduce(tables, saturation, balance)
        if not (np.isfinite(found.C_i) and found.C_i > 0.0):
            return inputs, None
        run, tank = _liquid_phase(
            histories, saturation, definition, inputs, replace(found, K_loss=found.K_loss * share), effects
        )
        share = share * _loss_share(run, saturation, found.K_loss)
        factor, leak = _flow_beside(run, saturation, tank.engine.feed.area)
        balance = replace(inputs, mass=inputs.mass - leak, area=inputs.area * factor)
        phase = _vapor_phase(run, tank, saturation)
    return balance, phase


def _liquid_phase(
    histories: MeasuredPressures, saturation: Saturation, definition: TestDefinition, inputs: Inputs, found: Reduction,
    effects: Sequence[Active],
) -> tuple[TankRun, TankAlone]:  # fmt: skip
    """The tank with the effects from the opening to t_v, or to where its liquid is gone before."""
    start = histories.mean(histories.tank, inputs.t_feed, inputs.t_feed + 0.1 * (inputs.t_v - inputs.t_feed))
    temperature = float(saturation.temperature(np.clip(start, *saturation.pressure_range)))
    feed = FeedSystem(inputs.volume, found.C_i * inputs.area, max(found.K_loss, 0.0))
    m = found.m if np.isfinite(found.m) else 1.15
    ambient = definition.ambient_pressure.value
    tank = tank_alone(saturation, feed, inputs.mass, temperature, m, ambient, effects)
    time = np.linspace(0.0, inputs.t_v, LIQUID_STEPS + 1)
    run = tank.run(time, np.interp(time, histories.time, histories.chamber))
    if not np.isfinite(run.pressure).all():
        raise ArithmeticError("the tank's model with the adopted effects cannot be run over the liquid phase")
    wet = run.time < (run.t_v if np.isfinite(run.t_v) else np.inf)
    return TankRun(run.time[wet], run.states[wet], run.outputs[wet], run.t_v), tank


def _loss_share(run: TankRun, saturation: Saturation, measured: float) -> float:
    """The measured loss factor over that which the run shows: what it has to be without what effects make of it."""
    drop = np.maximum(run.pressure - run.run_pressure, 0.0)
    density = saturation.liquid_density(run.temperature)
    shown = float(np.trapezoid(drop * density, run.time)) / max(float(np.trapezoid(run.flow**2, run.time)), 1e-12)
    return float(np.clip(measured / shown, 0.2, 5.0)) if shown > 0.0 and measured > 0.0 else 1.0


def _flow_beside(run: TankRun, saturation: Saturation, area: float) -> tuple[float, float]:
    """Mean of the injector's flow over A sqrt(2 rho (p_run - p_c)), by flow; and what left by another way [kg]."""
    factor = run.injector_factor(area, saturation.liquid_density(run.temperature))
    plain = float(np.trapezoid(run.flow / factor, run.time))
    return float(np.trapezoid(run.flow, run.time)) / plain, float(np.trapezoid(run.leak, run.time))


def _vapor_phase(run: TankRun, tank: TankAlone, saturation: Saturation) -> VaporPhase:
    beside = float(run.pressure[-1]) - float(saturation.pressure(run.temperature[-1]))
    last = run.states[-1]
    return VaporPhase(tank, beside, float(last[NITROGEN]), last[len(STATES) :].copy())
