"""What validation.json says of the reconstruction."""

from __future__ import annotations

from typing import Annotated

from hfanalysis.products.model import Is, Part, Words
from hfanalysis.quantity import Quantity

AXIS = "time_reconstructed"
"""The axis of the group ``reconstructed`` in performance.h5: not "time", which is that of the histories above it."""


class Reconstruction(Part):
    """What the fuel did in a window of the burn, by the measurement alone; or why that cannot be had."""

    variant: Annotated[
        str | None, Is("a: assumed c* efficiency; b: one, by the fuel burnt; d: with the throat's course by thrust")
    ]
    assumption: Annotated[Words | None, Is("what it rests on")] = None
    reason: Annotated[Words | None, Is("why there is none")] = None
    window: Annotated[tuple[float, float] | None, Is("that it covers, after the opening", "s")] = None
    told: Annotated[float | None, Is("share of the window in which O/F does not hang on the last per cent", "")] = None
    of_ratio_mean: Annotated[Quantity | None, Is("oxidizer over fuel through the window", "")] = None
    c_star_efficiency: Annotated[Quantity | None, Is("of shifting equilibrium", "")] = None
    throat_radius_change: Annotated[Quantity | None, Is("over the window", "m")] = None
    a: Annotated[Quantity | None, Is("of r = a G^n along the path", "m/s (kg/m^2/s)^-n")] = None
    n: Annotated[Quantity | None, Is("of r = a G^n along the path", "")] = None
    nozzle_efficiency: Annotated[Quantity | None, Is("thrust over that of the ideal nozzle", "")] = None
    other: Annotated[Words | None, Is("another course of O/F that fits as well")] = None
