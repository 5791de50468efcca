"""hfa predict and hfa score: what a planned test will measure, and how good that was."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from hfanalysis.cli.exit_status import put, tell
from hfanalysis.cli.paper import new_table, paper
from hfanalysis.cli.watch import watch
from hfanalysis.interface import predicting
from hfanalysis.products.disk import read_json, to_json
from hfanalysis.products.prediction import Foretold, Prediction, Score
from hfanalysis.quantity import Quantity
from hfanalysis.wording.numbers import in_words, shown

if TYPE_CHECKING:
    from collections.abc import Sequence


def predict(
    plan: Path, tests: Sequence[str], root: Path, temperature: str | None, draws: int, as_json: bool, quiet: bool
) -> None:
    """Freeze a prediction, show its bands and print its hash."""
    with watch(plan.stem, quiet) as progress:
        path, digest = predicting.predict(plan, tests, root, temperature=temperature, draws=draws, progress=progress)
    found = Prediction.from_json(read_json(path))
    if as_json:
        put(path.read_text(encoding="utf-8"))
    elif not quiet:
        _show(found)
    for text in found.notes:
        tell(f"note: {text}")
    tell(f"{path}: written, never to be written over; SHA-256 {digest}")
    if path.with_suffix(".svg").is_file():
        tell(f"{path.with_suffix('.svg')}: the same over the temperature of the tank")
    tell(f"next, once it has been fired: hfa score {path.stem}")


def score(name: str, test: str | None, root: Path, as_json: bool, quiet: bool) -> None:
    """Lay a prediction over its test and show which bands hold."""
    with watch(name, quiet) as progress:
        found = predicting.score(name, root, test, progress=progress)
    if as_json:
        put(to_json(found))
    elif not quiet:
        _show_score(found)


def _show(found: Prediction) -> None:
    table = new_table("", "median", "90 % band", "unit", title=f"{found.name} from {', '.join(found.tests)}")
    for name, foretold in found.predicted.items():
        table.add_row(in_words(name), *_cells(name, foretold))
    paper().print(table)


def _cells(name: str, foretold: Foretold) -> tuple[str, ...]:
    """Median and band as people read them, in one unit; the reason where there is none."""
    if foretold.value is None or foretold.low is None or foretold.high is None:
        return "–", "", foretold.reason or ""
    ends = (foretold.low, foretold.high)
    # as many digits as the band's width is worth, as for any deviation
    text = shown(Quantity(foretold.value, foretold.unit, 0.25 * (ends[1] - ends[0]), ends), name=name)
    return text.value, text.interval, text.unit


def _show_score(found: Score) -> None:
    rivals = list(next(iter(found.scored.values())).rivals)
    heads = ("", "measured", "median", "90 % band", "unit", "holds", "error", *map(in_words, rivals))
    table = new_table(*heads, title=f"{found.name} over {found.test}")
    for name, one in found.scored.items():
        measured = shown(one.measured, name=name)
        held = "–" if one.holds is None else "yes" if one.holds else "no"
        errors = (_percent(error) for error in (one.error, *one.rivals.values()))
        table.add_row(in_words(name), measured.value, *_cells(name, one.foretold), held, *errors)
    console = paper()
    console.print(table)
    console.print(f"{found.held} of {found.of} bands hold; mean size of the errors: {_means(found)}")


def _means(found: Score) -> str:
    return ", ".join(f"{in_words(name)} {_percent(error, signed=False)}" for name, error in found.mean_error.items())


def _percent(error: float | None, signed: bool = True) -> str:
    return "–" if error is None else f"{100.0 * error:{'+' if signed else ''}.1f} %"
