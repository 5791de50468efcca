"""Warnings with a value, its limit, and where the limit comes from: of tests, of simulated burns, of designs."""

from __future__ import annotations

from typing import Annotated

from hfanalysis.products.model import Is, Part, Words
from hfanalysis.quantity import Quantity


class Beyond(Part):
    """A value that is beyond what the model or the usual practice stands for."""

    name: Annotated[str, Is("of the value")]
    value: Annotated[Quantity, Is("as it is")]
    limit: Annotated[float, Is("beyond which it is warned of", "of the value")]
    source: Annotated[str, Is("of the limit")]
    text: Annotated[Words, Is("the warning")]
