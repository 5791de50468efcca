"""Beside the calibrated constants: the tank at rest, and C_i over time as the tank's energy has it."""

from __future__ import annotations

from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.calibrate.blowdown import Inputs, Reduction
from hfanalysis.calibrate.course import with_drift
from hfanalysis.calibrate.loaded_mass import LoadedMass, load_cell_mass
from hfanalysis.calibrate.measured_pressures import MeasuredPressures
from hfanalysis.calibrate.rest import (
    MODEL_MASS_SPREAD,
    STRATIFIED,
    blowdown_mass,
    fit_bulk,
    liquid_phase_heat,
    state_remarks,
)
from hfanalysis.calibrate.systematic import UNIFORM, other_table
from hfanalysis.engine.injector import mass_flows
from hfanalysis.engine.tank import along_blowdown, liquid_of
from hfanalysis.products.calibration import CoefficientHistory, Rest, TankHistory
from hfanalysis.products.model import Numbers
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import DERIVED, Quantity
from hfanalysis.record.log import TestLog
from hfanalysis.thermo.constants import OXIDIZER_MOLAR_MASS
from hfanalysis.thermo.saturation import Saturation

HISTORY_POINTS = 200
"""Points of a stored history: block means over the liquid phase."""


def tank_history(
    saturation: Saturation, histories: MeasuredPressures, inputs: Inputs, left: Array
) -> TankHistory | None:
    """Moles of liquid and vapor, n_l + n_v = m/W and n_l v_l + n_v v_v = V (report, 4.2.1), and the flow [mol, kg/s].

    ``left`` (n,) is the mass gone [kg] at the histories' times. None for fewer than eight samples.
    """
    wet = histories.time < inputs.t_v
    if wet.sum() < 8:
        return None
    time, gone = histories.time[wet], left[wet]
    t = histories.tank_temperature(saturation)[wet]
    v_l, v_v = saturation.liquid_volume(t)[0], saturation.vapor_volume(t)[0]
    mass = inputs.mass - gone
    liquid = liquid_of(inputs.volume, mass, v_l, v_v)
    per_mole = 1e3 / OXIDIZER_MOLAR_MASS
    flow = np.gradient(gone, time)
    block = np.minimum((np.arange(time.size) * HISTORY_POINTS) // time.size, HISTORY_POINTS - 1)
    start = np.flatnonzero(np.r_[True, np.diff(block) > 0])
    count = np.diff(np.r_[start, time.size])
    columns = (time, t, liquid * per_mole, (mass - liquid) * per_mole, flow)
    means = (_rounded(np.add.reduceat(c, start) / count) for c in columns)
    return TankHistory(**dict(zip(TankHistory.model_fields, means, strict=True)))


def _rounded(values: Array) -> Numbers:
    return tuple(round(x, 6) for x in values.tolist())


def coefficient_history(
    saturation: Saturation, histories: MeasuredPressures, inputs: Inputs, left: Array, window: float = 0.5
) -> CoefficientHistory | None:
    """C_i(t) [-] from mdot = U_T / (h_l - U_M) dT/dt of the saturated tank over the injector's ideal flow.

    Heat into the tank makes it too small, nitrogen too; where it drifts, the tank or the injector does something that
    the model lacks. ``left`` (n,) is the mass gone [kg] at the histories' times, ``window`` [s] that of a slope. None
    for a liquid phase shorter than two windows.
    """
    start, end = max(inputs.t_feed, 0.1), inputs.t_v - 0.02
    if end - start < 2.0 * window:
        return None
    h = histories
    t = h.tank_temperature(saturation)
    ideal = mass_flows(inputs.area, saturation.liquid_density(t), h.run - h.chamber)
    rows = []
    for middle in np.arange(start + 0.5 * window, end - 0.5 * window + 1e-9, 0.5 * window):
        part = np.abs(h.time - middle) <= 0.5 * window
        if part.sum() < 6 or ideal[part].mean() <= 0.0:
            continue
        slope, error = _slope(h.time[part], t[part])
        by_wander = h.noises["p_tank"].std_of(_slope_weights(h.time[part]), h.time[part])
        error = max(error, by_wander / float(saturation.pressure_slope(t[part].mean())))
        mass = inputs.mass - float(left[part].mean())
        by_temperature = along_blowdown(saturation.kernel_table, inputs.volume, mass, float(t[part].mean()))
        scale = -by_temperature / float(ideal[part].mean())
        rows.append((middle, scale * slope, abs(scale) * error))
    if not rows:
        return None
    time, value, std = map(_rounded, np.array(rows).T)
    return with_drift(CoefficientHistory(time=time, value=value, std=std))


def _slope_weights(time: Array) -> Array:
    x = time - time.mean()
    return np.asarray(x / (x @ x))


def _slope(time: Array, value: Array) -> tuple[float, float]:
    x = time - time.mean()
    slope = float(x @ value / (x @ x))
    residual = value - value.mean() - slope * x
    return slope, float(np.sqrt(residual @ residual / max(x.size - 2, 1) / (x @ x)))


def rest_of(
    log: TestLog,
    segments: Segments,
    saturation: Saturation,
    histories: MeasuredPressures,
    inputs: Inputs,
    r: Reduction,
    left: Array,
    mass: LoadedMass,
) -> tuple[Rest, list[str]]:
    """The tank at rest and what the blowdown says of it (temperatures [K], masses [kg], heat [J]), with remarks for
    people.

    Args:
        inputs: of the reduction ``r``, in SI units.
        left: oxidizer that has left the tank [kg], (n,) at the times of ``histories``.
        mass: what was loaded [kg].
    """
    tank = histories.signals["p_tank"]
    channel = log["p_tank"]
    bias = channel.zero_std if channel.zero_std is not None else channel.accuracy
    still = tank.between(-2.0, -0.1)
    pressure = float(np.median(still.value)) if still.time.size else float(tank.value[0])
    share, remarks = state_remarks(saturation, inputs.volume, inputs.mass, pressure)
    t_rest = float(saturation.temperature(pressure))
    slope = float(saturation.pressure_slope(t_rest)) if np.isfinite(t_rest) else np.nan
    by_table = _departure(saturation, pressure)
    liquid = (histories.time > max(inputs.t_feed, 0.1)) & (histories.time < inputs.t_v - 0.01)
    bulk = fit_bulk(left[liquid], histories.tank_temperature(saturation)[liquid])
    hot = Quantity.absent("above the critical pressure")
    own, heat = _masses_and_heat(saturation, inputs, r, bulk.temperature if bulk else None)
    rest = Rest(
        pressure=Quantity(pressure, "Pa", bias),
        temperature=_by_table(t_rest, float(np.hypot(bias / slope, by_table))) if np.isfinite(t_rest) else hot,
        bulk_temperature=_bulk_quantity(bulk, float(np.hypot(bias / slope if np.isfinite(slope) else 0.2, by_table))),
        liquid_fraction=Quantity(share, "") if share is not None else Quantity.absent("not a saturated tank"),
        blowdown_mass=own,
        liquid_phase_heat=heat,
        load_cell_mass=_cell(log, segments),
    )
    remarks += [*_stratified(rest), *other_masses(rest, mass)]
    return rest.but(remarks=tuple(remarks)), remarks


def _departure(saturation: Saturation, pressure: float) -> float:
    """By how much the other table reads another temperature [K] off a pressure [Pa], as a standard deviation."""
    apart = abs(float(other_table(saturation).temperature(pressure)) - float(saturation.temperature(pressure)))
    return apart / UNIFORM if np.isfinite(apart) else 0.0


def _by_table(temperature: float, std: float) -> Quantity:
    return Quantity(temperature, "K", std, verdict=DERIVED, why="of saturation at the pressure, by the table")


def _bulk_quantity(bulk: Any, error: float) -> Quantity:
    if bulk is None:
        return Quantity.absent("too few samples between t_feed and t_v")
    return _by_table(bulk.temperature, float(np.hypot(bulk.std, error)))


def _masses_and_heat(
    saturation: Saturation, inputs: Inputs, r: Reduction, bulk: float | None
) -> tuple[Quantity, Quantity]:
    own = blowdown_mass(saturation, inputs.volume, bulk, r.temperature_v) if bulk is not None else None
    if bulk is None or own is None:
        reason = "the blowdown does not cool as a saturated tank does"
        return Quantity.absent(reason), Quantity.absent(reason)
    heat = liquid_phase_heat(saturation, inputs.volume, inputs.mass, bulk, r.temperature_v)
    return (
        Quantity(own, "kg", MODEL_MASS_SPREAD * own, why="from p_tank and volume alone, adiabatic"),
        Quantity(heat / inputs.t_v, "W", why="mean over the liquid phase that would reconcile mass and pressures"),
    )


def _cell(log: TestLog, segments: Segments) -> Quantity:
    cell = load_cell_mass(log, segments)
    return Quantity(cell[0], "kg", cell[1]) if cell else Quantity.absent("no load cell reading at rest")


def _stratified(rest: Rest) -> list[str]:
    if rest.temperature.value is None or rest.bulk_temperature.value is None:
        return []
    warmer = rest.temperature.value - rest.bulk_temperature.value
    if warmer < STRATIFIED:
        return []
    return [
        f"the tank is stratified or late to boil: {rest.temperature.value - 273.15:.1f} degC by its pressure at rest, "
        f"but the blowdown starts from {rest.bulk_temperature.value - 273.15:.1f} degC"
    ]


def other_masses(rest: Rest, mass: LoadedMass) -> dict[str, float]:
    """What cell and blowdown have instead of the loaded ``mass`` [kg], by the sentences that say so."""
    out = {}
    cell, own = rest.load_cell_mass, rest.blowdown_mass
    if (
        cell.value is not None
        and abs(cell.value - mass.value) > 3.0 * np.hypot(cell.std or 0.0, mass.std) + 0.02 * mass.value
    ):
        words = f"the load cell reads {cell.value:.2f} kg at rest, the calibration works with {mass.value:.2f} kg"
        out[words] = cell.value
    if own.value is not None and abs(own.value - mass.value) > 3.0 * np.hypot(own.std or 0.0, mass.std):
        words = (
            f"the blowdown fits {own.value:.1f} kg, not {mass.value:.1f} kg: the mass is off by kilograms, or heat or "
            "nitrogen carries the pressure; C_i scales with the mass that is right"
        )
        out[words] = own.value
    return out
