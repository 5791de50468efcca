"""The model's column of the performance table (report, table 4.6), with what uncertain constants make of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.unsteady import Burn
from hfanalysis.flight.constant_thrust import STANDARD_GRAVITY
from hfanalysis.inference.full_run import FullRun, moved
from hfanalysis.performance.measured import NAMES
from hfanalysis.products.calibration import Calibration
from hfanalysis.quantity import Quantity
from hfanalysis.validate.model_errors import changes


@dataclass(frozen=True)
class _Column:
    """The modeled numbers of one run, in the order of NAMES."""

    values: Array

    @classmethod
    def of(cls, full: FullRun, burnt: Burn, oxidizer: float, fuel: float, purge: float | None) -> _Column:
        impulse = float(burnt.state("impulse")[-1])
        peaks = [float(burnt.output(name).max()) for name in ("chamber_pressure", "thrust")]
        isp = impulse / (STANDARD_GRAVITY * (oxidizer + fuel))
        whole, to_purge = (_by_expended(full, burnt, end) for end in (np.inf, np.inf if purge is None else purge))
        table = [burnt.burn_time, impulse, whole, *peaks, impulse / burnt.burn_time, oxidizer, fuel, to_purge, isp]
        return cls(np.array(table))


def _by_expended(full: FullRun, burnt: Burn, end: float) -> float:
    """Impulse over the weight of all that left by injector and grain until ``end`` [s], or the burn's."""
    part = burnt.time <= max(end, float(burnt.time[1]))
    passed = float(np.trapezoid(burnt.output("oxidizer_flow")[part], burnt.time[part]))
    ports = burnt.state("port_radius")[part][[0, -1]]
    burned = full.engine.grain.fuel(ports[0]) - full.engine.grain.fuel(ports[1])
    return float(burnt.state("impulse")[part][-1] / (STANDARD_GRAVITY * (passed + burned)))


_UNITS = ("s", "N s", "s", "Pa", "N", "N", "kg", "kg", "s", "s")


def modeled(full: FullRun, calibration: Calibration, purge: float | None = None) -> dict[str, Quantity]:
    """The model's column [s, N s, Pa, N, kg], with what the errors of its constants make of it, drawn jointly;
    ``purge`` [s]: when nitrogen enters in the log."""
    engine = full.engine
    nominal = _Column.of(full, full.burnt, engine.oxidizer_mass, engine.fuel_mass, purge).values
    errors = np.zeros(len(NAMES))
    for change in changes(engine, calibration):
        oxidizer, fuel = (change.get(n, getattr(engine, n)) for n in ("oxidizer_mass", "fuel_mass"))
        try:
            other = _Column.of(full, moved(full, change), oxidizer, fuel, purge).values
        except (ValueError, ArithmeticError):
            continue
        errors += (other - nominal) ** 2
    out = {
        n: Quantity(float(v), u, float(e)) for n, v, u, e in zip(NAMES, nominal, _UNITS, np.sqrt(errors), strict=True)
    }
    if not full.burnt.fuel_out:
        reason = f"the model's fuel is not gone after {full.burnt.burn_time:.0f} s"
        out |= {name: Quantity.absent(reason) for name in ("burn_time", "average_thrust")}
    return out
