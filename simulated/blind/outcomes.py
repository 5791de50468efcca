"""What one case contributes to each figure: true, false, a number, or None where the figure does not ask it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from .judged import NAMES, Case, Groups, number

SEEN = 6.0
"""d' from which an effect is to be named."""
APART, WELL_APART = 4.0, 6.0
"""d' against every rival from which the exact name is asked."""
SURE = 0.9
OUTSIDE_SEEN, PAIR_SEEN = 8.0, 8.0
Z90 = 1.6448536269514722


def seen(c: Case) -> bool:
    """One effect of the library in plain view."""
    return c.kind == "single" and c.d_prime >= SEEN


def exact_name(c: Case, apart: float = 0.0) -> bool | None:
    """The right name, where every rival is at least so far away."""
    return c.stated == c.truth if seen(c) and (apart == 0.0 or c.nearest >= apart) else None


def in_set(c: Case, *kinds: str) -> bool | None:
    """The truth in the 90 % set."""
    return c.truth in set(c.product.get("set90", ())) if c.kind in kinds else None


def sure_and_wrong(c: Case, groups: Groups) -> bool | None:
    """More than 90 % for an effect that is not there and no twin of what is, or for none with one in plain view."""
    if c.kind == "pair":
        return None
    if c.probability <= SURE:
        return False
    if c.kind == "outside" and c.stated in NAMES:
        # what an outsider cannot be told from is no error
        return float(c.answer["against"].get(c.stated, c.d_prime)) >= APART
    if c.stated in NAMES:
        return c.stated not in groups.get(c.truth, {c.truth})
    return c.stated != c.truth and c.d_prime >= SEEN


def pair_both(c: Case) -> bool | None:
    """Both of two effects named, where both can be seen beside each other."""
    if c.kind != "pair" or min(c.answer["given_others"].values()) < PAIR_SEEN:
        return None
    return c.names <= c.found


def strange(c: Case) -> bool:
    """An effect outside the library that no effect of the library can stand in for."""
    return c.kind == "outside" and (c.answer["after_best_of_library"] or 0.0) >= OUTSIDE_SEEN


def right_equation(c: Case, place: Mapping[str, Any]) -> bool:
    """A place is in an equation of something that is hidden."""
    return any(place.get("equation") in e["equations_accepted"] for e in c.answer["effects"])


def right_phase(c: Case, place: Mapping[str, Any]) -> bool:
    """A place is in a phase in which the source acts."""
    return any(place.get("phase") in e["phases"] for e in c.answer["effects"])


def claimed_place(c: Case) -> Mapping[str, Any]:
    """The first of the places at which a source is claimed; empty where none is."""
    return c.places[0] if c.places else {}


def placed(c: Case) -> bool:
    """One effect, of the library or not, in plain view."""
    return c.kind in ("single", "outside") and c.d_prime >= SEEN


def onset_covered(c: Case) -> bool | None:
    """The onset inside the stated 95 % band; None where no band is stated or the source does not begin with a step."""
    effect = c.answer["effects"][0]
    start = c.places[0].get("t_start") if c.places else None
    if effect["onset_kind"] != "step" or effect["onset"] is None or not isinstance(start, dict):
        return None
    band = start.get("ci95")
    if band is None and start.get("std") is not None:
        band = [number(start) - 1.96 * start["std"], number(start) + 1.96 * start["std"]]
    return None if band is None else bool(band[0] <= effect["onset"] <= band[1])


def _true_source(effect: dict[str, Any], time: Any) -> Any:
    source = effect["source"]
    there = source["start"] + source["step"] * np.arange(len(source["values"]))
    return np.interp(time, there, source["values"])


def size_covered(c: Case) -> bool | None:
    """The mean true source over the stated stretch inside the 90 % interval; None where equation or unit differ."""
    if not c.places:
        return None
    row, effect = c.places[0], c.answer["effects"][0]
    found = row.get("source")
    if row.get("equation") != effect["equation"] or not isinstance(found, dict):
        return None
    if found.get("unit") != effect["source"]["unit"] or found.get("std") is None or found.get("value") is None:
        return None
    lo, hi = number(row.get("t_start")), number(row.get("t_end"))
    if not hi > lo:
        return None
    true = float(np.mean(_true_source(effect, np.linspace(lo, hi, 200))))
    return bool(abs(found["value"] - true) <= Z90 * found["std"])


def band_shares(c: Case) -> list[bool]:
    """Sample by sample, whether the true source lies in the 90 % band (``history`` of the first place)."""
    row, effect = (c.places[0] if c.places else {}), c.answer["effects"][0]
    h = row.get("history")
    if not h or row.get("equation") != effect["equation"] or h.get("unit") != effect["source"]["unit"]:
        return []
    true = _true_source(effect, h["time"])
    return [bool(lo <= x <= hi) for lo, x, hi in zip(h["low90"], true, h["high90"], strict=True)]


def closed(c: Case, arm: str) -> float | None:
    """Share of the gap that closed where an effect in plain view was named."""
    if c.kind not in ("single", "pair") or c.d_prime < SEEN or not c.found:
        return None
    value = number(((c.product.get("gap") or {}).get("closed_fraction") or {}).get(arm))
    return value if np.isfinite(value) else None


def over_placebo(c: Case) -> float | None:
    """Share of the gap that closed beyond what the best wrong effect closes."""
    same, placebo = closed(c, "same"), closed(c, "placebo")
    return None if same is None or placebo is None else same - placebo


def runtime(c: Case) -> float | None:
    """Seconds that the diagnosis took, where that was measured."""
    seconds = number(c.product.get("runtime_s"))
    return seconds if np.isfinite(seconds) else None


LEAST = 1e-4
"""A probability below this one counts as this one, lest a single case outweigh all others."""


def log_score(c: Case) -> float | None:
    """Logarithm of the probability of the truth; pairs have no label."""
    if c.kind == "pair" or not c.posterior:
        return None
    return float(np.log(max(c.posterior.get(c.truth, 0.0), LEAST)))


Judge = Callable[[Case, Groups], Any]

NAMING: dict[str, Judge] = {
    "exact_name": lambda c, g: exact_name(c, APART),
    "exact_name_well_apart": lambda c, g: exact_name(c, WELL_APART),
    "exact_name_no_twin_allowance": lambda c, g: exact_name(c),
    "twin_group": lambda c, g: c.stated in g[c.truth] if seen(c) else None,
    "set90_coverage": lambda c, g: in_set(c, "single", "none"),
    "set90_coverage_outside": lambda c, g: in_set(c, "outside"),
    "set90_size": lambda c, g: len(c.product.get("set90", ())) if seen(c) and not c.failed else None,
    "sure_and_wrong": sure_and_wrong,
    "false_alarm": lambda c, g: c.claims if c.kind == "none" else None,
    "pair_both": lambda c, g: pair_both(c),
    "outside_unknown": lambda c, g: c.stated == "unknown" if strange(c) else None,
    "outside_unknown_and_equation": lambda c, g: (
        c.stated == "unknown" and right_equation(c, claimed_place(c)) if strange(c) else None
    ),
}

PLACES: dict[str, Judge] = {
    "equation_first": lambda c, g: right_equation(c, c.first_place) if placed(c) else None,
    "phase": lambda c, g: right_phase(c, c.first_place) if placed(c) else None,
    "equation_claimed": lambda c, g: right_equation(c, claimed_place(c)) if placed(c) else None,
    "phase_claimed": lambda c, g: right_phase(c, claimed_place(c)) if placed(c) else None,
    "onset_in_95_band": lambda c, g: onset_covered(c) if placed(c) else None,
    "no_source_on_none": lambda c, g: not c.places and not c.failed if c.kind == "none" else None,
    "size_in_90_interval": lambda c, g: size_covered(c) if placed(c) else None,
}

ARMS = ("same", "held_out", "other_test", "placebo")
GAPS: dict[str, Judge] = {
    **{f"gap_closed_{arm}": (lambda c, g, arm=arm: closed(c, arm)) for arm in ARMS},
    "gap_closed_over_placebo": lambda c, g: over_placebo(c),
}

SHARES = {name: judge for name, judge in {**NAMING, **PLACES}.items() if name != "set90_size"}
"""Figures that count cases."""
NUMBERS: dict[str, Judge] = {
    "set90_size": NAMING["set90_size"],
    **GAPS,
    "log_score": lambda c, g: log_score(c),
    "runtime": lambda c, g: runtime(c),
}
"""Figures that are numbers."""
