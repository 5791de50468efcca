"""Static margin along a flight: mean and two standard deviations over gusts, beside the limits (report, 3.2.4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.flight.pitch import ATTACK, HEIGHT, HIGH, LOW, MARGIN, PITCH_STEP, SPEED, Flights
from hfanalysis.products.flight import Mean, WindMargin

EVERY = 5
"""Steps between the times that are kept."""


@dataclass(frozen=True)
class Margin:
    """In one wind [m/s]: ``time`` [s] from rail departure until the rocket is as slow again as it was there; mean and
    standard deviation of the margin [calibers]; mean angle of attack [rad]; mean apogee [m] of the flights."""

    wind: float
    time: Array
    mean: Array
    std: Array
    attack: Array
    apogee: float

    @property
    def band(self) -> tuple[Array, Array]:
        """Two standard deviations on each side of the mean [calibers], (n,) each."""
        return self.mean - 2.0 * self.std, self.mean + 2.0 * self.std

    def product(self) -> WindMargin:
        """Numbers for flight.json: at departure, least and largest, and whether the band keeps within the limits."""
        low, high = self.band
        return WindMargin(
            wind=self.wind,
            departure=Mean(mean=float(self.mean[0]), std=float(self.std[0])),
            least=float(low.min()),
            largest=float(high.max()),
            apogee=self.apogee,
            result="passed" if low.min() >= LOW and high.max() <= HIGH else "failed",
        )


def margin(flights: Flights) -> Margin | None:
    """The margin [calibers] over the flights in one wind; None where a rail's end is not reached."""
    if (flights.departure < 0).any():
        return None
    start = int(flights.departure.max())
    after = flights.paths[:, start:, :]
    after = after[:, np.isfinite(after[:, :, MARGIN]).all(axis=0), :]
    if not after.shape[1]:
        return None
    speed = after[:, :, SPEED].mean(axis=0)
    fast = np.flatnonzero(speed >= speed[0])
    window = slice(start, start + int(fast[-1]) + 1, EVERY)
    seen = flights.paths[:, window, :]
    apogees = np.nanmax(flights.paths[:, :, HEIGHT], axis=1)
    return Margin(
        flights.wind,
        np.asarray(PITCH_STEP * np.arange(window.start, window.stop, EVERY), dtype=np.float64),
        seen[:, :, MARGIN].mean(axis=0),
        seen[:, :, MARGIN].std(axis=0, ddof=1) if len(seen) > 1 else np.zeros(seen.shape[1]),
        seen[:, :, ATTACK].mean(axis=0),
        float(apogees.mean()),
    )
