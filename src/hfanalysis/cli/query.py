"""hfa find: the tests that meet a condition on their quantities."""

from __future__ import annotations

from pathlib import Path

from rich.text import Text

from hfanalysis.campaign.query import FACTS, Asked, asked_of, matching, names_in, shown_of
from hfanalysis.cli.exit_status import put
from hfanalysis.cli.paper import new_table, paper, soft
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.products.disk import to_json
from hfanalysis.products.tidy import rows_of_test
from hfanalysis.record.definition import find_definition, load_definition
from hfanalysis.stages.open_test import PROCESSED


def find(
    condition: str, root: Path, out: Path | None, doubted: bool, as_json: bool, archive: Path | None = None
) -> None:
    """Print the tests below ``root`` (or ``out``), or of an ``archive``, whose products meet a condition, with what it
    names; runs nothing.

    ``doubted``: doubted and refused numbers count, too. Raises InputError where the condition is none, AbsentError
    where no test has products.
    """
    names = names_in(condition)
    tests = _made(root, out) if archive is None else _archived(archive, names)
    found = matching(tests, condition, doubted)
    if as_json:
        told = {test: {"facts": dict(tests[test].facts), "quantities": shown_of(tests[test], names)} for test in found}
        put(to_json({"condition": condition, "of": len(tests), "tests": told}))
    else:
        _show(found, tests, names)


def _made(root: Path, out: Path | None) -> dict[str, Asked]:
    """The tests that have products below ``root``, or in ``out``."""
    folder = out if out is not None else root / PROCESSED
    folders = sorted(path.parent for path in folder.glob("*/segments.json"))
    if not folders:
        raise AbsentError(f"{folder}: no products of any test; hfa run TEST makes them")
    return {path.name: asked_of(rows_of_test(path), facts_of(root, path.name)) for path in folders}


def _archived(path: Path, names: list[str]) -> dict[str, Asked]:
    """The tests of an archive, with what is asked for."""
    from hfanalysis.archive.reading import Archive

    with Archive(path) as kept:
        return kept.asked(names)


def facts_of(root: Path, test: str) -> dict[str, str | None]:
    """What test.toml states of a test; its name alone where it is not there any more, or does not load."""
    try:
        about = load_definition(find_definition(root, test.partition(".firing-")[0])).test
    except (InputError, OSError):
        return {"test": test}
    date = None if about.date is None else str(about.date)
    return {"test": test, "stand": about.stand, "kind": about.kind, "source": about.source, "date": date}


def _show(found: list[str], tests: dict[str, Asked], names: list[str]) -> None:
    console = paper()
    facts = [name for name in FACTS if name in names and name != "test"]
    quantities = [name for name in names if name not in FACTS]
    table = new_table("test", *facts, *quantities, title=f"{len(found)} of {len(tests)} tests")
    for test in found:
        one = tests[test]
        told = [one.facts.get(name) or "–" for name in facts]
        table.add_row(test, *told, *(_cell(one, name) for name in quantities))
    console.print(table) if found else console.print(Text(f"none of {len(tests)} tests"), soft_wrap=soft(console))


def _cell(test: Asked, name: str) -> Text:
    row = test.quantities.get(name)
    if row is None or row["value"] is None:
        return Text("–")
    spread = f" ± {row['std']:.2g}" if row["std"] else ""
    unit = "" if row["unit"] == "1" else f" {row['unit']}"
    verdict = f", {row['verdict']}" if row["verdict"] not in ("", "identified") else ""
    return Text(f"{row['value']:.5g}{spread}{unit}{verdict}")
