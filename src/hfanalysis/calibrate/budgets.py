"""What the deviations of a tank's constants are made of, from the repetitions that gave them."""

from __future__ import annotations

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.calibrate.uncertainty import RANDOM, SYSTEMATIC, Draws
from hfanalysis.inference.budget import by_draws
from hfanalysis.products.budget import Budget
from hfanalysis.products.calibration import TankConstants

NAMES = {"C_i": "C_i", "m": "m", "K_loss": "K_loss", "vapor_mass_at_t_v": "vapor_mass"}
"""The constants that have a budget, and their names among the draws."""

COURSE = "C_i's course over the burn"

ROWS = {
    "mass": "loaded oxidizer",
    "volume": "tank volume",
    "area": "injector holes",
    "p_tank": "p_tank: zero and span",
    "p_run": "p_run: zero and span",
    "p_chamber": "p_chamber: zero and span",
    "properties": "nitrous oxide's properties",
    "line": "line's content at t_v",
    "gamma": "vapor's isentropic exponent",
    "t_feed": "phase times",
    "t_v": "phase times",
    "t_end": "phase times",
    "p_v": "p_tank at t_v and t_purge: noise",
    "p_end": "p_tank at t_v and t_purge: noise",
}
"""How a drawn error is called; those of one row are correlated or of one kind."""


def budgets(draws: Draws, found: TankConstants, course: float = 0.0) -> dict[str, Budget]:
    """The budget of every constant that has a standard deviation, by name; ``course`` [-]: what of that of C_i is for
    its course over the burn."""
    drawn, random = _by_row(draws)
    out = {}
    for name, inner in NAMES.items():
        quantity = getattr(found, name)
        beside = {COURSE: course} if name == "C_i" else {}
        made = by_draws(draws.values[inner], drawn, random, quantity.std, beside) if quantity.std else None
        if made is not None:
            out[name] = made
    return out


def _by_row(draws: Draws) -> tuple[dict[str, Array], set[str]]:
    """The drawn errors by row, (samples, errors) each, and which of them are random."""
    rows: dict[str, list[Array]] = {}
    random = set()
    for name, drawn in draws.inputs.items():
        kind = next((k for k in (SYSTEMATIC, RANDOM) if name.startswith(k)), None)
        if kind is None:
            continue
        own = name.removeprefix(kind)
        row = ROWS.get(own, f"{own} as stated" if own in NAMES else own)
        rows.setdefault(row, []).append(drawn)
        random |= {row} if kind == RANDOM else set()
    return {row: np.column_stack(columns) for row, columns in rows.items()}, random
