"""How well the engine burns and expands: c* and C_F over those of the equilibrium gas.

The reference is shifting equilibrium, the most that a nozzle gets out of a gas, as is usual in the field; beside it
frozen flow, which is the engine model's nozzle and the report's.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.engine.nozzle import SUPERSONIC, characteristic_velocity, expand
from hfanalysis.engine.unsteady import Engine
from hfanalysis.inference.budget import Input, relative, total
from hfanalysis.performance.flows import HISTORY_STEP, Flows, nozzle_along
from hfanalysis.performance.load_cell import CellError
from hfanalysis.performance.measured import Fire, bias
from hfanalysis.performance.tap import Before, before_nozzle
from hfanalysis.products.calibration import Calibration, TankConstants
from hfanalysis.products.segments import Segments
from hfanalysis.products.validation import Efficiencies, Finding
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.segment.end_of_burn import CRITICAL_RATIO
from hfanalysis.sentences import text
from hfanalysis.thermo.shifting import shifting

EFFICIENCY_WIDTH = 0.2
"""[s] of the running mean from which efficiencies are taken: a ratio of noisy values is noisier than either."""

BASIS = "shifting"
"""Of the efficiencies. Source: definition; NASA RP-1311, section 6, has both."""


@dataclass(frozen=True)
class Ideal:
    """The engine's own nozzle on the measured pressure, (n,) each: c* [m/s] and thrust [N], shifting and frozen.

    ``before``: the pressure before the nozzle over the gauge's; ``pressure`` [Pa] with it; ``vacuum``: C_F into vacuum
    [-], shifting; NaN where the nozzle does not flow full. ``on_exit`` [N]: the air's force on its exit.
    """

    before: Before
    pressure: Array
    burning: NDArray[np.bool_]
    counted: NDArray[np.bool_]
    c_star: Array
    c_star_frozen: Array
    thrust: Array
    thrust_frozen: Array
    vacuum: Array
    on_exit: float

    def force(self, factor: float, part: NDArray[np.bool_]) -> float:
        """Ideal thrust at ``factor`` [-] times the pressure over that at the pressure, mean of the samples ``part``
        (n,): the air's force on the exit stays."""
        shares = (self.thrust_frozen + self.on_exit)[part] / self.thrust_frozen[part]
        return 1.0 + (factor - 1.0) * float(np.nanmean(shares))


def ideal(
    measured: Mapping[str, Array], flows: Flows, engine: Engine, ambient: float, fire: Fire, purge: float | None,
    tap: str | None = None,
) -> Ideal | None:  # fmt: skip
    """Where the nozzle is choked and both propellants flow; None without a chamber pressure.

    ``ambient`` [Pa] is the air's; from ``purge`` [s] on nitrogen passes the throat, which is in none of the flows.
    """
    if "p_chamber" not in measured:
        return None
    read, oxidizer, fuel = (smooth(x) for x in (measured["p_chamber"], flows.oxidizer, flows.fuel))
    burning = (flows.time > 0.0) & (flows.time < fire.end) & (read > CRITICAL_RATIO * ambient) & (fuel > 1e-4)
    ratio = np.where(burning & (oxidizer > 1e-4), oxidizer / np.where(fuel > 1e-4, fuel, 1.0), np.nan)
    before = before_nozzle(tap, flows.port, nozzle_along(engine, read, ratio, ambient).gamma, engine)
    pressure = read * before.factor
    frozen = nozzle_along(engine, pressure, ratio, ambient)
    assert engine.oxidizer_enthalpy is not None
    gain, vacuum = shifting(
        pressure, ratio, engine.oxidizer_enthalpy, engine.exit_area / engine.throat_area, engine.combustion.fuel
    )
    vacuum = np.where(_full(engine, pressure, frozen.gamma, ambient), vacuum, np.nan)
    c_star = characteristic_velocity(frozen.heat, frozen.gamma)
    thrust = vacuum * pressure * engine.throat_area - ambient * engine.exit_area
    counted = burning if purge is None else burning & (flows.time < purge)
    return Ideal(before, pressure, burning, counted, gain * c_star, c_star, thrust, frozen.thrust, vacuum,
                 ambient * engine.exit_area)  # fmt: skip


def _full(engine: Engine, pressure: Array, gamma: Array, ambient: float) -> NDArray[np.bool_]:
    """Where the nozzle flows full in one dimension."""
    areas = engine.throat_area, engine.exit_area
    given = zip(gamma, pressure, strict=True)
    return np.array([g > 1.0 and expand(g, 1e6, p, ambient, *areas)[4] == SUPERSONIC for g, p in given])


def efficiencies(measured: Mapping[str, Array], flows: Flows, engine: Engine, found: Ideal | None) -> dict[str, Array]:
    """c* [m/s] and thrust coefficient [-] with their efficiencies [-], all (n,) at the times of ``flows``.

    c* = p_c A_t / mdot ends when nitrogen enters: p_c A_t over flows that do not count it would rise without bound.
    """
    if found is None:
        return {}
    flow = smooth(flows.oxidizer) + smooth(flows.fuel)
    c_star = np.where(found.counted, found.pressure * engine.throat_area / np.where(found.counted, flow, 1.0), np.nan)
    out = {
        "c_star": c_star,
        "c_star_efficiency": c_star / found.c_star,
        "c_star_efficiency_frozen": c_star / found.c_star_frozen,
    }
    if "thrust_corrected" in measured:
        thrust = smooth(measured["thrust_corrected"])
        out["thrust_coefficient"] = thrust / np.where(found.burning, found.pressure * engine.throat_area, np.nan)
        out["thrust_coefficient_efficiency"] = thrust / found.thrust
        out["thrust_coefficient_efficiency_frozen"] = thrust / found.thrust_frozen
    return out


def smooth(value: Array) -> Array:
    """Running mean over EFFICIENCY_WIDTH, narrower at the ends; (n,) on the histories' clock."""
    kernel = np.ones(round(EFFICIENCY_WIDTH / HISTORY_STEP))
    return np.asarray(np.convolve(value, kernel, "same") / np.convolve(np.ones(value.size), kernel, "same"))


def liquid_phase(time: Array, segments: Segments, fire: Fire) -> NDArray[np.bool_]:
    """Samples (n,) of the liquid phase at ``time`` [s]: line full, liquid and fuel there, no nitrogen, burning."""
    ends = [t for name in ("t_v", "t_purge", "t_fuel_out") if (t := segments.time(name)) is not None]
    return (time > max(segments.time("t_feed") or 0.0, EFFICIENCY_WIDTH)) & (time < min([*ends, fire.end]))


@dataclass(frozen=True)
class Spread:
    """Relative standard deviations [-] of what efficiencies rest on: gauge, throat, flows of oxidizer and fuel as parts
    of the whole; ``cell``: what each error of the load cell does, relative."""

    pressure: float
    throat: float
    oxidizer: float
    fuel: float
    cell: tuple[Input, ...] = ()

    @property
    def flow(self) -> float:
        """Of oxidizer and fuel together."""
        return float(np.hypot(self.oxidizer, self.fuel))

    @property
    def thrust(self) -> float:
        """By all errors of the cell."""
        return total(self.cell)

    @classmethod
    def of(
        cls, log: TestLog, definition: TestDefinition, calibration: Calibration, flows: Flows,
        measured: Mapping[str, Array], part: NDArray[np.bool_], cell: CellError | None = None,
    ) -> Spread:  # fmt: skip
        """Over the samples ``part`` (n,)."""

        def level(history: str) -> float:
            return float(np.mean(measured[history][part])) if history in measured else 0.0

        chamber, thrust = level("p_chamber"), level("thrust_corrected")
        oxidizer, fuel = float(flows.oxidizer[part].mean()), float(flows.fuel[part].mean())
        whole = max(oxidizer + fuel, 1e-9)
        return cls(
            bias(log["p_chamber"]) / chamber if chamber > 0.0 else 0.0,
            throat_spread(definition),
            oxidizer * oxidizer_spread(calibration) / whole,
            fuel * _relative(calibration.regression_rate_reference) / whole,
            relative(cell.at(thrust, 0.5), thrust) if cell is not None and thrust > 0.0 else (),
        )


def oxidizer_spread(calibration: TankConstants) -> float:
    """Relative standard deviation [-] of the flow of liquid: that of the mass that it adds up to, for an error of the
    holes' area is in C_i and not in their product."""
    return _relative(calibration.oxidizer_mass_liquid_phase)


def throat_spread(definition: TestDefinition) -> float:
    """Relative standard deviation of the throat's area [-]: as stated, else as it is machined."""
    radius = definition.known("nozzle.throat_radius")
    return 0.0 if radius is None else 2.0 * (radius.std or 0.0) / radius.value


def _relative(quantity: Quantity) -> float:
    return (quantity.std or 0.0) / abs(quantity.value) if quantity.value else 0.0


_UNITS = {"c_star": "m/s"}
_OF_IDEAL = ("thrust_coefficient_efficiency", "thrust_coefficient_efficiency_frozen")
_THRUST = ("thrust_coefficient", "thrust_coefficient_efficiency", "thrust_coefficient_efficiency_frozen")


def means(histories: Mapping[str, Array], found: Ideal, part: NDArray[np.bool_], spread: Spread) -> Efficiencies:
    """Means over the samples ``part`` (n,) of the liquid phase; the place of the tap widens them to one side."""
    low, high = found.before.mean(part)
    by_c_star = float(np.linalg.norm([spread.pressure, spread.throat, spread.flow]))
    by_thrust = float(np.linalg.norm([spread.pressure, spread.throat, spread.thrust]))
    out = {}
    for name in ("c_star", "c_star_efficiency", "c_star_efficiency_frozen", *_THRUST):
        values = histories[name][part] if name in histories else np.array([])
        if not np.isfinite(values).any():
            out[name] = Quantity.absent(
                "nothing to tell it from in the liquid phase: no channel, or the nozzle not full"
            )
            continue
        value = float(np.nanmean(values))
        of_thrust = name in _THRUST
        std = value * (by_thrust if of_thrust else by_c_star)
        ends = [1.0 / found.force(end, part) if name in _OF_IDEAL else 1.0 / end for end in (low, high)]
        ends = ends if of_thrust else [low, high]
        why = "mean over the liquid phase" + ("; one side by where the gauge sits" if low < 1.0 == high else "")
        out[name] = Quantity(value, _UNITS.get(name, ""), std, why=why).scaled_to(*ends)
    return Efficiencies.from_json(out)


def above_one(found: Efficiencies) -> list[Finding]:
    """Efficiencies that are above 1 by more than their intervals: something that they rest on is off."""
    out = []
    for name, channels, words in (
        ("c_star_efficiency", ("p_chamber",), "c* efficiency"),
        ("thrust_coefficient_efficiency", ("thrust", "p_chamber"), "C_F efficiency"),
    ):
        quantity: Quantity = getattr(found, name)
        if quantity.value is None or quantity.interval is None or quantity.interval[0] <= 1.0:
            continue
        low, high = quantity.interval
        said = text(
            "{words} is {value:.3f} ({low:.3f} to {high:.3f}) of shifting equilibrium, the most that the gas can give; "
            "{where} is off",
            words=words, value=quantity.value, low=low, high=high,
            where="chamber gauge, throat or thrust cell" if "thrust" in channels else "chamber gauge, throat or flow",
        )  # fmt: skip
        out.append(Finding(channels=channels, verdict="efficiency above one", text=said, size=quantity))
    return out


def chamber_over_throat(engine: Engine, port: float) -> float:
    """L* [m] with a ``port`` [m]."""
    return (engine.dead_volume + pi * port**2 * engine.grain_length) / engine.throat_area
