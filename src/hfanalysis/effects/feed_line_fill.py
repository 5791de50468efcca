"""A feed line that the opening valve finds empty, and whose content boils away again as the pressure falls.

A rigid line is full once it is filled, and follows the tank at once. One whose content boils holds as much as its
pressure says: it fills more slowly the fuller it is, its pressure cannot leap as the liquid ends, and while the tank's
falls it feeds the injector from what it holds. Real lines lie between: a share of the line boils.

What fills the line comes from the tank, over and above what flows on, where the valve is open at once. A valve that
still opens lets the tank give no more than into a full line: the injector lacks what the line takes.
"""

from __future__ import annotations

from math import sqrt

from hfanalysis.compiled import compiled
from hfanalysis.engine.effect import Believable, Effect, OwnState, Parameter
from hfanalysis.engine.equations import AREA, LIQUID_LOSS, LOSS_FACTOR, VAPOR_LOSS
from hfanalysis.engine.feed_line import line_loss
from hfanalysis.engine.injector import flow_resistance
from hfanalysis.engine.sites import (
    AT_FLOW,
    FEED_FACTOR,
    FEED_LOSS,
    INJECTOR_FACTOR,
    IS_LIQUID,
    OXIDIZER_FLOW,
    P_CHAMBER,
    P_TANK,
    RATES,
    RHO_FEED,
    TANK_LEAK,
    term,
)

VOLUME, STEEPNESS, BOILING, THROTTLED = range(4)
CONTENT, EMPTY, PRESSURE = range(3)
LIQUID_DENSITY = 880.0
"""Of what fills the line [kg/m^3]. Source: saturated liquid nitrous oxide at 278 K (CoolProp: 881.5 kg/m^3)."""

FULL_AT = 40e5
"""Pressure [Pa] at which a line whose content boils holds as much as a full one: that of saturation at 283 K. Evidence:
in HF4 and HF5 the run line's pressure stays level for a fifth of a second while the tank's falls by two bar as the
liquid ends: what boils in the line holds it up."""

HELD_PER_PASCAL = LIQUID_DENSITY / FULL_AT
"""By what a boiling line holds more for its pressure, per volume [kg/m^3/Pa]."""

LEAST_FLOW = 1e-6
"""Onward flow [kg/s] that keeps the quotient finite where nothing flows."""

LEAST_VOLUME = 4e-6
"""Of any valve and fitting [m^3]: a line much smaller than that changes nothing."""

MOST_LACKING = 0.99
"""Of the pressure over line and injector [-]: what a valve takes does not become infinite."""

LEAST_PRESSURE = 1e3
"""Least pressure over line and injector [Pa]: what a line takes of none does not become infinite."""

LEAST_RESISTANCE = 0.05
"""Of the line over that of the injector [-], where the engine states none: filling does not become infinitely fast."""


@compiled
def drop_over_both(behind: float, orifice: float, line: float, factor: float) -> float:
    """Pressure drop [Pa] over line and injector that leaves ``behind`` [Pa] to the injector.

    ``orifice`` and ``line``: drop times density over the flow squared [1/m^4]; ``factor``: flow over that of both in
    row [-].

    >>> drop_over_both(2.0, 1.0, 0.5, 1.0)
    3.0
    """
    return behind * (orifice + line) / (orifice + line * (1.0 - factor * factor))


@compiled
def grown(onward: float, spare: float) -> float:
    """Flow [kg/s] through the line that takes a spare drop besides the loss of what flows ``onward`` [kg/s]; none back.

    ``spare``: that drop times density over the line's resistance [kg^2/s^2].

    >>> grown(3.0, 16.0)
    5.0
    """
    return sqrt(max(onward * onward + spare, 0.0))


@compiled
def held_back(onward: float, lacking: float, part: float) -> float:
    """Flow [kg/s] that the injector does not get, for ``part`` of ``lacking`` is missing of the pressure over line and
    injector; divided by ``part`` [-], so that a line of no volume has one, too.

    ``onward``: what it gets [kg/s]. Either goes by the root of the pressure.

    >>> held_back(1.0, 0.75, 1.0)
    1.0
    """
    root = sqrt(1.0 - min(lacking * part, MOST_LACKING))
    return onward * lacking / (root * (1.0 + root))


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    room = p[VOLUME] + LEAST_VOLUME
    rigid, boiling = p[VOLUME] * (1.0 - p[BOILING]), p[VOLUME] * p[BOILING]
    # a rigid line's own pressure comes up as it fills: what it lacks is spent on filling
    empty = max(x[EMPTY], 0.0) if env[IS_LIQUID] > 0.0 else 0.0
    lacking = empty ** p[STEEPNESS] * max(env[P_TANK] - env[P_CHAMBER], 0.0) / room
    # the line's loss is stated, one for each phase, or grows with the square of the flow
    stated = c[LIQUID_LOSS] >= 0.0
    lost = c[LIQUID_LOSS] if env[IS_LIQUID] > 0.0 else c[VAPOR_LOSS]
    orifice, line = flow_resistance(c[AREA], 0.0), c[LOSS_FACTOR] * site[FEED_FACTOR]
    if hook == AT_FLOW:
        # the drop over line and injector at which what is between them is at the boiling line's own pressure
        drop = x[PRESSURE] - env[P_CHAMBER]
        over = lost + drop if stated else drop_over_both(drop, orifice, line, min(site[INJECTOR_FACTOR], 1.0))
        site[FEED_LOSS] += rigid * lacking + boiling * (env[P_TANK] - env[P_CHAMBER] - over) / room
    elif hook == RATES:
        onward = env[OXIDIZER_FLOW]
        least = LEAST_RESISTANCE * orifice
        resistance = least if stated else max(least, line)
        per_drop = env[RHO_FEED] / resistance
        # grown(onward, V spare) - onward, over the volume: a small line fills at once, none not at all
        spare = lacking * per_drop
        inrush = spare / (grown(onward, p[VOLUME] * spare) + onward + LEAST_FLOW)
        # where the valve is still opening, what the injector does not get fills the line, and no more
        over_both = max(env[P_TANK] - env[P_CHAMBER] - (lost if stated else 0.0), LEAST_PRESSURE)
        filling = inrush + p[THROTTLED] * (held_back(onward, lacking / over_both, rigid) - inrush)
        # what boils holds as much as its pressure says
        loss = lost if stated else line_loss(line, onward, env[RHO_FEED])
        into = grown(onward, (env[P_TANK] - loss - x[PRESSURE]) * per_drop)
        dx[PRESSURE] = (into - onward) / (HELD_PER_PASCAL * room)
        stored = rigid * filling + boiling * dx[PRESSURE] * HELD_PER_PASCAL
        site[TANK_LEAK] += stored
        dx[CONTENT], dx[EMPTY] = stored, -filling / LIQUID_DENSITY


EFFECT = Effect(
    name="feed_line_fill",
    plain_name="feed line that fills first",
    stand_only="the stand's long feed line",
    equation="feed",
    meaning="the feed line is filled when the valve opens, and gives away what it holds as the pressure falls",
    reference="report, section 4.1 and phase 1 of its hot fires: the run line's pressure rises until the line is full. "
    "Flow into the line by the line's own loss p_T - p_run = K mdot^2 / rho, on to the chamber by the report's "
    "eq. 3.2. What boils is a lumped capacitance: in HF4 and HF5 the line's pressure does not leap as the liquid ends",
    formula="p_run = b p_L + (1 - b) p_r;  boiling: V (880 kg/m^3 / 40 bar) dp_L/dt = mdot_T - mdot_inj,  "
    "mdot_T = sqrt(rho (p_T - p_L) / K),  p_L(0) = p_a;  rigid: p_T - p_r = K mdot_inj^2 / rho + g (p_T - p_c),  "
    "g = e^k V / (V + 4 mL),  rho V de/dt = mdot_inj - (1 - s) sqrt(mdot_inj^2 + g (p_T - p_c) rho / K) "
    "- s mdot_inj / sqrt(1 - g),  e(0) = 1",
    sites=("feed_loss", "tank_leak"),
    parameters=(
        Parameter("volume", "m^3", "of the line between valve and injector", typical=2e-4, low=0.0, high=3e-3),
        Parameter(
            "steepness",
            "-",
            "of the pressure that a rigid line lacks, over the room still empty",
            0.7,
            center=1.5,
            low=1.0,
            high=4.0,
        ),
        Parameter(
            "boiling",
            "-",
            "share of the line whose content boils: it holds as much as its pressure says, rising and falling",
            0.5,
            center=0.5,
            low=0.0,
            high=1.0,
        ),
        Parameter(
            "throttled",
            "-",
            "by the valve while a rigid line fills: 0, the tank gives that besides; 1, the injector goes without it",
            0.5,
            center=0.5,
            low=0.0,
            high=1.0,
        ),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    reads=("injector_factor", "feed_factor"),
    states=(
        OwnState("line_content", "kg", 1e-3, lambda engine, values: 0.0),
        OwnState("line_empty", "-", 1e-3, lambda engine, values: 1.0),
        OwnState("line_pressure", "Pa", 1e3, lambda engine, values: engine.ambient),
    ),
    twins=(),
    decisive="the line's length and bore; and the run line's pressure at 1 kHz, where it is read more slowly",
    believable=Believable("volume", 1e-3, "a liter is ten meters of a line of 11 mm", unit="L", factor=1e3),
)
