"""On what an a and n hold that a fit tells apart: what fuels are known for, and at which flux the log was looked at.

None of it makes a law wrong: a fit may be as good as it looks, and the flow or the effects that it rests on may not be.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import sqrt

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.calibrated import Regression
from hfanalysis.calibrate.evidence import Evidence
from hfanalysis.calibrate.likelihood import Weights
from hfanalysis.engine.equations import RADIUS
from hfanalysis.engine.grain import oxidizer_flux
from hfanalysis.engine.unsteady import Burn
from hfanalysis.quantity import CONDITIONAL, HOLDS_ZERO, IDENTIFIED

PARAFFIN_N = (0.4, 0.8)
"""Exponents [-] that paraffin is known for. Source: 0.50 and 0.555 published with nitrous oxide (Genevieve, University
of KwaZulu-Natal, 2013, and the laws that it compares), 0.62 with oxygen (Karabeyoglu et al., J. Propulsion and Power
20(6), 2004), a tenth less for what reductions differ by; no more than the 0.8 of a turbulent boundary layer (Marxman).
"""

PARAFFIN_LAWS = ((1.17e-4, 0.62), (1.32e-4, 0.555), (1.55e-4, 0.5))
"""Its published laws (a [m/s (kg/m^2/s)^-n], n [-]). Source: the same."""

TIMES = 2.0
"""Times the fastest of them, and part of the slowest, that a paraffin's rate may be [-]. Evidence: at 100 to 500
kg/(m^2 s) they differ from each other by 1.4 to 1.6 times; grains are larger and smaller than those they are of."""

SOURCE = "Karabeyoglu 2004, Genevieve 2013"

CARRIES = 2.0
"""Times by which the variance of n grows without the burn time, from which on it carries the fit [-]. Source:
definition: more than half of what is known comes from it."""


def conditions(
    law: Regression, flux: float, window: tuple[float, float], trickle: str = "", wax: bool = True
) -> Iterator[str]:  # fmt: skip
    """Why a and n hold on a condition, in words, with the source.

    Args:
        law: a [SI] and n [-].
        flux: the reference flux [kg/m^2/s], at which the rate is known best.
        window: least and largest flux [kg/m^2/s] that were compared.
        trickle: what :func:`set_by_trickle` says.
        wax: whether the fuel is paraffin, the only one of which laws are compared.
    """
    if wax:
        yield from _beside_paraffin(law, flux)
    least, most = window
    if not least <= flux <= most:
        yield (
            f"the rate is known best at a flux of {flux:.0f} kg/(m^2 s), outside the {least:.0f} to {most:.0f} that "
            "were compared"
        )
    if trickle:
        yield trickle


def _beside_paraffin(law: Regression, flux: float) -> Iterator[str]:
    low, high = PARAFFIN_N
    if not low <= law.n <= high:
        yield f"n is outside what paraffin is known for, {low} to {high} [{SOURCE}]"
    rate, known = law.a * flux**law.n, [a * flux**n for a, n in PARAFFIN_LAWS]
    slow, fast = min(known) / TIMES, max(known) * TIMES
    if not slow <= rate <= fast:
        yield (
            f"a is outside what paraffin is known for: {1e3 * rate:.2f} mm/s at {flux:.0f} kg/(m^2 s), "
            f"and not {1e3 * slow:.2f} to {1e3 * fast:.2f} [{SOURCE}]"
        )


def conditioned(judged: tuple[str, str], n: tuple[float, float], reasons: Iterable[str]) -> tuple[str, str]:
    """A verdict and why, of what is ``judged`` identified, on the condition of the ``reasons``; ``n`` [-]: its 95 %."""
    found = list(reasons)
    if judged[0] != IDENTIFIED or not found:
        return judged
    unsure = [HOLDS_ZERO.replace("its", "n's")] if n[0] <= 0.0 <= n[1] else []
    return CONDITIONAL, "; ".join(found + unsure)


def set_by_trickle(
    evidence: Evidence, weights: Weights, burnt: Burn, slopes: Array, window: tuple[float, float]
) -> str:
    """That the burn time ends on vapor at a flux below the ``window`` [kg/m^2/s] and carries the fit; empty where not.

    ``slopes`` (observations, 2): of what was observed [Pa, s, kg] by (ln r, n).
    """
    gone = burnt.liquid_out
    if evidence.burn_time is None or gone is None or burnt.burn_time <= gone:
        return ""
    last = float(oxidizer_flux(burnt.last("oxidizer_flow"), burnt.steps.end[-1, RADIUS]))
    if last >= window[0]:
        return ""
    covariance = np.asarray(np.linalg.inv(weights.precision), dtype=np.float64)
    rest = np.delete(np.arange(evidence.observed.size), evidence.time.size)
    spread, without = variance_of_n(slopes, covariance), variance_of_n(slopes[rest], covariance[np.ix_(rest, rest)])
    if without < CARRIES * spread:
        return ""
    return (
        f"the burn time carries the fit (without it n is known to {sqrt(without):.2g} only), and a trickle of vapor "
        f"sets it: {last:.0f} kg/(m^2 s) at its end, where {window[0]:.0f} and more were compared"
    )


def variance_of_n(slopes: Array, covariance: Array) -> float:
    """Of n [-], from the ``slopes`` (n, 2) of observations by (ln r, n) and their ``covariance`` (n, n)."""
    information = slopes.T @ np.linalg.solve(covariance, slopes)
    if np.linalg.cond(information) > 1e12:
        return np.inf
    return float(np.linalg.inv(information)[1, 1])
