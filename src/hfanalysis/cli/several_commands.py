"""The commands that take several tests at once: compared, pooled, in one table, searched."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from hfanalysis.cli.exit_status import plain_exit
from hfanalysis.cli.options import Force, Json, Out, Pdf, ProductJson, Quiet, Root, Test, Trust, tests_of
from hfanalysis.cli.request import Request
from hfanalysis.cli.trust import ask

Tests = Annotated[
    list[str] | None,
    typer.Argument(metavar="[TEST…]", help="Names of tests; none: all.", autocompletion=tests_of),
]
Kept = Annotated[Path | None, typer.Option("--archive", metavar="FILE", help="Of the tests of an archive instead.")]
Jobs = Annotated[int | None, typer.Option("--jobs", "-j", min=1, help="Tests at a time.", show_default="one per core")]


def _compare(
    test: Test,
    other: Annotated[str, typer.Argument(metavar="OTHER", help="The test to lay over it.")],
    root: Root = Path(),
    out: Out = None,
    as_json: Json = False,
    quiet: Quiet = False,
    pdf: Pdf = False,
    trust_effects: Trust = False,
) -> None:
    """Lay two tests over each other: TEST/compare_OTHER.html, curves from the valve's opening, numbers side by side."""
    with plain_exit():
        from hfanalysis.cli import exports

        ask(root, trust_effects)
        exports.compare(Request(test, root, out, as_json, False, quiet), other, pdf)


def _regression(
    tests: Annotated[list[str], typer.Argument(metavar="TEST OTHER…", help="Tests of one fuel; at least two.")],
    root: Root = Path(),
    out: Out = None,
    as_json: ProductJson = False,
    trust_effects: Trust = False,
) -> None:
    """Regression constants a and n common to several tests, and whether the tests agree on them."""
    with plain_exit():
        from hfanalysis.cli import regression

        ask(root, trust_effects)
        regression.regression(tests, root, out, as_json)


def _campaign(
    tests: Tests = None,
    root: Root = Path(),
    out: Out = None,
    jobs: Jobs = None,
    as_json: ProductJson = False,
    force: Force = False,
    quiet: Quiet = False,
    trust_effects: Trust = False,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="A dask scheduler whose workers run them: tls://HOST:PORT.")
    ] = None,
) -> None:
    """Every stage of all tests, several at a time, and what those of one stand say together: campaign.html, .json."""
    with plain_exit():
        from hfanalysis.cli import campaign

        ask(root, trust_effects)
        request = campaign.CampaignRequest(tuple(tests or ()), root, out, jobs, as_json, force, quiet, scheduler)
        status = campaign.campaign(request)
        if status:
            raise typer.Exit(status)


def _table(
    tests: Tests = None,
    root: Root = Path(),
    out: Out = None,
    write: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write it there: .csv, .parquet or .xlsx, by the ending.")
    ] = None,
    archive: Kept = None,
) -> None:
    """Every quantity of the products of tests as one tidy table: CSV on standard output, or a file. Runs nothing."""
    with plain_exit():
        from hfanalysis.cli import table

        table.table(tests or (), root, out, write, archive)


def _diff(
    old: Annotated[Path, typer.Argument(metavar="OLD", help="Products as they were: a processed/, or one TEST of it.")],
    new: Annotated[Path, typer.Argument(metavar="NEW", help="Products as they are.")],
    least: Annotated[
        float, typer.Option(min=0.0, metavar="DEVIATIONS", help="Smallest change that counts, in standard deviations.")
    ] = 0.01,
    as_json: ProductJson = False,
) -> None:
    """Which numbers changed between two folders of products, by how many standard deviations, and what made them."""
    with plain_exit():
        from hfanalysis.cli import differences

        differences.differ(old, new, least, as_json)


def _find(
    condition: Annotated[
        str, typer.Argument(metavar="CONDITION", help="Such as \"C_i > 0.3 and m < 1 and stand = 'north'\".")
    ],
    root: Root = Path(),
    out: Out = None,
    doubted: Annotated[bool, typer.Option("--all", help="Doubted and refused numbers count, too.")] = False,
    as_json: ProductJson = False,
    archive: Kept = None,
) -> None:
    """Tests that meet a condition on their quantities, in SI units; what it names is shown with verdicts."""
    with plain_exit():
        from hfanalysis.cli import query

        query.find(condition, root, out, doubted, as_json, archive)


def _archive(
    write: Annotated[Path, typer.Option(metavar="FILE", help="Write it there; a name that ends with .h5.")],
    tests: Tests = None,
    root: Root = Path(),
    out: Out = None,
    lean: Annotated[
        bool,
        typer.Option("--lean", help="Without the HDF5 products' own bytes: a test that is given back is run anew."),
    ] = False,
    quiet: Quiet = False,
) -> None:
    """Tests with raw logs, test.toml and products as one file, which xarray opens lazily. Runs nothing."""
    with plain_exit():
        from hfanalysis.cli import archive

        archive.archive(tests or (), root, out, write, lean, quiet)


def _open(
    archive: Annotated[Path, typer.Argument(metavar="FILE", help="What hfa archive has written.")],
    tests: Annotated[
        list[str] | None, typer.Argument(metavar="[TEST…]", help="Tests to give back, or to write.")
    ] = None,
    root: Root = Path(),
    out: Out = None,
    series: Annotated[
        str | None, typer.Option(metavar="NAME", help="Write this series: ingest, residuals/full/p_chamber, …")
    ] = None,
    write: Annotated[
        Path | None, typer.Option(metavar="OUT", help="Where to: .csv, .parquet or .mat, by the ending.")
    ] = None,
    as_json: ProductJson = False,
) -> None:
    """What an archive holds; with TEST, its files given back below ROOT; with --series, numbers for other programs."""
    with plain_exit():
        from hfanalysis.cli import archive as archives

        archives.opened(archive, tests or (), root, out, series, write, as_json)


OF_SEVERAL: dict[str, Callable[..., None]] = {
    "compare": _compare,
    "regression": _regression,
    "campaign": _campaign,
    "table": _table,
    "diff": _diff,
    "find": _find,
    "archive": _archive,
    "open": _open,
}
"""By name; their first lines are the help."""
