"""The named places in the governing equations at which an effect can act, and how compiled terms are called.

A *term* is a small compiled function that adds to sources or multiplies factors at these places. It is called once
per hook: each hook comes where the quantities that it may read are known and those that it may change are not yet
used::

    @term
    def blankets(hook, t, env, c, p, x, site, dx):
        if hook == RATES and env[IS_LIQUID] > 0.0:
            site[TANK_HEAT] += p[0]

``t`` is the time since ignition [s]; ``env`` what the model found so far (ENVIRONMENT), ``c`` the engine's constants
(:mod:`hfanalysis.engine.equations`), ``p`` the effect's parameters, ``x`` its own states, ``dx`` their rates. Terms run
through raw pointers, so that one compiled model serves every combination of effects.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from hfanalysis.compiled import Callback

AT_TANK, AT_CHAMBER, AT_FLOW, RATES = range(4)
"""Hooks: the tank's pressure is known; the chamber's gas; the flow into the chamber; all that the rates are made
of."""

SITES = (
    "tank_pressure",
    "tank_heat",
    "tank_leak",
    "nitrogen_inflow",
    "feed_loss",
    "feed_factor",
    "injector_factor",
    "regression_factor",
    "fuel_source",
    "oxidizer_source",
    "temperature_factor",
    "throat_factor",
    "thrust_factor",
)
"""Sources (tank_pressure and feed_loss [Pa], tank_heat [W], the other sources [kg/s]) and factors (*_factor [-])."""

(TANK_PRESSURE, TANK_HEAT, TANK_LEAK, NITROGEN_INFLOW, FEED_LOSS, FEED_FACTOR, INJECTOR_FACTOR, REGRESSION_FACTOR,
 FUEL_SOURCE, OXIDIZER_SOURCE, TEMPERATURE_FACTOR, THROAT_FACTOR, THRUST_FACTOR) = range(len(SITES))  # fmt: skip

EQUATION_AND_UNIT = {
    "tank_pressure": ("tank_energy", "Pa"),
    "tank_heat": ("tank_energy", "W"),
    "tank_leak": ("tank_volume", "kg/s"),
    "nitrogen_inflow": ("tank_volume", "kg/s"),
    "feed_loss": ("feed", "Pa"),
    "injector_factor": ("injector", "1"),
    "regression_factor": ("grain", "1"),
    "temperature_factor": ("chamber_energy", "1"),
    "throat_factor": ("nozzle", "1"),
    "thrust_factor": ("nozzle", "1"),
}
"""The governing equation of a site at which something of any shape may be, and the unit of what is there."""

HOOK_OF_SITE = {
    "tank_pressure": AT_TANK,
    "temperature_factor": AT_CHAMBER,
    "feed_loss": AT_FLOW,
    "feed_factor": AT_FLOW,
    "injector_factor": AT_FLOW,
}
"""By which hook a site has to be set; RATES for those that are not named."""

ENVIRONMENT = (
    "is_liquid", "is_burning", "p_ambient", "p_tank", "t_tank", "m_tank", "m_liquid", "m_nitrogen", "rho_feed",
    "p_chamber", "rt_chamber", "gamma_chamber", "of_ratio", "oxidizer_flow", "fuel_flow", "port_radius", "p_run",
    "hot_share", "nitrogen_share", "h_leaving", "h_chamber", "m_chamber", "u_by_mass", "u_by_temperature",
)  # fmt: skip
"""What a term may read, SI; ``p_tank`` and the rest of the tank from AT_TANK on, the chamber from AT_CHAMBER
(``hot_share``: of burnt gas in its mass), ``rho_feed`` from AT_FLOW, flows and ``p_run`` from RATES on.
``nitrogen_share`` by mass and ``h_leaving`` (on the properties' own scale) are of what leaves the tank, ``h_chamber``
of the chamber's nitrous oxide on the formation scale; ``u_by_*`` are the saturated tank's."""

(IS_LIQUID, IS_BURNING, P_AMBIENT, P_TANK, T_TANK, M_TANK, M_LIQUID, M_NITROGEN, RHO_FEED, P_CHAMBER, RT_CHAMBER,
 GAMMA_CHAMBER, OF_RATIO, OXIDIZER_FLOW, FUEL_FLOW, PORT_RADIUS, P_RUN, HOT_SHARE, NITROGEN_SHARE, H_LEAVING,
 H_CHAMBER, M_CHAMBER, U_BY_MASS, U_BY_TEMPERATURE) = range(len(ENVIRONMENT))  # fmt: skip

_REAL = types.float64
_POINTER = types.CPointer(_REAL)  # type: ignore[no-untyped-call]
TERM = types.void(types.int64, _REAL, *[_POINTER] * 6)
SWITCH = types.float64(_REAL, *[_POINTER] * 4)


def term(function: Callable[..., None]) -> Callback:
    """Compiles ``f(hook, t, env, c, p, x, site, dx)``."""
    return Callback(function, TERM)


def switch(function: Callable[..., float]) -> Callback:
    """Compiles ``f(t, env, c, p, x)``: where it changes sign the solver stops, for a term has a corner there."""
    return Callback(function, SWITCH)


ADDRESS, SWITCH_ADDRESS, PARAMETERS_AT, STATES_AT = range(4)
"""Columns of the table of active terms: addresses (0: none), where parameters begin in ``c`` and states in ``y``."""


def _data(context: Any, builder: Any, kind: Any, array: Any) -> Any:
    return cgutils.create_struct_proxy(kind)(context, builder, array).data  # type: ignore[no-untyped-call]


@intrinsic
def call_term(
    _typing: Any, address: Any, hook: Any, t: Any, env: Any, c: Any, p_at: Any, y: Any, x_at: Any, site: Any, dy: Any
) -> Any:
    """Call a term by its address; its parameters begin at ``c[p_at]``, its states at ``y[x_at]`` and ``dy[x_at]``."""
    signature = types.void(types.int64, types.int64, _REAL, env, c, types.int64, y, types.int64, site, dy)

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        where, hook_, t_, _, _, p_at_, _, x_at_, _, _ = args
        data = {i: _data(context, builder, sig.args[i], args[i]) for i in (3, 4, 6, 8, 9)}
        real = ir.DoubleType()
        pointer = real.as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [ir.IntType(64), real] + [pointer] * 6)
        function = builder.inttoptr(where, kind.as_pointer())
        parameters, states = builder.gep(data[4], [p_at_]), builder.gep(data[6], [x_at_])
        rates = builder.gep(data[9], [x_at_])
        builder.call(function, [hook_, t_, data[3], data[4], parameters, states, data[8], rates])
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def call_switch(_typing: Any, address: Any, t: Any, env: Any, c: Any, p_at: Any, y: Any, x_at: Any) -> Any:
    """Value of a switch by its address."""
    signature = types.float64(types.int64, _REAL, env, c, types.int64, y, types.int64)

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        where, t_, _, _, p_at_, _, x_at_ = args
        data = {i: _data(context, builder, sig.args[i], args[i]) for i in (2, 3, 5)}
        real = ir.DoubleType()
        pointer = real.as_pointer()
        kind = ir.FunctionType(real, [real] + [pointer] * 4)
        function = builder.inttoptr(where, kind.as_pointer())
        parameters, states = builder.gep(data[3], [p_at_]), builder.gep(data[5], [x_at_])
        return builder.call(function, [t_, data[2], data[3], parameters, states])

    return signature, generate
