"""What a calibrated number is worth: identified, not identifiable, or unphysical, and why."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hfanalysis.calibrate.blowdown import Inputs, Reduction
from hfanalysis.calibrate.reducing import EXPONENTS
from hfanalysis.calibrate.uncertainty import Draws
from hfanalysis.engine.closure import implied_heat
from hfanalysis.quantity import DERIVED, DOUBTED, IDENTIFIED, NOT_IDENTIFIABLE, UNPHYSICAL, Quantity
from hfanalysis.sentences import said, text
from hfanalysis.thermo.saturation import Saturation

PHYSICAL_C_I = (0.05, 1.0)
"""A hole passes no more than the ideal flow, and drilled plates pass 0.2 to 0.9 of it. Source: report, 4.2.1: 0.26 and
0.29 here, 0.50 to 0.79 of high-performance injectors."""

USUAL_C_I = (0.15, 0.95)
"""Beyond which it is doubted [-]. Source: report, 4.2.1: those of its injectors and of others that it lists are 0.26 to
0.79; this is wider by a half below and a fifth above."""

PHYSICAL_M = (1.0, 1.3)
"""Polytropic exponents [-] of expanding nitrous oxide vapor near saturation. Source: 1 where heat keeps its
temperature, up to the ratio of heat capacities of the gas, 1.3 at 250 K (CoolProp)."""

LEAST_ANSWERED = 0.9
"""Part of the draws [-] that must have an m for there to be one; the others are counted in the reason."""
WIDEST_M = 0.2
"""Standard deviation of m from which on the phase says nothing about it. Evidence: test_refusals.py: a vapor phase of
milliseconds does not tell m."""


def judged(name: str, value: float, unit: str, draws: Draws, unphysical_below: float | None = None) -> Quantity:
    """A quantity with its deviation and interval from the draws, ``value`` in ``unit``; unphysical where the interval
    lies below a bound [``unit``].
    """
    if not np.isfinite(value) or not np.isfinite(draws.std(name)):
        return Quantity.absent("the reduction has no answer", verdict=NOT_IDENTIFIABLE)
    interval = draws.interval(name, value)
    if unphysical_below is not None and interval[1] < unphysical_below:
        why = "negative: the two pressure sensors disagree in sign"
        return Quantity(value, unit, draws.std(name), interval, verdict=UNPHYSICAL, why=why)
    return Quantity(value, unit, draws.std(name), interval, verdict=IDENTIFIED)


def looked_up(found: Quantity) -> Quantity:
    """What no log tells but a table, at the pressure of t_v: derived, as well as the table is known."""
    why = "the table of nitrous oxide at the tank's pressure of t_v; its deviation holds what the other table has"
    return replace(found, verdict=DERIVED, why=why) if found.verdict == IDENTIFIED else found


def judge_discharge(r: Reduction, draws: Draws, reversed_share: float) -> Quantity:
    """C_i [-] with its verdict; ``reversed_share`` [-]: of the samples in which p_run is not above p_chamber."""
    quantity = judged("C_i", r.C_i, "", draws)
    if quantity.value is None or quantity.interval is None:
        return quantity
    low, high = quantity.interval
    verdict, why = IDENTIFIED, None
    if r.C_i <= 0.0:
        verdict, why = UNPHYSICAL, "the loaded mass is less than the vapor left at t_v: mass, volume or t_v is off"
    elif low > PHYSICAL_C_I[1] or high < PHYSICAL_C_I[0]:
        verdict = UNPHYSICAL
        why = f"outside {PHYSICAL_C_I[0]} to {PHYSICAL_C_I[1]}: loaded mass, hole area or a pressure is off"
    elif low > USUAL_C_I[1] or high < USUAL_C_I[0]:
        verdict = DOUBTED
        why = "drilled plates pass 0.2 to 0.9 of the ideal flow: loaded mass, hole area or a pressure may be off"
    elif reversed_share > 0.01:
        why = f"p_run is not above p_chamber in {100.0 * reversed_share:.1f} % of the samples; these count as no flow"
    return Quantity(r.C_i, "", quantity.std, quantity.interval, verdict=verdict, why=why)


def judge_exponent(
    r: Reduction, draws: Draws, inputs: Inputs, end_reason: str | None, saturation: Saturation
) -> Quantity:
    """m [-] with its verdict; an exponent outside the physical range with the heat [J] that it would take (report,
    4.2.2).
    """
    if end_reason is not None:
        return Quantity.absent(end_reason, verdict=NOT_IDENTIFIABLE)
    duration = inputs.t_end - inputs.t_v
    if not np.isfinite(r.m) or draws.answered("m") < LEAST_ANSWERED:
        return Quantity.absent(_no_root(r, inputs, duration, draws), verdict=NOT_IDENTIFIABLE)
    std = draws.std("m")
    if std > WIDEST_M:
        reason = text(
            "the vapor phase lasts {duration:.3f} s and loses {loss}: too little to tell m ({m:.2f} +/- {std:.2f})",
            duration=duration,
            loss=said(inputs.p_v - inputs.p_end, "bar", ".2f"),
            m=r.m,
            std=std,
        )
        return Quantity.absent(reason, verdict=NOT_IDENTIFIABLE)
    low, high = draws.interval("m", r.m)
    heat = implied_heat(saturation, r.m, r.vapor_mass, r.vapor_mass_end, r.temperature_v, r.Z)
    t_end = r.temperature_v * (r.vapor_mass_end / r.vapor_mass) ** (r.m - 1.0)
    power = f"{heat / duration / 1e3:+.1f} kW into the vapor"
    implies = f"if the vapor flows so, it implies {power} and {t_end - 273.15:.0f} degC at its end"
    outside = high < PHYSICAL_M[0] or low > PHYSICAL_M[1]
    verdict = UNPHYSICAL if outside else IDENTIFIED
    lead = f"outside {PHYSICAL_M[0]} to {PHYSICAL_M[1]}, no property of nitrous oxide: " if outside else ""
    return Quantity(r.m, "", std, (low, high), verdict=verdict, why=lead + implies)


def _no_root(r: Reduction, inputs: Inputs, duration: float, draws: Draws) -> str:
    if np.isfinite(r.m):
        part = 100.0 * (1.0 - draws.answered("m"))
        return (
            f"within the uncertainties {part:.0f} % of the repetitions have no exponent: "
            f"{duration:.3f} s of vapor are too short"
        )
    if inputs.p_end >= inputs.p_v:
        return "the tank pressure does not fall over the vapor phase: something feeds it"
    return text(
        "no exponent between {low:.2f} and {high:.1f} takes the tank from {first} to {last} in {duration:.3f} s",
        low=EXPONENTS[0],
        high=EXPONENTS[-1],
        first=said(inputs.p_v, "bar", ".1f"),
        last=said(inputs.p_end, "bar", ".1f"),
        duration=duration,
    )
