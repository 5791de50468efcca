"""Quality flags per sample. Nothing is repaired: a flag says why a reading is not to be trusted."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hfanalysis.testdata.log import Flag, Flags

Floats = NDArray[np.float64]


def flag_readings(readings: Floats, dimension: str, missing: Sequence[float]) -> Flags:
    """The flags of a channel's readings as logged (before unit, zero and tare)."""
    flags = np.zeros(len(readings), dtype=np.uint8)
    gone = ~np.isfinite(readings)
    for value in missing:
        gone |= readings == value
    flags[gone] |= np.uint8(Flag.DROPOUT)
    return flags
