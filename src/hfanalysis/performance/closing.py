"""How the masses of a burn close: what went in by injector and grain, and what the chamber pressure lets out.

Judged until nitrogen enters: from there on gas passes the throat that is in none of the flows. Over the burn the same
sums stand beside, without a verdict.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.engine.unsteady import Engine
from hfanalysis.performance.efficiency import Ideal, Spread, oxidizer_spread
from hfanalysis.performance.flows import Flows, nozzle_along
from hfanalysis.performance.measured import Fire
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.validation import Balance
from hfanalysis.quantity import NORMAL_95, Quantity

CLOSES, OPEN = "closes", "does not close"

CHEMISTRY = 0.01
"""Relative standard deviation of the equilibrium gas's c* [-]. Source: with the enthalpy of liquid nitrous oxide it is
1.3 % below that with PROPEP's, of the ideal gas (12 bar, O/F 10.5)."""


def closure(
    flows: Flows, measured: Mapping[str, Array], engine: Engine, ambient: float, fire: Fire, purge: float | None,
    spread: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> dict[str, Quantity]:  # fmt: skip
    """How the masses close over the burn.

    ``oxidizer_through_injector`` and ``fuel_burned`` [kg] are the flows' integrals; ``propellant_through_nozzle`` [kg]
    what the measured chamber pressure passes at the equilibrium gas's c*, nitrogen from ``purge`` [s] on included.
    ``spread``: their relative standard deviations [-].
    """
    part = (flows.time >= 0.0) & (flows.time <= fire.end)
    out = {
        "oxidizer_through_injector": _integral(flows.time, flows.oxidizer, part, "without nitrogen", spread[0]),
        "fuel_burned": _integral(flows.time, flows.fuel, part, "by a and n", spread[1]),
    }
    if "p_chamber" in measured:
        nozzle = nozzle_along(engine, measured["p_chamber"], flows.of_ratio, ambient).flow
        why = "p_chamber over the equilibrium gas's c*; what lacks is combustion that is not complete, or cold gas"
        why += "" if purge is None else "; from t_purge on nitrogen counts as propellant"
        out["propellant_through_nozzle"] = _integral(flows.time, np.nan_to_num(nozzle), part, why, spread[2])
    out["oxidizer_loaded"] = Quantity(engine.oxidizer_mass, "kg")
    out["fuel_loaded"] = Quantity(engine.fuel_mass, "kg")
    return out


def _integral(time: Array, value: Array, part: NDArray[np.bool_], why: str, relative: float = 0.0) -> Quantity:
    total = float(np.trapezoid(value[part], time[part]))
    if not np.isfinite(total):
        return Quantity.absent(f"the flow ({why}) is not known throughout the burn")
    return Quantity(total, "kg", total * relative if relative else None, why=why)


def spreads(calibration: Calibration, spread: Spread) -> tuple[float, float, float]:
    """Relative standard deviations [-] of what passes injector, grain and nozzle."""
    rate = calibration.regression_rate_reference
    by_rate = (rate.std or 0.0) / rate.value if rate.value else 0.0
    return oxidizer_spread(calibration), by_rate, float(np.linalg.norm([spread.pressure, spread.throat, CHEMISTRY]))


def balance(
    flows: Flows, measured: Mapping[str, Array], engine: Engine, ambient: float, fire: Fire, purge: float | None,
    found: Ideal, spread: tuple[float, float, float],
) -> Balance:  # fmt: skip
    """What goes in and out until ``purge`` [s], or to the burn's end without one, with a verdict.

    The nozzle passes less by shifting equilibrium than frozen, and less where the gauge sits at the head of a narrow
    port: the interval has both.
    """
    end = fire.end if purge is None else min(purge, fire.end)
    sums = closure(flows, {}, engine, ambient, Fire(end, fire.std, fire.source), None, spread)
    part = (flows.time >= 0.0) & (flows.time <= end)
    flow = nozzle_along(engine, measured["p_chamber"] * found.before.factor, flows.of_ratio, ambient).flow
    out = _integral(flows.time, np.nan_to_num(flow), part, "p_chamber over the equilibrium gas's c*", spread[2])
    entered = [sums[name] for name in ("oxidizer_through_injector", "fuel_burned")]
    told = {"until": Quantity(end, "s"), **{n: sums[n] for n in ("oxidizer_through_injector", "fuel_burned")}}
    if out.value is None or any(q.value is None for q in entered):
        why = next(str(q.reason) for q in (out, *entered) if q.value is None)
        return Balance(**told, propellant_through_nozzle=out, difference=Quantity.absent(why), verdict=None)
    gone = sum(q.value or 0.0 for q in entered)
    used = part & found.burning
    low, high = found.before.mean(used) if used.any() else (1.0, 1.0)
    slower = float(np.nanmean((found.c_star_frozen / found.c_star)[used])) if used.any() else 1.0
    out = out.scaled_to(low * slower, high)
    std = float(np.linalg.norm([q.std or 0.0 for q in (out, *entered)]))
    value = out.value - gone if out.value is not None else 0.0
    reach = [end_ - gone for end_ in (out.interval or (gone, gone))]
    half = NORMAL_95 * std
    difference = Quantity(value, "kg", std, (min(value - half, reach[0]), max(value + half, reach[1])))
    assert difference.interval is not None
    closes = difference.interval[0] <= 0.0 <= difference.interval[1]
    return Balance(**told, propellant_through_nozzle=out, difference=difference, verdict=CLOSES if closes else OPEN)
