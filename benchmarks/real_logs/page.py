"""docs/real-logs.md, from the outcomes."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from typing import Any

from benchmarks.real_logs.trial import Outcome

TIMES = ("t_feed", "t_v", "t_purge", "t_fuel_out", "t_end")
SHOWN = ("C_i", "m", "K_loss", "a", "n", "oxidizer_mass", "total_impulse", "burn_time", "peak_thrust", "apogee")
"""Quantities that are asked for."""
WORDS = {"flow_area": "C_i N A", "oxidizer_mass": "oxidizer at the opening"}
_HEAD = """\
# Real logs of other teams

Logs that teams have published, none of which was made for this project. Each went through `hfa new`, the facts that its
authors state were put into the drafted `test.toml`, and then through `hfa run`; no line of code was edited. The logs
themselves are not part of the repository. `make real-logs LOGS=FOLDER` writes this page anew where they are.

"""
_SECOND = """
## Phases, flow and impulse beside the authors' and hand values

Times in seconds from the instant at which the run line has risen by 60 psi, where a hand analysis counts from there,
else from the opening. An interval of ours is 95 %, one by hand is judged. *agrees*: the two intervals meet;
*says little*: ours is wider than the value itself.
C_i N A is the product of the injector's coefficient and the area of all its holes: the area itself is not stated for
most firings of the stand MRT. t_feed is here when the line's pressure has reached 98 % of its maximum, by hand when the
feed has settled.

| log | quantity | here | by hand | |
|---|---|---|---|---|
"""


def page(outcomes: Sequence[Outcome]) -> str:
    """The whole page."""
    rows = "\n".join(_row(outcome) for outcome in outcomes)
    table = "| log | format | columns drafted | what came of it | what was refused, and why |\n|---|---|---|---|---|\n"
    compared = "\n".join(row for outcome in outcomes for row in compared_rows(outcome))
    return f"{_HEAD}{table}{rows}\n{_SECOND}{compared}\n"


def _row(outcome: Outcome) -> str:
    facts = outcome.facts
    name = f"**{facts.name}**<br>{facts.about}"
    drafted = re.sub(r"^of (\d+) columns (\d+) taken for channels, (\d+) with.*?, (\d+) not.*",
                     r"\1: \2 taken, \3 guessed, \4 not recognized", outcome.drafted)  # fmt: skip
    return f"| {name} | {facts.format} | {drafted} | {'; '.join(_obtained(outcome))} | {'; '.join(_refused(outcome))} |"


def _obtained(outcome: Outcome) -> Iterator[str]:
    if outcome.status not in (0, 3):
        yield f"exit {outcome.status}"
    segments = outcome.products.get("segments", {})
    if segments:
        yield segments.get("kind", "").replace("_", " ")
        found = [name for name in TIMES if _known(outcome.quantity(name))]
        yield f"phases {', '.join(found)}" if found else "no phase but the opening"
    for name in SHOWN:
        quantity = outcome.quantity(name)
        if quantity is not None and _known(quantity):
            verdict = quantity.get("verdict", "")
            yield f"{name} {number(quantity)}{'' if verdict in ('', 'identified') else f' ({verdict})'}"


def _refused(outcome: Outcome) -> Iterator[str]:
    """Reasons, each once, with what it is the reason of."""
    reasons: dict[str, list[str]] = {}
    for name in (*TIMES, *SHOWN):
        quantity = outcome.quantity(name)
        if quantity is not None and not _known(quantity):
            # what was found of its channels follows once, at the end
            reason = str(quantity.get("reason") or quantity.get("why") or "").partition("; ")[0]
            reasons.setdefault(reason, []).append(name)
    yield from (f"{', '.join(names)}: {_cell(reason)}" for reason, names in reasons.items())
    yield from (_cell(line.removeprefix("hfa: ")) for line in outcome.said if "warning" not in line)
    yield from _findings(outcome)


def _findings(outcome: Outcome) -> Iterator[str]:
    health = outcome.products.get("health", {})
    for name, channel in health.get("channels", {}).items():
        if channel.get("verdict") not in (None, "healthy"):
            kinds = dict.fromkeys(finding.get("kind", "") for finding in channel.get("findings", ()))
            yield f"{name} {channel['verdict']} ({', '.join(kinds)})"


def compared_rows(outcome: Outcome) -> Iterator[str]:
    """A row for each quantity that somebody else has a value of."""
    for name, (value, half, unit) in outcome.facts.hand.items():
        quantity = outcome.quantity(name)
        shift = outcome.origin if name in TIMES else 0.0
        here, word = "not there", "refused"
        if quantity is not None and _known(quantity):
            here, word = number(quantity, shift), _agreement(quantity, shift, value, half)
            verdict = quantity.get("verdict", "identified")
            here += "" if verdict == "identified" else f" ({verdict})"
        elif quantity is not None:
            here = _cell(quantity.get("reason") or quantity.get("why") or "not there")
        hand = f"{value:.4g} +/- {half:.2g} {unit}"
        yield f"| {outcome.facts.name} | {WORDS.get(name, name)} | {here} | {hand} | {word} |"


def _agreement(quantity: dict[str, Any], shift: float, value: float, half: float) -> str:
    low, high = quantity.get("ci95") or (quantity["value"], quantity["value"])
    if math.isnan(shift):
        return "cannot be compared"
    if not (low - shift <= value + half and high - shift >= value - half):
        return "**differs**"
    return "agrees" if 0.5 * (high - low) < abs(value) else "agrees, but says little"


def _known(quantity: dict[str, Any] | None) -> bool:
    return quantity is not None and quantity.get("value") is not None


def number(quantity: dict[str, Any], shift: float = 0.0) -> str:
    """Value and interval."""
    unit = f" {quantity['unit']}" if quantity.get("unit") else ""
    value, interval = quantity["value"] - shift, quantity.get("ci95")
    if interval is None:
        return f"{value:.4g}{unit}"
    return f"{value:.4g} [{interval[0] - shift:.4g}, {interval[1] - shift:.4g}]{unit}"


def _cell(text: str) -> str:
    """A text that fits into a cell of the table."""
    return " ".join(re.sub(r"/\S*/", "", text).replace("|", "\\|").split())
