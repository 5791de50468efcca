"""Runs what a stage needs first, redoes only what changed, and leaves whole products or none.

Whether a product is up to date is judged by content: SHA-256 of the raw files, ``test.toml``, adopted effects, the
sources that the stage rests on, the versions of their libraries, the stage's parameters and the upstream products. The
time stamps that make goes by are kept in agreement.
"""

from __future__ import annotations

import json
import os
import platform
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from hfanalysis import sources
from hfanalysis.errors import AbsentError, AnalysisError, InputError
from hfanalysis.products import disk as products
from hfanalysis.products.disk import HashCache
from hfanalysis.record.definition import load_definition
from hfanalysis.stages import ASIDE, ORDER, base, freshness
from hfanalysis.stages.base import Context, Stage
from hfanalysis.stages.lock import locked
from hfanalysis.version import __version__

RUN_LOG = "run.log"
_ATTEMPTS = 3
"""Starts of a run whose products somebody removes meanwhile."""


def run_to(name: str, context: Context, *, force: bool = False, whole: bool = False) -> Context:
    """Bring the products of stage ``name`` up to date, and of every stage before it.

    Args:
        name: the stage.
        context: the test, from :func:`hfanalysis.stages.open_test.open_test`.
        force: redo the stage and all before it, even where nothing changed.
        whole: run the stages that stand aside, too, where they are wanted; else their products are taken as they are.

    Returns:
        The context, with ``absent`` telling which stages the log holds nothing for.

    Raises:
        InputError, AbsentError: the stage, or one that it needs, could not be done.
    """
    for attempt in range(_ATTEMPTS):
        try:
            with _plain_refusals(context), locked(context.out, lambda: _say_waiting(context)):
                return _Run(as_stated_now(context), force, whole).to(name)
        except FileNotFoundError:
            if (context.out / freshness.STATE).exists() or attempt == _ATTEMPTS - 1:
                raise
    raise AssertionError("unreachable")


def as_stated_now(context: Context) -> Context:
    """The context by the test.toml that is there now: it may have been edited while another run was waited for."""
    if not freshness.edited(context):
        return context
    return replace(context, definition=load_definition(context.definition.path))


def _say_waiting(context: Context) -> None:
    context.progress(f"waiting for another run of {context.id} to end", None)


@contextmanager
def _plain_refusals(context: Context) -> Iterator[None]:
    """Say in plain words that products cannot be written, where the system refuses."""
    try:
        yield
    except OSError as error:
        if error.errno not in products.REFUSED:
            raise
        place = error.filename or context.out
        raise InputError(f"{place}: {error.strerror}; choose another place for the products with --out DIR") from None


class _Run:
    """One run over the stages of one test, under its lock."""

    def __init__(self, context: Context, force: bool, whole: bool) -> None:
        self.context = context
        self.force = force
        self.whole = whole
        self.done: set[str] = set()
        state = context.out / freshness.STATE
        products.make_folder(state)
        self.hashes = HashCache(state / "hashes.json")

    def to(self, name: str) -> Context:
        """Bring ``name`` up to date, its upstream first."""
        products.remove_temporaries(self.context.out)
        try:
            self._bring(base.load_stage(name))
        finally:
            products.remove_temporaries(self.context.out)
            if self.context.out.exists():
                self.hashes.save()
        return self.context

    def _bring(self, stage: Stage) -> None:
        if stage.name in self.done:
            return
        for name in stage.upstream:
            self._bring_upstream(base.load_stage(name), needed=name in stage.needs)
        self._bring_one(stage)
        self.done.add(stage.name)

    def _bring_upstream(self, stage: Stage, needed: bool) -> None:
        try:
            if stage.name in ASIDE:
                self.context = self._as_last_asked(stage)
            if stage.name in ASIDE and not needed and not self.whole:
                self._take(stage)
            else:
                self._bring(stage)
        except AbsentError as error:
            if needed:
                raise
            self.context = replace(self.context, absent={**self.context.absent, stage.name: str(error)})

    def _as_last_asked(self, stage: Stage) -> Context:
        """The context with the parameters that a stage was last made with, where this run sets no others."""
        last = freshness.recorded(self.context, stage).get("parameters", {})
        kept = {f"{stage.name}.{name}": value for name, value in last.items() if name in stage.parameters}
        return replace(self.context, settings={**kept, **self.context.settings})

    def _take(self, stage: Stage) -> None:
        """A stage that stands aside, as it was left. Raises AbsentError where it is not there or out of date."""
        record = freshness.provenance(self.context, stage, self.hashes)
        note = freshness.recorded(self.context, stage)
        key = products.sha256_json([stage.name, record])
        if not freshness.is_fresh(self.context, stage, note, key, self.hashes):
            raise AbsentError(
                f"not made, or older than what it is made from: hfa {stage.name} {self.context.id} makes it"
            )
        if note.get("absent"):
            raise AbsentError(note["absent"])

    def _bring_one(self, stage: Stage) -> None:
        record = freshness.provenance(self.context, stage, self.hashes)
        key = products.sha256_json([stage.name, record])
        note = freshness.recorded(self.context, stage)
        if self.force or not freshness.is_fresh(self.context, stage, note, key, self.hashes):
            self._redo(stage, record, key)
        elif note.get("absent"):
            raise AbsentError(note["absent"])
        self._agree_with_make(stage)

    def _redo(self, stage: Stage, record: dict[str, Any], key: str) -> None:
        started = time.perf_counter()
        self.context.progress(stage.name, None)
        try:
            self._run(stage, record)
            self._check_untouched(record)
            made = self._commit(stage)
        except AnalysisError as error:
            self._withdraw(stage)
            if isinstance(error, AbsentError):
                self._note(stage, {"key": key, "absent": str(error), "parameters": record["parameters"]})
            self._log(stage, started, f"exit {error.exit_status}: {error}")
            raise
        self._note(stage, {"key": key, "products": made, "parameters": record["parameters"]})
        self._log(stage, started, "done")

    def _run(self, stage: Stage, record: dict[str, Any]) -> None:
        """The stage itself; code of a team's effects that ends the program must not end it as if all were done."""
        try:
            stage.run(self.context.at(stage, record=record))
        except SystemExit as error:
            own = self.context.root / "effects"
            raise InputError(f"stage {stage.name}: the code in {own} ended it ({error!r})") from None

    def _check_untouched(self, record: dict[str, Any]) -> None:
        """A log that grew while it was read would be recorded under a hash that is not its own."""
        for name, digest in record["raw"].items():
            path = self.context.raw / name
            if self.hashes(path) != digest:
                raise InputError(f"{path}: the file changed while it was being read; run again when it is complete")

    def _commit(self, stage: Stage) -> dict[str, str]:
        """Give the products their names, all of them complete, and say what they are."""
        finals = [self.context.product(name) for name in stage.products]
        for final in finals:
            products.fsync(products.temporary_path(final))
            products.share(products.temporary_path(final))
        for final in finals:
            os.replace(products.temporary_path(final), final)
        products.fsync(self.context.out)
        return {final.name: self.hashes(final) for final in finals}

    def _withdraw(self, stage: Stage) -> None:
        """Remove products that no longer follow from the input, of this stage and of those after it."""
        gone = {stage.name}
        for later in map(base.load_stage, ORDER):
            if later.name in gone or gone & set(later.needs):
                gone.add(later.name)
                freshness.state_path(self.context, later).unlink(missing_ok=True)
                for name in later.products:
                    self.context.product(name).unlink(missing_ok=True)

    def _note(self, stage: Stage, note: dict[str, Any]) -> None:
        products.write_json(freshness.state_path(self.context, stage), note)

    def _log(self, stage: Stage, started: float, end: str) -> None:
        """Add a line to run.log, which is kept apart so that products are the same from run to run."""
        line = {
            "time": time.strftime("%Y-%m-%dT%H:%M:%S%z"),
            "stage": stage.name,
            "seconds": round(time.perf_counter() - started, 3),
            "end": end,
            "hfanalysis": __version__,
            "python": platform.python_version(),
            "machine": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        }
        path = self.context.out / RUN_LOG
        with path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line, ensure_ascii=False) + "\n")
        products.share(path)

    def _agree_with_make(self, stage: Stage) -> None:
        """Products no older than what they are made from, but older than a test.toml that was edited meanwhile."""
        if freshness.edited(self.context):
            for name in stage.products:
                products.touch_before(self.context.product(name), self.context.definition.path)
            return
        inputs = [*freshness.input_files(self.context, stage), *self._upstream_products(stage)]
        for name in stage.products:
            products.touch_after(self.context.product(name), inputs, sources.state().newest)

    def _upstream_products(self, stage: Stage) -> list[Path]:
        names = (name for name in stage.upstream if name not in self.context.absent)
        return [self.context.product(product) for name in names for product in stage.reads(base.load_stage(name))]
