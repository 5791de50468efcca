"""hfa campaign: all tests through all stages, side by side, and what those of one stand say together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from rich.text import Text

from hfanalysis.campaign.cluster import Cluster
from hfanalysis.campaign.conclusions import conclusions
from hfanalysis.campaign.page import page
from hfanalysis.campaign.product import row_of, stand_row
from hfanalysis.campaign.side_by_side import Ended, Work, run_all
from hfanalysis.campaign.skill import record, skill_sentence
from hfanalysis.campaign.words import agreement, diagnosed, regression_sentence
from hfanalysis.cli.exit_status import put, tell
from hfanalysis.cli.paper import new_table, paper
from hfanalysis.cli.watch import watch
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.interface.ending import ABSENT, DONE, INPUT_AT_FAULT
from hfanalysis.processors import processors
from hfanalysis.products.campaign import Campaign, Together
from hfanalysis.products.disk import atomic, to_json, write_json
from hfanalysis.progress import Progress
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition, find_definition
from hfanalysis.report.index import write_index
from hfanalysis.stages.open_test import PROCESSED, RAW, open_test
from hfanalysis.wording.numbers import in_words, shown

_SHOWN = ("burn_time", "total_impulse", "specific_impulse")


@dataclass(frozen=True)
class CampaignRequest:
    """What the command line asks for; no ``tests`` are all of them."""

    tests: tuple[str, ...]
    root: Path
    out: Path | None
    jobs: int | None
    as_json: bool
    force: bool
    quiet: bool
    scheduler: str | None = None


def campaign(request: CampaignRequest) -> int:
    """Run the tests, write campaign.json and campaign.html, and show what they say; returns the exit status.

    A test whose log does not hold all that was asked is part of it with what it has. Raises InputError where there is
    no test, or a name is none, before anything runs; AbsentError where no test can be calibrated.
    """
    definitions, refused = _definitions(request)
    tests = [*definitions, *refused]
    folder = request.out if request.out is not None else request.root / PROCESSED
    with watch("campaign", request.quiet) as progress:
        ended = {**_run(list(definitions), request, progress), **refused}
        rows = {test: row_of(definitions.get(test), folder / test, ended[test]) for test in sorted(tests)}
        stands = dict.fromkeys(row.stand for row in rows.values() if row.stand)
        by_stand = {stand: {test: row for test, row in rows.items() if row.stand == stand} for stand in stands}
        said = {stand: stand_row(own, folder) for stand, own in by_stand.items()}
        predictions = record(request.root, ended, request.out, progress)
        product = Campaign(tests=rows, stands=said, predictions=predictions)
    folder.mkdir(parents=True, exist_ok=True)
    write_json(folder / product.file, product)
    with atomic(folder / "campaign.html") as scratch:
        scratch.write_text(page(product), encoding="utf-8")
    write_index(folder)
    _show(product, request, folder)
    return _status(ended)


def _definitions(request: CampaignRequest) -> tuple[dict[str, TestDefinition], dict[str, Ended]]:
    """The tests' definitions, and what is wrong with those that have faults."""
    found = sorted(path.parent.name for path in (request.root / RAW).glob("*/test.toml"))
    tests = list(dict.fromkeys(request.tests)) or found
    if not tests:
        raise InputError(f"{request.root / RAW}: found no test; expected folders with a test.toml")
    for test in tests:
        find_definition(request.root, test)
    definitions, refused = {}, {}
    for test in tests:
        try:
            definitions[test] = open_test(request.root, test, request.out).definition
        except InputError as error:
            refused[test] = Ended(INPUT_AT_FAULT, str(error))
            tell(str(error))
    return definitions, refused


def _run(tests: list[str], request: CampaignRequest, progress: Progress) -> Mapping[str, Ended]:
    done: list[str] = []

    def ended(test: str, how: Ended) -> None:
        done.append(test)
        doing(test)
        if how.status != DONE:
            tell(f"{test}: {how.said}")

    def doing(text: str) -> None:
        progress(f"{len(done)} of {len(tests)} tests; {text}", len(done) / len(tests))

    if not tests:
        return {}
    if request.scheduler is not None and not request.scheduler.startswith("tls://"):
        tell(f"warning: {request.scheduler}: whoever reaches it can run anything on its workers; expected tls://…")
    doing("starting")
    with Cluster(min(request.jobs or processors(), len(tests)), request.scheduler) as cluster:
        return run_all(tests, Work(request.root, request.out, request.force), cluster, ended, doing)


def _status(ended: Mapping[str, Ended]) -> int:
    """A defect of ours first, then the input's faults; what logs do not hold counts where none holds it."""
    if any(how.defect for how in ended.values()):
        return 1
    if any(how.status == INPUT_AT_FAULT for how in ended.values()):
        return INPUT_AT_FAULT
    if all(how.status == ABSENT for how in ended.values()):
        raise AbsentError("none of the tests can be calibrated")
    return DONE


def _show(product: Campaign, request: CampaignRequest, folder: Path) -> None:
    if request.as_json:
        put(to_json(product))
    elif not request.quiet:
        _print(product)
        tell(f"written: {folder / 'campaign.html'}")


def _print(product: Campaign) -> None:
    """The tests in a table, what each one's model lacks, and for each stand what its tests say together."""
    console = paper()
    table = new_table("test", *(in_words(name) for name in _SHOWN), "apogee", title="tests")
    for test, row in product.tests.items():
        found = [*(row.performance.get(name) for name in _SHOWN), row.apogee]
        table.add_row(test, *map(_number, found))
    console.print(table)
    for test, row in product.tests.items():
        console.print(Text(f"  {test}: the model lacks: {diagnosed(row.diagnosis)}"), soft_wrap=True)
    if told := skill_sentence(product.predictions):
        console.print(Text(f"  {told}"), soft_wrap=True)
    for name, stand in product.stands.items():
        if len(stand.tests) == 1:
            continue
        constants = stand.constants
        for sentence in conclusions(stand, product.tests):
            console.print(Text(f"  {sentence}"), soft_wrap=True)
        table = new_table("", *constants, title=f"stand: {name}")
        for test in stand.tests:
            table.add_row(test, *(_number(product.tests[test].calibration.get(c)) for c in constants))
        table.add_row("together", *(_number(together.mean) for together in constants.values()), style="bold")
        console.print(table)
        for constant, together in constants.items():
            console.print(Text(f"  {constant}: {_agreed(together)}"), soft_wrap=True)
        console.print(Text(f"  {regression_sentence(stand.regression)}"), soft_wrap=True)


def _agreed(together: Together) -> str:
    return f"the tests {agreement(together)}" if together.agreement else agreement(together)


def _number(quantity: Quantity | None) -> Text:
    """With its deviation and unit; what a verdict says against it."""
    if quantity is None or quantity.value is None:
        return Text("–")
    text = shown(quantity)
    number = f"{text.value} ± {text.std}" if text.std else text.value
    doubt = f", {text.verdict}" if text.verdict not in ("", "identified") else ""
    return Text(f"{f'({number})' if text.unit.startswith('×') else number} {text.unit}".strip() + doubt)
