"""What the reconstruction says beside an effect of chamber, grain or nozzle that the diagnosis names.

Both rest on the same measurement: agreement raises no probability, and contradiction says that one of the assumptions
does not hold.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.products.diagnosis import Diagnosis, NamedEffect
from hfanalysis.products.reconstruction import AXIS, Reconstruction
from hfanalysis.sentences import text
from hfanalysis.wording.numbers import tidy

FROZEN = 0.02
"""c* [-] by which the model's gas, which is frozen in the nozzle, is below that in equilibrium, at most. Source: CEA
for nitrous oxide and paraffin at 10 to 40 bar: 0.5 to 2 %."""

MOST = 0.5
"""Part of the window in which a rate has to lie in the band to agree. Source: by choice: the band holds 95 % of what is
so at each moment, and neighbors hang together."""

SAME_DATA = "; it is the same data, so that no probability follows"

Histories = Mapping[str, Array]
"""Of the group ``reconstructed``, and ``p_chamber`` [Pa] at the same times: (n,) each."""


def sentences(found: Reconstruction, histories: Histories, diagnosis: Diagnosis) -> Iterator[str]:
    """One for each named effect that the reconstruction can be laid beside."""
    for effect in diagnosis.effects:
        said = _BESIDE[effect.name](effect, found, histories, diagnosis) if effect.name in _BESIDE else None
        if said is not None:
            yield said + SAME_DATA + "."


def _efficiency(effect: NamedEffect, found: Reconstruction, *_: object) -> str | None:
    own, deficit = found.c_star_efficiency, effect.parameters["deficit"]
    if own is None or own.interval is None or deficit.value is None:
        return None
    low, high = deficit.interval or (deficit.value, deficit.value)
    agree = own.interval[0] <= 1.0 - low and own.interval[1] >= 1.0 - high - FROZEN
    return text(
        "{name} has a c* efficiency of {named}; the reconstruction finds {own} and {verb} it",
        name=effect.name, named=_range(1.0 - high, 1.0 - low), own=_range(*own.interval), verb=_verb(agree),
    )  # fmt: skip


def _throat(effect: NamedEffect, found: Reconstruction, histories: Histories, *_: object) -> str | None:
    rate, heating, exponent = (effect.parameters.get(name) for name in ("rate", "heating", "exponent"))
    change = found.throat_radius_change
    if change is None or change.interval is None or rate is None or heating is None or exponent is None:
        return None
    time = histories[AXIS]
    heated = time**2 / (time**2 + (heating.value or 0.0) ** 2)
    pressed = (histories["p_chamber"] / 20e5) ** (exponent.value or 0.0)
    grown = [r * float(np.trapezoid(heated * pressed, time)) for r in rate.interval or (rate.value or 0.0,) * 2]
    agree = change.interval[0] <= max(grown) and min(grown) <= change.interval[1]
    return text(
        "{name} widens the throat's radius by {named} mm over the window; the reconstruction has {own} and {verb} it",
        name=effect.name, named=_range(*(1e3 * x for x in grown)), own=_range(*(1e3 * x for x in change.interval)),
        verb=_verb(agree),
    )  # fmt: skip


def _regression(
    effect: NamedEffect, found: Reconstruction, histories: Histories, diagnosis: Diagnosis
) -> str | None:  # fmt: skip
    constants = diagnosis.constants.better if diagnosis.constants is not None else {}
    a, n = (constants[name].value if name in constants else None for name in ("a", "n"))
    k, bend, reference = (effect.parameters.get(name) for name in ("exponent", "bend", "reference"))
    if a is None or n is None or k is None or bend is None or reference is None:
        return None
    above = np.log(histories["p_chamber"] / (reference.value or 1.0))
    bent = (bend.value or 0.0) * above
    share = np.where(np.abs(bent) > 1e-5, np.expm1(bent) / np.where(bent == 0.0, 1.0, bent), 1.0)
    rate = a * histories["oxidizer_flux"] ** n * np.exp((k.value or 0.0) * above * share)
    low, high = histories["regression_rate_low95"], histories["regression_rate_high95"]
    inside = float(np.mean((rate >= low) & (rate <= high)))
    return text(
        "the regression of {name} lies in {share} % of the window in the reconstruction's band, which {verb} it",
        name=effect.name, share=tidy(100.0 * inside, 2), verb=_verb(inside > MOST),
    )  # fmt: skip


def _range(low: float, high: float) -> str:
    return f"{tidy(low, 3)} to {tidy(high, 3)}"


def _verb(agree: bool) -> str:
    return "agrees with" if agree else "contradicts"


_Beside = Callable[[NamedEffect, Reconstruction, Histories, Diagnosis], str | None]
_BESIDE: Mapping[str, _Beside] = {
    "combustion_efficiency": _efficiency,
    "nozzle_throat_erosion": _throat,
    "grain_pressure_regression": _regression,
}
"""By effect."""
