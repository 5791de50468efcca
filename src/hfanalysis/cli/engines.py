"""``hfa simulate`` and ``hfa design``: from an engine file to a table, JSON or a folder of products."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from hfanalysis.cli.exit_status import put, tell
from hfanalysis.cli.watch import watch
from hfanalysis.errors import InputError
from hfanalysis.products.disk import to_json
from hfanalysis.record.engine_file import load_engine

if TYPE_CHECKING:
    from hfanalysis.products.engines import Designed, Simulated

NOTHING: Mapping[str, Sequence[str]] = {}
"""Of a study, where nobody says what it is to go through."""


def simulate(
    path: Path, out: Path | None, as_json: bool, quiet: bool, until: float | None = None, draws: int = 0
) -> None:
    """The unsteady model of the engine file at ``path``; what it found to ``out`` where that is given.

    To burn-out, or on through cold gas until ``until`` [s]; ``draws``: engines drawn over what it states with a +/-.
    """
    file = load_engine(path)
    with watch(file.engine.id, quiet):
        from hfanalysis.cli import engine_page
        from hfanalysis.simulation import unsteady_run, write

        found = unsteady_run.simulate(file, until, draws)
        if out is not None:
            with _writing(out):
                write.simulation(out, found)
                engine_page.write_page(out, file, found)
    _show(found.product, as_json, quiet)


def design(path: Path, out: Path | None, as_json: bool, quiet: bool, given: Mapping[str, Sequence[str]] = NOTHING,
           engine: Path | None = None, draws: int = 0) -> None:  # fmt: skip
    """The steady design of the engine file at ``path``; with its parametric study to ``out`` where that is given.

    ``given``: flows, lengths and pressures of the study, with their units; ``engine``: the engine file to write;
    ``draws``: designs drawn over what is stated with a +/-.
    """
    file = load_engine(path)
    with watch(file.engine.id, quiet):
        from hfanalysis.simulation import hand_over, steady_run, study, write

        ranges = study.ranges_of(given)
        if out is None and ranges != study.USUAL:
            raise InputError("--flow, --length, --pressure: are of the study that --out writes; expected --out, too")
        if engine is not None:
            hand_over.refuse_taken(engine)
        found = steady_run.design(file, draws)
        if engine is not None:
            hand_over.write(engine, file, found)
        if out is not None:
            with _writing(out):
                write.design(out, file, found, ranges)
    _show(found.product, as_json, quiet)


def next_tests(path: Path, wanted: str | None, as_json: bool, quiet: bool) -> None:
    """What to test next with the engine file at ``path``; ``wanted``: what is to be narrowed."""
    file = load_engine(path)
    with watch(file.engine.id, quiet):
        from hfanalysis.simulation import next_test, unsteady_run

        found = next_test.next_tests(file, unsteady_run.effects_of(file), wanted)
    if as_json:
        put(to_json(found))
    elif not quiet:
        from hfanalysis.cli import tables

        tables.show_next(found)


@contextmanager
def _writing(out: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(f"--out {out}: cannot be written ({error.strerror}); expected a folder") from None


def _show(product: Simulated | Designed, as_json: bool, quiet: bool) -> None:
    if as_json:
        put(to_json(product))
    elif not quiet:
        from hfanalysis.cli import tables

        tables.show_engine(product)
    beyond = () if as_json else (found.text for found in product.beyond)  # JSON has them
    for warning in (*beyond, *product.warnings):
        tell(f"warning: {warning}")
