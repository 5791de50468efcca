"""How well the constants of an engine are known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.weak_form.linear import LinearHistory
from hfanalysis.engine.unsteady import Engine

if TYPE_CHECKING:
    from hfanalysis.inference.fitting.fit import Fit


KNOWN = (
    "volume", "area", "loss_factor", "oxidizer_mass", "temperature", "polytropic_exponent", "a", "n", "throat_area",
)  # fmt: skip
"""Constants whose uncertainty is carried along [SI]."""


@dataclass(frozen=True)
class Spread:
    """``covariance`` (names, names) of the constants ``names`` (of KNOWN) [SI]; others count as exact. Raises
    ValueError for a name that is not in KNOWN."""

    names: tuple[str, ...]
    covariance: Array

    def __post_init__(self) -> None:
        if wrong := set(self.names) - set(KNOWN):
            raise ValueError(f"no uncertainty of {sorted(wrong)} is carried along; known: {', '.join(KNOWN)}")

    @classmethod
    def none(cls) -> Spread:
        """All constants exact."""
        return cls((), np.zeros((0, 0)))

    @classmethod
    def of(cls, deviations: Mapping[str, float]) -> Spread:
        """Independent constants with standard deviations [SI]."""
        return cls(tuple(deviations), np.diag([s**2 for s in deviations.values()]))

    @classmethod
    def of_fit(cls, fitted: Fit) -> Spread:
        """That of a fit's constants [SI]; parameters of effects and of sources are left out."""
        names = fitted.hypothesis.names
        kept = [i for i, name in enumerate(names) if name in KNOWN]
        slopes = fitted.hypothesis.jacobian(fitted.x)[kept]
        return cls(tuple(names[i] for i in kept), slopes @ fitted.covariance @ slopes.T)

    def matrix(self) -> Array:
        """Covariance (KNOWN, KNOWN) [SI] of all of KNOWN."""
        out = np.zeros((len(KNOWN), len(KNOWN)))
        where = [KNOWN.index(name) for name in self.names]
        out[np.ix_(where, where)] = self.covariance
        return out

    def constants(self, engine: Engine, slopes: Array) -> dict[str, LinearHistory]:
        """The engine's constants [SI] by name, each a single value; ``slopes`` (KNOWN, k) [SI] with k independent N(0,
        1) numbers."""
        rows = slopes if slopes.size else np.zeros((len(KNOWN), slopes.shape[1]))
        values = _values(engine)
        return {name: LinearHistory(np.array([values[name]]), rows[i : i + 1]) for i, name in enumerate(KNOWN)}


def _values(engine: Engine) -> dict[str, float]:
    """KNOWN of an engine; NaN for an exponent that it does not state."""
    exponent = np.nan if engine.polytropic_exponent is None else engine.polytropic_exponent
    of_feed: Sequence[str] = ("volume", "area", "loss_factor")
    found = {name: float(getattr(engine.feed, name)) for name in of_feed}
    own = {name: float(getattr(engine, name)) for name in KNOWN if name not in (*of_feed, "polytropic_exponent")}
    return {**found, **own, "polytropic_exponent": exponent}
