"""Tests that the plain reference solver runs (benchmarks/reference_engine.py): none of the engine's own equations, nor
of the blind generator's. It knows no effect, and no valve that closes: its logs end as that does."""

from __future__ import annotations

from math import pi

import numpy as np
from benchmarks.reference_engine import Reference, nozzle, solve
from simulated.blind import slots as s
from simulated.blind.kernel import STEP
from simulated.blind.stand import Histories, Stand
from simulated.worlds.laws import Array

from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.engine.unsteady import Engine
from hfanalysis.thermo.combustion import PROPEP_OXIDIZER_ENTHALPY, equilibrium
from hfanalysis.thermo.combustion_table import build
from hfanalysis.thermo.constants import OXIDIZER_MOLAR_MASS
from hfanalysis.thermo.nitrous import saturation


def engine_of(stand: Stand) -> Engine:
    """The stand as the reference takes it."""
    return Engine(
        saturation=saturation("coolprop"),
        combustion=build(),
        feed=FeedSystem(stand.volume, stand.C_i * stand.holes * stand.hole_area, loss_factor=stand.K_loss),
        oxidizer_mass=stand.mass,
        temperature=stand.temperature,
        polytropic_exponent=stand.m,
        fuel_mass=stand.fuel_mass,
        grain_length=stand.grain_length,
        outer_radius=stand.outer_radius,
        fuel_density=stand.fuel_density,
        a=stand.a,
        n=stand.n,
        dead_volume=stand.pre_volume + stand.post_volume,
        throat_area=pi * stand.throat_radius**2,
        exit_area=pi * stand.exit_radius**2,
        ambient_pressure=stand.ambient,
        oxidizer_enthalpy=PROPEP_OXIDIZER_ENTHALPY,
    )


def histories(stand: Stand) -> Histories:
    """A test of the stand up to the closing of its valve. Raises ArithmeticError where the solver gives up."""
    run = solve(engine_of(stand), longest=stand.closing, run_on=True)
    time = np.arange(round(stand.closing / STEP)) * STEP
    traces = np.zeros((time.size, s.TRACES))
    dry, burnt, began = np.nan, np.nan, 0.0
    for phase in run.phases:
        ended = float(phase.t[-1])
        reference, rows = run.reference, (time >= began) & (time <= ended)
        reference.liquid, reference.burning = bool(np.isnan(dry)), bool(np.isnan(burnt))
        for k in np.flatnonzero(rows):
            traces[k] = _at(reference, phase.sol(time[k]))
        dry = ended if phase.t_events[0].size else dry
        burnt = ended if phase.t_events[1].size else burnt
        began = ended
    supply = stand.supply or 0.0
    below = traces[:, s.P_TANK] + stand.cracking < supply
    traces[:, s.P_PURGE] = np.where(below, traces[:, s.P_TANK] + stand.cracking, supply)
    return Histories(traces, dry, float(time[below][0]) if below.any() else np.nan, burnt, time=time)


def _at(reference: Reference, x: Array) -> Array:
    """The traces in a state ``x`` of the solver."""
    e, out = reference.engine, np.zeros(s.TRACES)
    p_c, gas = (float(x[6]), equilibrium(float(x[6]), x[4] / x[5])) if reference.burning else reference.held(x)
    p_t, flow = reference.tank_pressure(x[0], x[2]), reference.oxidizer_flow(x, p_c) * OXIDIZER_MOLAR_MASS
    if reference.liquid:
        density = 1.0 / float(e.saturation.liquid_volume(x[2])[0])
    else:
        density = OXIDIZER_MOLAR_MASS * x[0] / e.feed.volume
    out[s.P_TANK], out[s.P_CHAMBER], out[s.FLOW] = p_t, p_c, flow
    out[s.P_RUN] = p_t - e.feed.loss_factor * flow**2 / density
    out[s.THRUST] = nozzle(gas, p_c, e.ambient, e.throat_area, e.exit_area)[1]
    out[s.M_TANK], out[s.RADIUS] = OXIDIZER_MOLAR_MASS * (x[0] + x[1]), x[3]
    if reference.burning:
        out[s.FUEL] = e.fuel_density * 2.0 * pi * x[3] * e.grain_length * e.a * (flow / (pi * x[3] ** 2)) ** e.n
    return out
