"""``hfa run --check``: whether a test keeps the team's own limits, as an exit status."""

from __future__ import annotations

import typer

from hfanalysis.cli.exit_status import tell
from hfanalysis.record.limits import FILE
from hfanalysis.report.limits import BROKEN, KEPT, judged
from hfanalysis.stages.base import Context
from hfanalysis.stages.material import load

EXIT_STATUS = 4
"""Of a test that breaks a rule."""

_WORDS = {KEPT: "keeps its limit", BROKEN: "breaks its limit"}


def check(context: Context) -> None:
    """Say what becomes of every rule of limits.toml; exit with EXIT_STATUS where one is broken."""
    found = judged(load(context))
    if not found:
        tell(f"{context.root / FILE}: there is no such file, or no rule in it that applies: nothing was checked")
    for one in found:
        tell(f"{one.name} {_WORDS.get(one.state, 'can neither keep nor break its limit')}: {one.words}")
    if any(one.state == BROKEN for one in found):
        raise typer.Exit(EXIT_STATUS)
