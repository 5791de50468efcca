"""What an unknown is: something that the model lacks and that has no name (:mod:`hfanalysis.inference.unknowns`).

It is seen in the samples without any model, or in what the slopes of a fit leave open; from there on all are alike: it
is added to a hypothesis and fitted with the whole model, has a history over time with a band, and words.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.products import diagnosis
from hfanalysis.quantity import Quantity

if TYPE_CHECKING:
    from hfanalysis.inference.fitting.fit import Fit
    from hfanalysis.inference.fitting.hypothesis import Hypothesis
    from hfanalysis.inference.linear import Linearized
    from hfanalysis.inference.observations.observed import Observed
    from hfanalysis.inference.places import SourcePlace
    from hfanalysis.products.segments import Segments
    from hfanalysis.record.signals import Signal


POINTS = 200
"""Instants at which a history is given."""

SHAPE = 0.3
"""By how much, relative to itself, what an unknown of a given shape does may be wrong: each has one of its own."""

PREFIX = "probe_"
"""How the names of effects begin that model an unknown."""


def nameless_effect(name: str, equation: str, meaning: str, parameters: tuple[Parameter, ...], **acts: Any) -> Effect:
    """The effect that an unknown is in a hypothesis; what ``acts`` are the fields of an effect that act."""
    return Effect(PREFIX + name, equation, meaning, "free form", parameters, (), **acts)


def has_name(effect: Effect) -> bool:
    """Whether an effect of a hypothesis is one of the library, and models no unknown."""
    return not effect.name.startswith(PREFIX)


class Samples(NamedTuple):
    """Signals by channel, their times [s] after the opening, the phases of the test, how long from the opening on
    nothing changes [s], and until when a flame is ``shown`` [s after the opening], where it is not known to burn on."""

    signals: Mapping[str, Signal]
    segments: Segments
    steady: float
    shown: float | None = None


@dataclass(frozen=True)
class History:
    """An unknown over time as a fit has it: ``mean`` and ``std`` (n,) at ``time`` (n,) [s] in the unit of its place.

    ``blur``: the standard deviation of the instants at which it begins and ends [s]. ``sizes``: what else it is known
    by. ``stretch``: from when to when it acts [s], where its size over time does not tell. ``whole``: what it is a
    factor of, or what that goes with, by the unit of its equation.
    """

    place: SourcePlace
    time: Array
    mean: Array
    std: Array
    blur: float
    sizes: Mapping[str, Quantity] = field(default_factory=dict)
    stretch: tuple[float, float] | None = None
    whole: Array | None = None

    @property
    def of_equation(self) -> Array:
        """Its mean (n,) [unit of its equation]: a tenth of a large flow is more than a tenth of a small one."""
        return self.mean if self.whole is None else self.mean / (1.0 + self.mean) * self.whole


def spread_of(slopes: Array, covariance: Array) -> Array:
    """Standard deviations (n,) [the slopes' unit] of what has these slopes (n, m) with m numbers of a covariance (m,
    m).

    >>> spread_of(np.array([[3.0, 4.0]]), np.eye(2)).tolist()
    [5.0]
    """
    return np.asarray(np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", slopes, covariance, slopes), 0.0)))


class Unknown(ABC):
    """An unknown as it was seen: its place, and the log evidence for it of what showed it.

    ``also_by``: the effect that shows in the samples as it does. ``price``: log of the odds against it.
    """

    place: SourcePlace
    log_evidence: float
    also_by: ClassVar[str] = ""
    price: ClassVar[float] = 0.0

    @classmethod
    def in_samples(cls, samples: Samples) -> Self | None:
        """What the samples show of it without any model; None where it is not there, or does not show."""
        return None

    @classmethod
    def in_slopes(cls, about: Linearized) -> Sequence[LinearUnknown]:
        """What the slopes of a fit show of it, by place."""
        return ()

    @property
    def hides(self) -> float:
        """Time [s] before the end of the liquid in which no blocks are compared, for no name could be judged by
        them."""
        return 0.0

    @property
    def equations(self) -> set[str]:
        """The equations in which it may be."""
        return {self.place.equation}

    @abstractmethod
    def added_to(self, fitted: Fit) -> tuple[Hypothesis, Array]:
        """The hypothesis of a fit with it, and the x (n,) of its own parameters, in prior standard deviations, where it
        was seen."""

    @abstractmethod
    def history(self, fitted: Fit, observed: Observed) -> History:
        """It over time [s] as a fit that has it says, in the unit of its place."""


class Described(Unknown):
    """One that a number beside its size tells: ``known_by`` names that quantity among its history's sizes."""

    known_by: ClassVar[str]

    @staticmethod
    @abstractmethod
    def words(row: diagnosis.Place, known: Quantity, where: str, unit: str) -> str:
        """A sentence of a row of the localisation that has the quantity it is ``known_by``, and is ``where``.

        ``unit``: in which people have the row's source.
        """


class LinearUnknown(Unknown):
    """One that the slopes of a fit show; ``nuisances``: where the fit's own parameters then are (x)."""

    nuisances: Array

    @abstractmethod
    def added_to(self, fitted: Fit, share: float = 1.0) -> tuple[Hypothesis, Array]:
        """As :meth:`Unknown.added_to`, at a ``share`` [-] of its size."""
