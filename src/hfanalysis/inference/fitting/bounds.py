"""Whether a fit ends where its constants may go no further."""

from __future__ import annotations

from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.hypothesis import DEPARTURE

AT = 1e-3
"""Standard deviations of its prior within which a constant is on its bound."""

NAMES = {"polytropic_exponent": "m"}
"""Constants by the names that products have."""


def on_bounds(found: Fit) -> tuple[str, ...]:
    """The base model's constants of a fit that are on a bound of their prior, in words.

    Those of effects may be: a share is 0 or 1 for a good reason.
    """
    free = found.hypothesis.free
    return tuple(
        f"{NAMES.get(f.name, f.name)} is on its bound ({f.value(x):.3g})"
        for f, x in zip(free, found.x.tolist(), strict=False)
        if "." not in f.name
        and not f.name.startswith(DEPARTURE)
        and f.most > f.least
        and not f.least + AT < x < f.most - AT
    )
