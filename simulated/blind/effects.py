"""What may be hidden in a case: the eighteen effects a library is expected to have, and fourteen it is not.

Each has one strength in its own unit, 0 for none, and a shape drawn per stand. The closures are written out in
closures.py, kernel.py and sensed.py; docs/blind.md lists them with their sources.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from . import sensed
from . import slots as s

Array = NDArray[np.float64]

EQUATIONS = (
    "tank_energy",
    "tank_volume",
    "injector",
    "feed",
    "grain",
    "chamber_mass",
    "chamber_energy",
    "nozzle",
    "sensor",
)

Draw = Callable[[np.random.Generator], float]


def between(low: float, high: float) -> Draw:
    """Uniform."""
    return lambda rng: float(rng.uniform(low, high))


def one_of(*values: float) -> Draw:
    """Any of them."""
    return lambda rng: float(rng.choice(values))


@dataclass(frozen=True)
class Effect:
    """One effect.

    ``nominal`` is a small step for differences, ``most`` the largest plausible strength, both in ``unit``.
    ``equations`` holds the governing equation that it enters first and others in which the same channels may show it.
    ``slot`` is where the strength goes; effects of sensors have ``distortion`` instead.
    """

    name: str
    unit: str
    nominal: float
    most: float
    equations: tuple[str, ...]
    inside: bool
    slot: int | None = None
    distortion: sensed.Distortion | None = None
    shape: Mapping[str | int, Draw] = field(default_factory=dict)
    source: str = ""
    sudden: bool = False

    @property
    def equation(self) -> str:
        """The governing equation that it enters."""
        return self.equations[0]


KARABEYOGLU = (
    "Karabeyoglu, Altman, Cantwell: Combustion of Liquefying Hybrid Propellants: Part 1, General Theory, "
    "J. Propulsion and Power 18(3), 2002"
)
LUBIN = (
    "Lubin, Springer: The formation of a dip on the surface of a liquid draining from a tank, J. Fluid Mech. 29, 1967"
)
SUMMERFIELD = (
    "Summerfield: A theory of unstable combustion in liquid propellant rocket systems, "
    "J. American Rocket Society 21, 1951"
)
SEPARATION = (
    "Summerfield, Foster, Swan: Flow separation in overexpanded supersonic exhaust nozzles, Jet Propulsion 24, 1954"
)
CARMICINO = (
    "Carmicino: Acoustics, Vortex Shedding, and Low-Frequency Dynamics Interaction in an Unstable Hybrid Rocket, "
    "J. Propulsion and Power 25(6), 2009"
)
BERGWERK = "Bergwerk: Flow pattern in Diesel nozzle spray holes, Proc. Institution of Mechanical Engineers 173, 1959"
LOCKHART = (
    "Lockhart, Martinelli: Proposed correlation of data for isothermal two-phase, two-component flow in pipes, "
    "Chemical Engineering Progress 45, 1949"
)
LEUNG = (
    "Leung: A generalized correlation for one-component homogeneous equilibrium flashing choked flow, AIChE J. 32, 1986"
)
VALVES = "IEC 60534-2-1, expansion factor of control valves"
BARTZ = "Bartz: A simple equation for rapid estimation of rocket nozzle convective heat transfer coefficients, 1957"

_CHANNEL = {"channel": one_of(0, 1, 2), "sign": one_of(-1, 1)}

LIBRARY = (
    Effect("tank_heat", "W", 600.0, 8000.0, ("tank_energy",), True, s.HEAT,
           shape={s.HEAT_LAG: between(1.5, 6.0), s.HEAT_FADE: between(10.0, 40.0)}),
    Effect("tank_wall_heat_capacity", "W/K", 40.0, 900.0, ("tank_energy",), True, s.WALL,
           shape={s.WALL_CAPACITY: between(2500.0, 9000.0)}),
    Effect("tank_nonequilibrium", "", 0.03, 1.5, ("tank_energy", "tank_volume"), True, s.LAG, sudden=True,
           shape={s.LAG_TIME: between(0.03, 0.12), s.LAG_NUCLEATION: between(0.2, 0.8)}),
    Effect("tank_stratification", "K", 0.15, 12.0, ("tank_energy", "tank_volume"), True, s.LAYER, sudden=True,
           shape={s.LAYER_VOLUME: between(0.2e-3, 1.5e-3)}),
    Effect("n2_purge", "kg/s", 0.001, 0.12, ("tank_volume", "tank_energy"), True, s.NITROGEN_FLOW, sudden=True),
    Effect("feed_line_fill", "m^3", 0.3e-4, 1.5e-3, ("feed",), True, s.LINE, sudden=True),
    Effect("injector_two_phase", "", 0.01, 1.0, ("injector",), True, s.TWO_PHASE, source=LEUNG, sudden=True),
    Effect("injector_choked_vapor", "", 0.2, 1.6, ("injector",), True, s.VAPOR_CHOKING, source=VALVES, sudden=True),
    Effect("combustion_efficiency", "", 0.02, 0.3, ("chamber_energy",), True, s.EFFICIENCY, sudden=True),
    Effect("chamber_heat_loss", "W", 3e4, 5e5, ("chamber_energy",), True, s.CHAMBER_HEAT, source=BARTZ, sudden=True,
           shape={s.CHAMBER_HEAT_FADE: between(1.0, 8.0)}),
    Effect("grain_pressure_regression", "", 0.1, 1.2, ("grain",), True, s.PRESSURE_BURNING, sudden=True,
           shape={s.REFERENCE_PRESSURE: between(6e5, 12e5)}),
    Effect("ignition_transient", "kg", 0.005, 0.25, ("chamber_mass",), True, s.IGNITION, sudden=True,
           shape={s.IGNITION_TIME: between(0.05, 0.25)}),
    Effect("fuel_sliver", "m", 0.3e-3, 6e-3, ("grain",), True, s.SLIVER),
    Effect("nozzle_throat_erosion", "m/s", 3e-5, 6e-4, ("nozzle",), True, s.EROSION,
           shape={s.EROSION_DELAY: between(0.5, 2.5)}),
    Effect("nozzle_divergence", "", 0.02, 0.25, ("nozzle",), True, s.DIVERGENCE, sudden=True),
    Effect("load_cell_drift", "N", 20.0, 800.0, ("sensor",), True, distortion=sensed.load_cell_drift,
           shape={"fast": between(0.4, 0.8), "first": between(0.8, 2.5), "second": between(4.0, 10.0)}),
    Effect("pressure_transducer_offset", "Pa", 0.1e5, 3e5, ("sensor",), True, distortion=sensed.transducer_offset,
           shape=_CHANNEL, sudden=True),
    Effect("chamber_tap_lag", "s", 0.02, 0.6, ("sensor",), True, distortion=sensed.tap_lag, sudden=True),
)  # fmt: skip

OUTSIDE = (
    Effect("tank_gas_ingestion", "m^3", 0.3e-3, 5e-3, ("injector", "tank_volume"), False, s.INGESTION, source=LUBIN),
    Effect("feed_coupled_chugging", "", 0.05, 0.6, ("injector", "feed"), False, s.CHUGGING, source=SUMMERFIELD,
           shape={s.CHUGGING_FREQUENCY: between(3.0, 9.0), s.CHUGGING_START: between(0.8, 2.0),
                  s.CHUGGING_END: between(2.5, 4.5)}),
    Effect("entrainment_regression", "", 0.1, 2.0, ("grain",), False, s.ENTRAINMENT, source=KARABEYOGLU,
           shape={s.ENTRAINMENT_LAG: between(0.3, 1.5)}),
    Effect("combustion_dc_shift", "", 0.05, 0.8, ("grain", "chamber_mass", "chamber_energy"), False, s.SHIFT,
           source=CARMICINO, shape={s.SHIFT_START: between(0.8, 1.8), s.SHIFT_END: between(2.2, 4.5)}, sudden=True),
    Effect("injector_hydraulic_flip", "", 0.03, 0.35, ("injector",), False, s.FLIP, source=BERGWERK,
           shape={s.FLIP_START: between(0.7, 2.5)}, sudden=True),
    Effect("nozzle_separation", "", 0.2, 1.5, ("nozzle",), False, s.SEPARATED, source=SEPARATION, sudden=True),
    Effect("feed_line_flashing", "", 0.1, 6.0, ("feed",), False, s.FLASHING, source=LOCKHART, sudden=True),
    Effect("throat_deposit", "m", 0.2e-3, 4e-3, ("nozzle",), False, s.DEPOSIT,
           shape={s.DEPOSIT_TIME: between(0.8, 3.0)}),
    Effect("dissolved_nitrogen", "Pa", 0.3e5, 9e5, ("tank_volume", "tank_energy"), False, s.DISSOLVED, sudden=True),
    Effect("slow_valve", "s", 0.05, 3.0, ("feed", "injector"), False, s.VALVE, sudden=True),
    Effect("vent_leak", "kg/s", 0.005, 0.3, ("tank_volume", "tank_energy"), False, s.LEAK, sudden=True),
    Effect("transducer_thermal_drift", "Pa", 0.1e5, 4e5, ("sensor",), False, distortion=sensed.transducer_drift,
           shape={**_CHANNEL, "delay": between(0.5, 2.0), "scale": between(1.5, 6.0)}),
    Effect("logger_skew", "s", 5e-3, 0.3, ("sensor",), False, distortion=sensed.logger_skew, sudden=True),
    Effect("stand_gusts", "N", 5.0, 400.0, ("sensor",), False, distortion=sensed.gusts, sudden=True,
           shape={f"{k}{i}": between(*r) for i in range(3) for k, r in (("f", (0.15, 0.8)), ("phase", (0.0, 6.28)))}),
)  # fmt: skip

EFFECTS = {e.name: e for e in (*LIBRARY, *OUTSIDE)}

Shape = dict[str | int, float]


@dataclass(frozen=True)
class Hidden:
    """An effect with a strength and a shape."""

    effect: Effect
    strength: float
    shape: Shape

    def at(self, strength: float) -> Hidden:
        """The same at another strength."""
        return Hidden(self.effect, strength, self.shape)


def drawn(effect: Effect, rng: np.random.Generator) -> Hidden:
    """At its nominal strength, with a shape."""
    return Hidden(effect, effect.nominal, {k: draw(rng) for k, draw in effect.shape.items()})


def slots_of(hidden: tuple[Hidden, ...]) -> Array:
    """The array that compiled code reads."""
    e = np.zeros(s.SLOTS)
    for h in hidden:
        if h.effect.slot is not None:
            e[h.effect.slot] = h.strength
            for where, value in h.shape.items():
                e[int(where)] = value
    return e


def named_shape(shape: Shape) -> dict[str, float]:
    """Shapes under readable names."""
    names = {getattr(s, name): name.lower() for name in _SLOT_NAMES}
    return {names[k] if isinstance(k, int) else k: v for k, v in shape.items()}


_SLOT_NAMES = (
    "HEAT_LAG", "HEAT_FADE", "WALL_CAPACITY", "LAG_TIME", "LAG_NUCLEATION", "LAYER_VOLUME", "CHAMBER_HEAT_FADE",
    "IGNITION_TIME", "EROSION_DELAY", "CHUGGING_FREQUENCY", "CHUGGING_START", "CHUGGING_END", "ENTRAINMENT_LAG",
    "SHIFT_START", "SHIFT_END", "DEPOSIT_TIME", "FLIP_START", "REFERENCE_PRESSURE",
)  # fmt: skip
