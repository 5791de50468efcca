"""hfa archive, hfa open: a whole campaign as one file, and what is in it given back."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from hfanalysis.archive.exporting import export
from hfanalysis.archive.reading import Archive
from hfanalysis.archive.writing import Kept, write
from hfanalysis.cli.exit_status import put, tell
from hfanalysis.cli.paper import new_table, paper
from hfanalysis.cli.query import facts_of
from hfanalysis.cli.watch import watch
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.products.disk import to_json
from hfanalysis.record.definition import find_definition
from hfanalysis.stages.open_test import PROCESSED


def archive(tests: Sequence[str], root: Path, out: Path | None, target: Path, lean: bool, quiet: bool) -> None:
    """These tests (none named: all that have products) as one file at ``target``. Runs nothing."""
    folder = out if out is not None else root / PROCESSED
    made = (path.parent.name for path in folder.glob("*/segments.json"))
    named = sorted(set(tests)) or sorted(name for name in made if ".firing-" not in name)
    if not named:
        raise AbsentError(f"{folder}: no products of any test; hfa run TEST makes them")
    kept = [Kept(name, find_definition(root, name).parent, folder / name, facts_of(root, name)) for name in named]
    with watch("archive", quiet) as progress:
        write(target, kept, lean, progress)
    if not quiet:
        size = target.stat().st_size / 1e6
        lacking = " without HDF5 products, which hfa run makes anew" if lean else ""
        tell(f"written: {target}: {len(kept)} tests, {size:.3g} MB{lacking}")


def opened(
    path: Path,
    tests: Sequence[str],
    root: Path,
    out: Path | None,
    series: str | None,
    target: Path | None,
    as_json: bool,
) -> None:
    """What an archive holds; with ``tests`` these given back below ``root``; with a ``series`` its numbers written to
    ``target``."""
    if (series is None) != (target is None):
        raise InputError("--series and --write: one without the other; expected both: what to write, and where")
    with Archive(path) as kept:
        if series is not None and target is not None:
            has = export(kept, series, tests or kept.tests, target)
            tell(f"written: {target}: {series} of {len(has)} tests")
        elif tests:
            for test in tests:
                kept.give_back(test, root / "raw_tests", out if out is not None else root / PROCESSED)
                tell(f"given back: {root / 'raw_tests' / test} and its products")
        elif as_json:
            about = {name: kept.index[name].values.tolist() for name in kept.index.variables}
            put(to_json({"tests": len(kept.tests), "series": list(kept.series), "index": about}))
        else:
            _show(kept)


def _show(kept: Archive) -> None:
    index = kept.index
    table = new_table(*map(str, ["test", *index.data_vars]), title=f"{kept.path.name}: {len(kept.tests)} tests")
    for place, test in enumerate(kept.tests):
        table.add_row(test, *(str(index[name].values[place]) or "–" for name in index.data_vars))
    console = paper()
    console.print(table)
    console.print(f"series: {', '.join(kept.series) or 'none'}")
