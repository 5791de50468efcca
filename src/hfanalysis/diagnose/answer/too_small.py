"""Whether what was found is large enough to matter: against what goes through its equation.

Two right models of an engine differ by as much as what is too small; a free curve finds what they differ by, and a name
may follow it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.answer.posterior import smallest_set
from hfanalysis.diagnose.answer.source_places import of_unknown
from hfanalysis.diagnose.answer.standing import against, withheld
from hfanalysis.diagnose.answer.verdict import Verdict
from hfanalysis.diagnose.naming.naming import Naming
from hfanalysis.engine.unsteady import Burn
from hfanalysis.inference.candidate import Candidate
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.unknowns import kind_of
from hfanalysis.products.diagnosis import Place, SourceHistory

MATTERS = 5e-3
"""Part of what goes through an equation, or of a channel's largest reading, below which a source is too small to
matter. Source: by as much do two tables of nitrous oxide differ at burn temperatures (docs/properties.md); transducers
and cells of a stand are good for 0.25 to 1 % of their range."""

LAWS_DIFFER: Mapping[str, float] = {
    "injector": 0.03,
    "feed": 0.2,
    "grain": 0.02,
    "chamber_energy": 0.02,
    "nozzle": 0.01,
    "tank_energy W": 0.03,
}
"""The same where right models of an equation, or of a source of one unit in it, differ by more.

Source: an orifice's coefficient goes with the Reynolds number and the pressure behind it by some per cent; a loss with
the power 1.8 or 2 of the flow, by a fifth of itself; regression with the oxidizer's flux or the total one, of which the
end of the fuel tells the mean; c* by 1 % with frozen or shifting mixtures, its square by 2 %; a nozzle's boundary layer
takes about 1 %; in a tank three times the flow work goes into evaporation, of whose heat tables know 1 %. Choice, with
the development set of docs/worlds.md, whose engines have such laws: what was named there where nothing is hidden
is smaller, but for what burns on at the end of the fuel.
"""


VOLUMES: Mapping[str, float] = {"n2_purge": 13.0, "nitrogen_inflow": 13.0, "tank_leak": 5.0}
"""Volume that a kilogram takes beside one of liquid, by which it holds up the tank's pressure or lets it fall, of what
flows into the tank or out of it beside the oxidizer [-]. Source: at 280 K and 50 bar nitrogen has 60 kg/m^3, vapor of
nitrous oxide 130 to 160, liquid 800; a flow of the volume of what an injector's law may be wrong by is too small."""


def with_parts(rows: Sequence[Place], found: Burn, base: Burn, observed: Observed) -> tuple[Place, ...]:
    """Sources of a run with how large each is at its largest, as a part of what goes through its equation; ``base``:
    the run without them."""
    return tuple(row.but(part=_part_of(row, found, base, observed)) for row in rows)


def _part_of(row: Place, found: Burn, base: Burn, observed: Observed) -> float | None:
    if row.history is None or kind_of(row) is not None:
        return None
    size = np.abs(row.history.mean)
    if row.equation == "grain":
        return _moved(row, row.history, found, base.burn_time if base.fuel_out else None)
    whole = 1.0 if row.source.unit == FACTOR else _whole(row, found, observed)
    return None if whole is None or not whole > 0.0 else float(size.max()) / whole


FACTOR = "1"
"""Unit of a source that is a factor of what goes through its equation."""


ABOUT_END = 1.0
"""Seconds about the end of the fuel in which nobody knows how a fire fades: that fuel burns at another time then is no
name. Source: 6 ms to 1 s, by what is left on the walls and how the chamber is stirred."""


def _moved(row: Place, history: SourceHistory, found: Burn, end: float | None) -> float:
    """Part [-] of the fuel that burns at another time, but for what does about the ``end`` of it [s]; where it does not
    end without the source, that is where the source is largest."""
    flow, size, time = found.output("fuel_flow"), np.abs(history.mean), np.array(history.time)
    if row.source.unit == FACTOR:
        size = size * np.interp(time, found.time, flow)
    end = float(time[size.argmax()]) if end is None else end
    size = np.where(np.abs(time - end) > ABOUT_END, size, 0.0)
    return float(np.trapezoid(size, time) / np.trapezoid(flow, found.time))


def _whole(row: Place, found: Burn, observed: Observed) -> float | None:
    """What goes through the equation of a place, in the unit of its source."""
    unit = row.source.unit
    if row.equation == "sensor":
        return next((float(np.abs(c.value).max()) for c in observed.channels if c.name == row.channel), None)
    if row.equation == "feed":
        return _loss(found)
    if unit == "Pa":
        return float(found.output("tank_pressure").max())
    if unit == "N":
        return float(found.output("thrust").max())
    if unit == "kg/s":
        return _largest(found, "oxidizer_flow")
    return _power(row.equation, found) if unit == "W" else None


def _loss(found: Burn) -> float:
    """What a line takes of the pressure while liquid flows, once it is full: the median over time [Pa]."""
    time = np.linspace(0.0, found.burn_time if found.liquid_out is None else found.liquid_out, INSTANTS)
    lost = found.output("tank_pressure") - found.output("run_pressure")
    return float(np.median(np.interp(time, found.time, lost)))


INSTANTS = 200
"""At which a run is asked that has most of its own where something begins."""


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
    if row.site in VOLUMES:
        return LAWS_DIFFER["injector"] / VOLUMES[row.site]
    return LAWS_DIFFER.get(f"{row.equation} {row.source.unit}", LAWS_DIFFER.get(row.equation, MATTERS))


def too_small(rows: Sequence[Place]) -> dict[str, float]:
    """The sites of sources that are too small to matter, with the part [-] that each is."""
    named = [row for row in rows if not row.beside and row.part is not None]
    return {row.site: row.part for row in named if row.part is not None and row.part < least_of(row)}


def without_small_sources(found: Naming) -> Naming:
    """The same without free curves that are too small to matter."""
    observed, base = found.bench.observed, found.base.fit.burnt

    def matters(source: Candidate) -> bool:
        row = of_unknown(source.history(observed), 0.0, observed.phases)
        return not too_small(with_parts([row], source.fit.burnt, base, observed))

    return replace(found, unknown=tuple(c for c in found.unknown if matters(c)))


def without_the_small(verdict: Verdict, rows: Sequence[Place], found: Naming) -> tuple[Verdict, Mapping[str, float]]:
    """The verdict without names that are too small to matter; none where all that is claimed is; and what is, with the
    part that it is. Where the rest alone is not the whole story, it is unknown beside that.

    ``rows``: the places of what is claimed.
    """
    if verdict.label == "none":
        return verdict, {}
    small = too_small(rows)
    if not small:
        return verdict, small
    if set(small) >= {row.site for row in rows if not row.beside}:
        return replace(verdict, label="none", chosen=found.base, partners={}, doubts=()), small
    rest = tuple(name for name in verdict.chosen.names if name not in small)
    alike = [c for c in (*found.singles, *found.sets) if set(c.names) == set(rest)]
    if verdict.chosen.unknown or not alike:
        return verdict, small
    chosen = max(alike, key=lambda c: c.log_evidence)
    partners = {name: p for name, p in verdict.partners.items() if name not in small}
    less = replace(verdict, chosen=chosen, partners=partners)
    if doubts := against(chosen, found.base, found.bench.observed):
        kept = withheld(verdict.posterior, {chosen.names[0]: chosen}, found.base, found.bench.observed)
        return replace(less, label="unknown", posterior=kept, set90=smallest_set(kept), doubts=doubts), small
    return less, small
