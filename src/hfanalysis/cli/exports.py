"""What is made from a finished page: its PDF, its plots as files, and the page of two tests."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from hfanalysis.cli import perform
from hfanalysis.cli.exit_status import put, tell
from hfanalysis.cli.request import Request
from hfanalysis.errors import InputError
from hfanalysis.products.disk import atomic, to_json
from hfanalysis.report import pdf
from hfanalysis.stages.base import Context
from hfanalysis.stages.material import load
from hfanalysis.stages.open_test import open_test


def report(request: Request, as_pdf: bool, plots: bool, summary: str | None = None) -> None:
    """The page of a test, and what else is asked for."""
    if as_pdf:
        pdf.find_browser()  # said before anything is computed
    context = perform.stage("report", request)
    if as_pdf:
        _told(pdf.print_page(context.product("report.html"), context.product("report.pdf")), request)
    if plots:
        _plots(context, request)
    if summary is not None:
        _summary(context, request, summary)


def _summary(context: Context, request: Request, size: str) -> None:
    """The first screen as a PDF of one page."""
    from hfanalysis.report.one_page import write_summary

    path = context.product("summary.pdf")
    with atomic(path) as scratch:
        write_summary(load(context), scratch, size)
    _told(path, request)


def _plots(context: Context, request: Request) -> None:
    from hfanalysis.report.plots import write_plots
    from hfanalysis.report.sections import charts
    from hfanalysis.wording.numbers import SOURCES

    test, folder = context.definition.test, context.product("plots")
    source = "" if test.source == "measured" else f" ({SOURCES.get(test.source, test.source)})"
    made = write_plots(charts(load(context)), folder, f"{test.id}{source}")
    for old in {*folder.glob("*.png"), *folder.glob("*.csv")} - set(made):
        old.unlink()
    _told(folder, request)


def compare(request: Request, other: str, as_pdf: bool) -> None:
    """The page that lays two tests over each other."""
    from hfanalysis.report.compare import compare as page
    from hfanalysis.report.index import write_index

    if other == request.test:
        raise InputError(f"compare {request.test} {other}: one test twice; expected two different ones")
    if as_pdf:
        pdf.find_browser()
    for test in (request.test, other):
        open_test(request.root, test, request.out)  # a name that is no test is said before anything is computed
    contexts = [perform.bring("report", replace(request, test=test)) for test in (request.test, other)]
    path = contexts[0].product(f"compare_{other}.html")
    with atomic(path) as scratch:
        scratch.write_text(page(*map(load, contexts)), encoding="utf-8")
    write_index(contexts[0].out.parent)
    made = [path] + ([pdf.print_page(path, path.with_suffix(".pdf"))] if as_pdf else [])
    if request.as_json:
        put(to_json({"tests": [request.test, other], "products": made}))
    for one in made:
        _told(one, request)


def _told(path: Path, request: Request) -> None:
    if not (request.quiet or request.as_json):
        tell(f"written: {path}")
