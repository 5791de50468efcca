"""What no name explains, as it was found: a table over a state of the engine, with its band, as an effect.

The names of these effects say what they are: ``unknown_regression_factor_by_p_chamber`` adds to the factor of the
regression what the table has at the chamber's pressure; ``..._of_liquid`` as long as liquid flows. Beyond its ends a
table stays as it is at them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import lru_cache

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.sites import (
    AT_CHAMBER,
    AT_FLOW,
    AT_TANK,
    ENVIRONMENT,
    EQUATION_AND_UNIT,
    HOOK_OF_SITE,
    IS_LIQUID,
    OXIDIZER_FLOW,
    PORT_RADIUS,
    RATES,
    SITES,
    term,
)

KNOTS = 8
"""Values of a table, evenly spaced over its state. Source: what a burn shows of a slow source are some ten numbers."""

STRENGTH, SHIFT, LOW, HIGH, HOOK, SITE, STATE, WET, VALUES = range(9)
"""Where parameters are; the bands are behind the values."""

TIME, FLUX = -1, -2
"""States that are none of :data:`hfanalysis.engine.sites.ENVIRONMENT`."""

STATES: dict[str, tuple[int, str, str, int]] = {
    "p_chamber": (ENVIRONMENT.index("p_chamber"), "Pa", "chamber pressure", AT_CHAMBER),
    "oxidizer_flux": (FLUX, "kg/s/m^2", "oxidizer flux", RATES),
    "p_tank": (ENVIRONMENT.index("p_tank"), "Pa", "tank pressure", AT_TANK),
    "of_ratio": (ENVIRONMENT.index("of_ratio"), "-", "O/F in the chamber", AT_CHAMBER),
    "oxidizer_flow": (OXIDIZER_FLOW, "kg/s", "oxidizer flow", RATES),
    "port_radius": (PORT_RADIUS, "m", "port radius", AT_TANK),
    "m_liquid": (ENVIRONMENT.index("m_liquid"), "kg", "liquid in the tank", AT_FLOW),
    "time": (TIME, "s", "time since the opening", AT_TANK),
}
"""States that a source may follow: where the engine has them, their units, what people call them, and the hook from
which on they are known."""

_FEED = ("p_tank", "m_liquid", "p_chamber", "oxidizer_flow", "time")
_FUEL = ("oxidizer_flux", "p_chamber", "of_ratio", "port_radius", "oxidizer_flow", "time")
_GAS = ("p_chamber", "of_ratio", "port_radius", "time")
_UPSTREAM = {
    "tank_energy": _FEED, "tank_volume": _FEED, "injector": _FEED, "feed": _FEED, "grain": _FUEL,
    "chamber_energy": _GAS, "nozzle": _GAS,
}  # fmt: skip
"""States on which a source in an equation can depend, the likeliest first: nothing in the tank knows of the port."""

PREFIX = "unknown_"
_NAME = re.compile(rf"{PREFIX}({'|'.join(EQUATION_AND_UNIT)})_by_({'|'.join(STATES)})(_of_liquid)?")


@term
def _table(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook != int(p[HOOK]) or (p[WET] > 0.0 and env[IS_LIQUID] == 0.0):
        return
    which = int(p[STATE])
    if which == TIME:
        state = t
    elif which == FLUX:
        state = env[OXIDIZER_FLOW] / (np.pi * env[PORT_RADIUS] ** 2)
    else:
        state = env[which]
    u = min(max((state - p[LOW]) / (p[HIGH] - p[LOW]), 0.0), 1.0) * (KNOTS - 1)
    k = min(int(u), KNOTS - 2)
    f = u - k
    value = (1.0 - f) * p[VALUES + k] + f * p[VALUES + k + 1]
    band = (1.0 - f) * p[VALUES + KNOTS + k] + f * p[VALUES + KNOTS + k + 1]
    site[int(p[SITE])] += p[STRENGTH] * value + p[SHIFT] * band


def states_of(site: str) -> list[str]:
    """The states that a source at a site can follow, the likeliest first: those that are known where it is set."""
    hook = HOOK_OF_SITE.get(site, RATES)
    return [name for name in _UPSTREAM[EQUATION_AND_UNIT[site][0]] if STATES[name][3] <= hook]


def state_at(state: str, t: float, environment: Array) -> float:
    """The value [SI] of a state at ``t`` [s], with ``environment`` (:data:`hfanalysis.engine.sites.ENVIRONMENT`,)."""
    which = STATES[state][0]
    if which == TIME:
        return t
    if which == FLUX:
        return float(environment[OXIDIZER_FLOW] / (np.pi * environment[PORT_RADIUS] ** 2))
    return float(environment[which])


def hats(state: Array, low: float, high: float) -> Array:
    """What each value of a table counts (n, KNOTS) [-] at a ``state`` (n,) of a table from ``low`` to ``high`` [SI].

    >>> hats(np.array([0.5]), 0.0, 7.0).round(3).tolist()[0][:3]
    [0.5, 0.5, 0.0]
    """
    u = np.clip((state - low) / (high - low), 0.0, 1.0) * (KNOTS - 1)
    return np.maximum(1.0 - np.abs(u[:, None] - np.arange(KNOTS)[None, :]), 0.0)


def name_of(site: str, state: str, wet: bool) -> str:
    """The name of the effect that is a source at a site over a state, as long as liquid flows where it is ``wet``."""
    return f"{PREFIX}{site}_by_{state}{'_of_liquid' if wet else ''}"


def is_learnt(name: str) -> bool:
    """Whether a name is that of such an effect.

    >>> is_learnt("unknown_tank_heat_by_time"), is_learnt("tank_heat")
    (True, False)
    """
    return _NAME.fullmatch(name) is not None


def with_learnt(known: Mapping[str, Effect], names: Iterable[str]) -> dict[str, Effect]:
    """The known effects, and those of the ``names`` that are such tables."""
    return {**known, **{name: learnt(name) for name in names if name not in known and is_learnt(name)}}


@lru_cache(maxsize=64)
def learnt(name: str) -> Effect:
    """The effect of such a name; its parameters are the table's. Raises ValueError for another name."""
    found = _NAME.fullmatch(name)
    if found is None:
        raise ValueError(f"{name!r} is not the name of an unknown over a state")
    site, state, wet = found[1], found[2], found[3] is not None
    equation, unit = EQUATION_AND_UNIT[site]
    where, state_unit, called, _ = STATES[state]
    unit = "-" if unit == "1" else unit
    inner = {"hook": HOOK_OF_SITE.get(site, RATES), "site": SITES.index(site), "state": where, "wet": wet}
    return Effect(
        name,
        equation,
        "an unknown source as a diagnosis found it",
        "none: it was found, not derived",
        (
            Parameter("strength", "-", "1: as it was found", 1.0, low=0.0, high=2.0),
            Parameter("shift", "-", "standard deviations of its band that it is off by", 1.0, low=-4.0, high=4.0),
            Parameter("low", state_unit, f"{called} at the first value", 1.0, center=0.0, given=True),
            Parameter("high", state_unit, f"{called} at the last value", 1.0, center=1.0, given=True),
            *(Parameter(key, "-", "", 1.0, center=float(v), given=True, inner=True) for key, v in inner.items()),
            *(Parameter(f"value_{k}", unit, f"value {k + 1} of {KNOTS}", 1.0, given=True) for k in range(KNOTS)),
            *(Parameter(f"band_{k}", unit, f"its standard deviation, {k + 1}", 1.0, given=True) for k in range(KNOTS)),
        ),
        ("liquid",) if wet else ("liquid", "vapor", "nitrogen"),
        term=_table,
        sites=(site,),
        formula=f"a table over the {called}",
        plain_name=f"something without a name, by the {called}",
    )
