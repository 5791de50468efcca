"""A firing as a notebook or a terminal shows it: what it is, what has been found; nothing is run for it."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from typing import TYPE_CHECKING

from hfanalysis.products.disk import read_json
from hfanalysis.stages import ORDER

if TYPE_CHECKING:
    from hfanalysis.interface.firing import Firing

KEY = ("C_i", "K_loss", "m", "regression_rate_reference", "oxidizer_mass", "t_feed", "t_v")
"""Of the calibration, what is shown first."""

Row = tuple[str, str, str, str]


def text(firing: Firing) -> str:
    """On a few lines."""
    rows = [f"  {name:<26} {value:>12} {unit:<8} {verdict}".rstrip() for name, value, unit, verdict in _rows(firing)]
    return "\n".join([_head(firing), f"  made: {_made(firing)}", *rows])


def html(firing: Firing) -> str:
    """The same as a table, without a style of its own."""
    rows = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in _rows(firing))
    table = f"<table><tr><th></th><th>value</th><th>unit</th><th>verdict</th></tr>{rows}</table>" if rows else ""
    return f"<p><b>{escape(_head(firing))}</b><br>made: {escape(_made(firing))}</p>{table}"


def _head(firing: Firing) -> str:
    test = firing.definition.test
    kind = test.kind.replace("_", " ")
    day = f", {test.date}" if test.date else ""
    source = "" if test.source == "measured" else f", {test.source.upper()}: generated, not measured"
    return f"Firing {firing.name}: {kind}{day}{source}"


def _made(firing: Firing) -> str:
    made = firing.made()
    missing = [name for name in ORDER if name not in made]
    return (", ".join(made) or "nothing yet") + (f" (not yet: {', '.join(missing)})" if missing else "")


def _rows(firing: Firing) -> Iterator[Row]:
    """The calibration's numbers where they are there, with deviations."""
    from hfanalysis.products.calibration import Calibration
    from hfanalysis.wording.numbers import in_words, shown

    path = firing.folder / Calibration.file
    if not path.is_file():
        return
    found = Calibration.from_json(read_json(path)).quantities
    for name in KEY:
        if name in found:
            said = shown(found[name], name=name)
            yield in_words(name), f"{said.value} ± {said.std}" if said.std else said.value, said.unit, said.verdict
