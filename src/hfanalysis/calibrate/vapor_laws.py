"""What the vapor phase says by either law of its flow: m, m where it chokes, and the C_d that an m of vapor needs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.calibrate.blowdown import Reduction
from hfanalysis.calibrate.choked_vapor import VAPOR_M, Expansion
from hfanalysis.calibrate.uncertainty import Draws
from hfanalysis.calibrate.verdicts import LEAST_ANSWERED, PHYSICAL_M
from hfanalysis.quantity import CONDITIONAL, NORMAL_95, NOT_IDENTIFIABLE, Quantity

DECIDES = "a cold flow of vapor through the injector would decide"
"""What tells m and the vapor's discharge coefficient apart."""


@dataclass(frozen=True)
class VaporLaws:
    """The vapor phase as ``measured``, its reduction ``r`` without effects, and the repetitions with all errors."""

    measured: Expansion
    r: Reduction
    draws: Draws

    def told(self, m: Quantity) -> dict[str, Quantity]:
        """``m`` [-] by the report's law with what the others say beside it, ``m_choked`` and ``vapor_C_d`` [-]."""
        choked, needed = self._exponent(), self._coefficient()
        out = {"m_choked": choked, "vapor_C_d": needed}
        if m.value is None or choked.value is None or needed.value is None:
            return out
        low, high = self._needs(throttled=False)
        beside = (
            f"m and the vapor's discharge coefficient cannot be told apart: {m.value:.2f} by the report's law, which "
            f"is incompressible; {choked.value:.2f} where the vapor chokes with C_d = C_i; and an m of "
            f"{PHYSICAL_M[0]:.1f} to {PHYSICAL_M[1]:.1f} needs a C_d of {low:.2f} to {high:.2f}; {DECIDES}"
        )
        return out | {"m": replace(m, why=f"{m.why}; {beside}" if m.why else beside)}

    def _exponent(self) -> Quantity:
        """m where the vapor chokes at C_d = C_i; its interval reaches as far as that by the density at p_run."""
        C_i, value = self.r.C_i, self.r.m_choked
        if not np.isfinite(value) or self.draws.answered("m_choked") < LEAST_ANSWERED:
            return self._none(f"no exponent takes the tank down as choked vapor does with a C_d of {C_i:.3f}")
        low, high = self.draws.interval("m_choked", value)
        other = replace(self.measured, throttled=True).exponent(C_i)
        reach = (low + other - value, high + other - value) if np.isfinite(other) else (low, high)
        why = (
            f"if the vapor chokes and its C_d is C_i, {C_i:.3f}; the density is that of the tank's vapor, as in C_i; "
            f"with that at p_run it is {other:.2f}, as far as which the interval reaches"
        )
        return _within(value, (min(low, reach[0]), max(high, reach[1])), why)

    def _coefficient(self) -> Quantity:
        """What C_d an m of 1.0 to 1.3 needs, with the errors of the reduction, by either density."""
        value, spread = self.r.vapor_C_d, self.draws.std("vapor_C_d")
        low, high = self._needs(throttled=False)
        _, widest = self._needs(throttled=True)
        if not np.isfinite([value, spread, low, high]).all():
            return self._none("no discharge coefficient takes the tank down as choked vapor of an m of 1.0 to 1.3 does")
        relative = NORMAL_95 * spread / value
        why = (
            f"if m is {PHYSICAL_M[0]:.1f} to {PHYSICAL_M[1]:.1f}, it is {high:.2f} to {low:.2f}; as told, for "
            f"{VAPOR_M}; up to {widest:.2f} with the density at p_run; C_i is {self.r.C_i:.3f}"
        )
        top = max(high, widest) if np.isfinite(widest) else high
        return _within(value, (low * max(1.0 - relative, 0.0), top * (1.0 + relative)), why)

    def _needs(self, throttled: bool) -> tuple[float, float]:
        """C_d [-] at either end of the exponents that vapor has, the lower first."""
        law = replace(self.measured, throttled=throttled)
        found = [law.coefficient(m) for m in PHYSICAL_M]
        return min(found), max(found)

    @staticmethod
    def _none(reason: str) -> Quantity:
        return Quantity.absent(reason, verdict=NOT_IDENTIFIABLE)


def _within(value: float, interval: tuple[float, float], why: str) -> Quantity:
    """A number that holds on a condition."""
    low, high = min(interval[0], value), max(interval[1], value)
    return Quantity(value, "", 0.5 * (high - low) / NORMAL_95, (low, high), verdict=CONDITIONAL, why=why)


def without_vapor(reason: str) -> dict[str, Quantity]:
    """Where there is no vapor phase to tell of."""
    return dict.fromkeys(("m_choked", "vapor_C_d"), VaporLaws._none(reason))
