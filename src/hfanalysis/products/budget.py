"""An uncertainty budget: what a quantity's standard deviation is made of (ASME PTC 19.1, GUM)."""

from __future__ import annotations

from typing import Annotated

from hfanalysis.products.model import Is, Part


class Budget(Part):
    """What of a quantity's variance is whose; shares and ``non_linear`` add up to the whole of it."""

    systematic: Annotated[
        float, Is("standard deviation by what would be the same in a repeated test", "of the quantity")
    ]
    random: Annotated[float, Is("standard deviation by what would not", "of the quantity")]
    shares: Annotated[dict[str, float], Is("of the variance, by input; correlated inputs are one", "")]
    non_linear: Annotated[float, Is("of the variance, what no input explains by its slope", "")]


MADE_OF = Is("what the standard deviations are made of, by quantity")
