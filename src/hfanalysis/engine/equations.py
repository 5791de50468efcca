"""An engine as compiled code reads it: its numbers, states and outputs, each under its name."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import types

from hfanalysis.arrays import Array, Integers
from hfanalysis.compiled import by_address, caller, compiled, inlined
from hfanalysis.thermo.combustion_table import Grid
from hfanalysis.thermo.saturation import evaluate

Table = tuple[Array, float, float, float]


class Equations(NamedTuple):
    """An engine as compiled code reads it.

    Addresses of :func:`rates` and of the events' function; saturated nitrous oxide, burnt gas and the drag coefficient
    over Mach number as tables; CONSTANTS and the effects' parameters; the active terms; ENVIRONMENT and SITES, which
    every evaluation writes anew; the KEPT parts of an evaluation.
    """

    rates: int
    events: int
    saturation: Table
    gas: Grid
    drag: Array
    c: Array
    terms: Integers
    env: Array
    site: Array
    kept: Array


_VECTOR, _REAL, _FLAG = types.float64[::1], types.float64, types.boolean
_TUPLE: Any = types.Tuple
_TABLE = _TUPLE((types.float64[:, :, ::1], _REAL, _REAL, _REAL))
_GRID = _TUPLE((types.float64[:, ::1], types.float64[:, ::1], types.float64[:, :, :, ::1], _REAL))
EQUATIONS = types.NamedTuple(  # type: ignore[no-untyped-call]
    (types.int64, types.int64, _TABLE, _GRID, types.float64[:, ::1], _VECTOR, types.int64[:, ::1], *[_VECTOR] * 3),
    Equations,
)
EVALUATION = types.none(_REAL, _VECTOR, _FLAG, _FLAG, types.int64, _VECTOR, _VECTOR)
address_of, equations_at = by_address(EQUATIONS)
call = caller(EVALUATION)
"""In compiled code, :class:`Equations` are passed on as ``model = address_of(m)``."""

STATES = (
    "tank_mass", "tank_temperature", "port_radius", "chamber_oxidizer", "chamber_fuel", "altitude", "speed", "impulse",
    "tank_nitrogen", "chamber_nitrogen", "chamber_enthalpy", "cold_gas", "cold_energy", "vapor_compressibility",
    "vapor_exponent",
)  # fmt: skip
"""SI. chamber_enthalpy is the stored nitrous oxide's [J], cold_energy the unburnt gas's m R T [J]; the last two are
constants that are set when the liquid runs out. The states of effects follow."""

(TANK, TEMPERATURE, RADIUS, OXIDIZER, FUEL, ALTITUDE, SPEED, IMPULSE, NITROGEN, CHAMBER_NITROGEN, ENTHALPY, COLD,
 COLD_ENERGY, COMPRESSIBILITY, EXPONENT) = range(len(STATES))  # fmt: skip

OUTPUTS = (
    "tank_pressure", "chamber_pressure", "chamber_temperature_by_mass", "thrust", "oxidizer_flow", "fuel_flow",
    "nozzle_flow", "of_ratio", "acceleration", "run_pressure", "gamma", "oxidizer_enthalpy", "nitrogen_share",
    "ambient_pressure", "nitrogen_inflow", "tank_outflow",
)  # fmt: skip
"""SI; oxidizer_flow is all that passes the injector, nitrogen_share that of nitrogen in it by mass."""

(O_TANK_PRESSURE, O_CHAMBER_PRESSURE, O_RT, O_THRUST, O_OXIDIZER_FLOW, O_FUEL_FLOW, O_NOZZLE_FLOW, O_OF, O_ACCELERATION,
 O_RUN_PRESSURE, O_GAMMA, O_ENTHALPY, O_SHARE, O_AMBIENT, O_NITROGEN_INFLOW, O_OUTFLOW) = range(16)  # fmt: skip

CONSTANTS = (
    "volume", "area", "loss_factor", "polytropic_exponent", "liquid_loss", "vapor_loss", "grain_length", "a", "n",
    "dead_volume", "fuel_density", "throat_area", "exit_area", "outer_radius", "oxidizer_enthalpy", "dry_mass",
    "drag_area", "climb", "launch_altitude", "ambient_pressure", "flies", "fuel_mass", "oxidizer_mass", "temperature",
    "spare_web", "fuel_end", "nitrogen_mass",
)  # fmt: skip
"""SI. A negative liquid_loss stands for the quadratic law, a NaN oxidizer_enthalpy for that of what leaves the tank, a
NaN polytropic_exponent for c_p/c_v when the liquid runs out, a NaN ambient_pressure for that of the altitude, an
infinite fuel_end [s] for the end of the web; parameters of effects follow."""

(VOLUME, AREA, LOSS_FACTOR, POLYTROPIC_EXPONENT, LIQUID_LOSS, VAPOR_LOSS, GRAIN_LENGTH, REGRESSION_A, REGRESSION_N,
 DEAD_VOLUME, FUEL_DENSITY, THROAT_AREA, EXIT_AREA, OUTER_RADIUS, OXIDIZER_ENTHALPY, DRY_MASS, DRAG_AREA, CLIMB,
 LAUNCH_ALTITUDE, AMBIENT_PRESSURE, FLIES, FUEL_MASS, OXIDIZER_MASS, INITIAL_TEMPERATURE,
 SPARE_WEB, FUEL_END, NITROGEN_MASS) = range(27)  # fmt: skip

KEEPS, KEPT_TANK, KEPT_CHAMBER, KEPT_NOZZLE, KEPT = 0, 1, 10, 22, 30
"""Where in :attr:`Equations.kept` stands whether evaluations leave their parts there, where those of tank, chamber and
nozzle begin (what was asked, then what was answered), and how many numbers there are. The same question gets the same
answer without work: most columns of a Jacobian leave two of the three alone."""


def nothing_kept() -> Array:
    """:attr:`Equations.kept` before the first evaluation, (KEPT,)."""
    kept = np.full(KEPT, np.nan)
    kept[KEEPS] = 1.0
    return kept


@inlined
def asked(kept: Array, at: int, question: tuple[float, ...]) -> bool:
    """Whether the kept answer in ``kept`` (KEPT,) from ``at`` on is to this very question [SI], to the bit."""
    same = True
    for i in range(len(question)):
        same = same and kept[at + i] == question[i]
    return same


@inlined
def keep(kept: Array, at: int, question: tuple[float, ...], answer: tuple[float, ...]) -> None:
    """Keep question and answer [SI] in ``kept`` (KEPT,) from ``at`` on, if this evaluation is one to keep."""
    if kept[KEEPS] > 0.0:
        for i in range(len(question)):
            kept[at + i] = question[i]
        for i in range(len(answer)):
            kept[at + len(question) + i] = answer[i]


@inlined
def at_saturation(m: Equations, row: int, temperature: float) -> float:
    """A row [SI] of the table of saturated nitrous oxide at a ``temperature`` [K]."""
    table, start, step, critical = m.saturation
    return float(evaluate(table, start, step, critical, row, temperature)[0])


@compiled
def evaluate_rates(t: float, y: Array, liquid: bool, burning: bool, m: Equations, dy: Array, out: Array) -> None:
    """:func:`rates`, for Python: of ``y`` (states,) [SI] at ``t`` [s], into ``dy`` (states,) [SI/s] and ``out``
    (outputs,) [SI]."""
    call(m.rates, t, y, liquid, burning, address_of(m), dy, out)


@inlined
def rates_at(t: float, y: Array, liquid: bool, burning: bool, model: int, dy: Array, out: Array) -> None:
    """:func:`rates`, for other compiled code: called, not merged into it.

    Of ``y`` (states,) [SI] at ``t`` [s], into ``dy`` (states,) [SI/s] and ``out`` (outputs,) [SI].
    """
    call(equations_at(model).rates, t, y, liquid, burning, model, dy, out)
