"""What a reconstruction starts from, each with its error: one lane of numbers for each error that is moved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array


@dataclass(frozen=True)
class Inputs:
    """A burn in its window, (n,) at ``time`` [s after the opening].

    ``pressure`` before the nozzle [Pa], ``oxidizer`` flow [kg/s], ``throat`` area [m^2]; ``fuel`` burnt in the window
    [kg], None where nobody says; ``white``: standard deviation of each sample of the pressure, as share of it [-].

    ``moved``: two for each error, what these are at two standard deviations of it up and down; those that stay are not
    named.
    ``drift`` (n,): of the efficiency, relative [-].
    """

    time: Array
    pressure: Array
    oxidizer: Array
    throat: Array
    fuel: float | None
    white: Array
    drift: Array
    moved: Mapping[str, Mapping[str, Array | float]] = field(default_factory=dict)

    @property
    def step(self) -> float:
        """[s]."""
        return float(self.time[1] - self.time[0])

    @property
    def lanes(self) -> tuple[str, ...]:
        """The burn as it is, then each error."""
        return ("", *self.moved)

    def lane(self, name: str) -> tuple[Array, float | None]:
        """p A_t / (1 + drift) over the oxidizer flow (n,) [m/s], and the fuel [kg], with an error moved."""
        now = self.moved.get(name, {})
        pressure, oxidizer = now.get("pressure", self.pressure), now.get("oxidizer", self.oxidizer)
        throat, drift = now.get("throat", self.throat), now.get("drift", self.drift)
        fuel = now.get("fuel", self.fuel)
        right = np.asarray(pressure) * throat / ((1.0 + np.asarray(drift)) * oxidizer)
        return np.asarray(right), None if fuel is None else float(np.asarray(fuel))

    def along(self, what: str, lanes: Sequence[int] | NDArray[np.int64] | None = None) -> Array:
        """One of pressure, oxidizer, throat and drift in some of the lanes, or all, (n, lanes)."""
        names = self.lanes if lanes is None else [self.lanes[i] for i in lanes]
        usual = getattr(self, what)
        return np.column_stack([np.asarray(self.moved.get(name, {}).get(what, usual)) for name in names])
