"""Whether what was found is large enough to matter: against what goes through its equation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.answer.verdict import Verdict
from hfanalysis.diagnose.naming.naming import Naming
from hfanalysis.engine.unsteady import Burn
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.products.diagnosis import Place

MATTERS = 1e-3
"""Part of what goes through an equation, or of a channel's largest reading, below which a source is too small to
matter. Source: a tenth of what transducers and cells of a stand are good for, 1 % of their range at best over a
firing; the tables of nitrous oxide and of combustion are known to no more (docs/properties.md)."""

OF_NITROGEN = 1e-4
"""The same of nitrogen's flow into the tank, beside that of the oxidizer out of it. Source: at 50 bar and 280 K a
kilogram of it (60 kg/m^3) takes the volume of thirteen of liquid, by which it holds up the tank's pressure."""


def part_of(row: Place, found: Burn, observed: Observed) -> float | None:
    """The largest size of a source over what goes through its equation [-]; None where that is not known."""
    whole = _whole(row, found, observed)
    if row.history is None or whole is None or not whole > 0.0:
        return None
    return float(np.abs(row.history.mean).max()) / whole


def _whole(row: Place, found: Burn, observed: Observed) -> float | None:
    """What goes through the equation of a place, in the unit of its source."""
    unit = row.source.unit
    if row.equation == "sensor":
        return next((float(np.abs(c.value).max()) for c in observed.channels if c.name == row.channel), None)
    if unit == "Pa":
        return float(found.output("tank_pressure").max())
    if unit == "N":
        return float(found.output("thrust").max())
    if unit == "kg/s":
        return _largest(found, "fuel_flow" if row.equation == "grain" else "oxidizer_flow")
    return _power(row.equation, found) if unit == "W" else None


def _largest(found: Burn, name: str) -> float:
    return float(np.abs(found.output(name)).max())


def _power(equation: str, found: Burn) -> float:
    """What leaves a tank as flow work, or flows through the nozzle as enthalpy [W]."""
    if equation == "tank_energy":
        engine = found.steps.engine
        density = float(engine.saturation.liquid_density(engine.temperature))
        return _largest(found, "oxidizer_flow") * _largest(found, "tank_pressure") / density
    gamma: Array = found.output("gamma")
    heat = gamma / np.maximum(gamma - 1.0, 1e-9) * found.output("nozzle_flow")
    return float((heat * found.output("chamber_temperature_by_mass")).max())


def least_of(row: Place) -> float:
    """The part [-] from which on a source at a place matters."""
    return OF_NITROGEN if row.equation == "tank_volume" and row.source.unit == "kg/s" else MATTERS


def too_small(rows: Sequence[Place], found: Burn, observed: Observed) -> dict[str, float]:
    """The sites of sources that are too small to matter, with the part [-] that each is."""
    parts = {row.site: (part_of(row, found, observed), least_of(row)) for row in rows if not row.beside}
    return {site: part for site, (part, least) in parts.items() if part is not None and part < least}


def without_the_small(verdict: Verdict, rows: Sequence[Place], found: Naming) -> tuple[Verdict, Mapping[str, float]]:
    """The verdict, which is none where all that is claimed is too small to matter; what is, with the part that it is.

    ``rows``: the places of what is claimed.
    """
    if verdict.label == "none":
        return verdict, {}
    small = too_small(rows, verdict.chosen.fit.burnt, found.bench.observed)
    if set(small) < {row.site for row in rows if not row.beside} or not small:
        return verdict, small
    return replace(verdict, label="none", chosen=found.base, partners={}, doubts=()), small
