"""Doing what a command asks for, and showing what came of it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from hfanalysis.cli.exit_status import put, tell
from hfanalysis.cli.request import Request
from hfanalysis.cli.watch import watch
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.interface import bringing
from hfanalysis.stages import ASIDE, ORDER, way_to
from hfanalysis.stages.base import BASE, Context, load_stage
from hfanalysis.stages.freshness import edited
from hfanalysis.stages.open_test import open_test
from hfanalysis.units import near


def bring(name: str, request: Request) -> Context:
    """Bring a stage (or, for "run", all of them) up to date, silently; returns its context."""
    with watch(request.test, request.quiet) as progress:
        return bringing.bring(
            name, request.root, request.test, request.out,
            force=request.force, settings=_settings(request.settings), progress=progress,
        )  # fmt: skip


def stage(name: str, request: Request) -> Context:
    """Bring a stage (or, for "run", all of them) up to date and show it; returns its context.

    Where the test has no such thing, what its log is warned of may say why.
    """
    try:
        context = bring(name, request)
    except AbsentError:
        for text in _log_warnings(request):
            tell(f"warning: {text}")
        raise
    _show(name, context, request)
    _warn(_warnings(context, name), whole=name != "run" or request.verbose)
    if edited(context):
        path = context.definition.path
        tell(f"warning: {path} was edited while this ran: these numbers are of the file as it was; run again")
    if name == "run":
        bringing.check_spine(context)
    return context


MOST_WARNINGS = 3
"""Warnings that fit on one screen with what a run found. Source: a screen of 40 lines holds it with them."""


def _warn(texts: list[str], whole: bool) -> None:
    """Warn of all, or of the first and how many more there are."""
    shown = texts if whole else texts[:MOST_WARNINGS]
    for text in shown:
        tell(f"warning: {text}")
    if more := len(texts) - len(shown):
        tell(f"{more} more {'warning' if more == 1 else 'warnings'} on the page, or with --verbose")


def _log_warnings(request: Request) -> list[str]:
    """What ingest warned of, where it has been."""
    try:
        path = open_test(request.root, request.test, request.out).product("ingest.json")
        return [str(text) for text in json.loads(path.read_text(encoding="utf-8"))["warnings"]]
    except (OSError, ValueError, KeyError):
        return []


def _settings(texts: tuple[str, ...]) -> dict[str, Any]:
    """The parameters of ``--set STAGE.NAME=VALUE``, checked against what the stages know."""
    return dict(_setting(text) for text in texts)


def _setting(text: str) -> tuple[str, Any]:
    name, equals, value = text.partition("=")
    known = {f"{stage}.{key}": default for stage in ORDER for key, default in load_stage(stage).parameters.items()}
    if text == "help":
        listed = "".join(f"\n  {key}={json.dumps(default)}" for key, default in known.items())
        raise InputError(f"--set help: expected one of these, with their defaults:{listed}")
    if not equals or name not in known:
        raise InputError(
            f"--set {text}: expected STAGE.NAME=VALUE{near(name, known)}; there are: {', '.join(known) or 'none'}"
        )
    try:
        found = json.loads(value)
    except ValueError:
        found = value
    default = known[name]
    if type(found) is not type(default) and not (isinstance(default, float) and type(found) is int):
        raise InputError(f"--set {text}: found {value!r}, expected a value such as {default!r}")
    stage, _, key = name.partition(".")
    _check_least(text, found, default, load_stage(stage).least.get(key))
    return name, found


def _check_least(text: str, found: Any, default: Any, least: float | None) -> None:
    """Raise InputError where a number, or one of a list of them, is none or smaller than the stage can work with."""
    numbers = found if isinstance(found, list) else [found]
    if isinstance(default, list) and not (numbers and all(type(n) in (int, float) for n in numbers)):
        raise InputError(f"--set {text}: found {found!r}, expected a list of numbers such as {default!r}")
    if least is not None and not all(math.isfinite(n) and n >= least for n in numbers):
        raise InputError(f"--set {text}: found {found!r}, expected {least:g} or more")


def proof_test(root: Path, test: str, other: str) -> str:
    """The parameter that names the test to prove a diagnosis on.

    Raises InputError where that is no other test: asked before anything runs, so that no finished product is lost.
    """
    from hfanalysis.record.definition import find_definition

    if find_definition(root, test) == find_definition(root, other):
        raise InputError(f"--proof-test {other}: found the test itself; expected another one")
    return f"diagnose.proof_test={json.dumps(other)}"


def _show(name: str, context: Context, request: Request) -> None:
    if request.as_json:
        put(_json(name, context))
    elif not request.quiet:
        from hfanalysis.cli import tables

        if name == "run" and not request.verbose:
            tables.show_run(context)
        else:
            tables.show(name, context)


def _json(name: str, context: Context) -> str:
    """The stage's JSON product as it is on disk; for stages without one, what they made."""
    from hfanalysis.products.disk import to_json

    if name == "run":
        return to_json(
            {stage: json.loads(_json(stage, context)) for stage in way_to(name) if stage not in context.absent}
        )
    for product in load_stage(name).products:
        if product.endswith(".json"):
            return context.product(product).read_text(encoding="utf-8")
    made = [context.product(product) for product in load_stage(name).products]
    return to_json({"test": context.id, "products": made})


def _warnings(context: Context, name: str) -> list[str]:
    """What the products up to this stage warn of, each once."""
    texts = list(context.definition.warnings)
    for stage in way_to(name):
        if stage in context.absent:
            if stage in ASIDE and name not in ("run", stage):
                continue  # nobody asked for it; the page says how to
            texts += [] if stage in bringing.SPINE and name == "run" else [f"{stage}: {context.absent[stage]}"]
            continue
        texts += _product_warnings(context, stage)
    return [_numbered(text, known) for known in [_reasons(context)] for text in dict.fromkeys(texts)]


def _reasons(context: Context) -> list[str]:
    """The sentences by which channels are doubted, in the order of the numbers that tables mark numbers with."""
    from hfanalysis.health.reasons import reasons
    from hfanalysis.products.health import Health

    if not context.product(Health.file).is_file():
        return []
    return [str(doubt.sentence) for doubt in reasons(context.read(Health).channels)]


def _numbered(text: str, known: list[str]) -> str:
    return f"[{known.index(text) + 1}] {text}" if text in known else text


def _product_warnings(context: Context, name: str) -> list[str]:
    found: list[str] = []
    for product in load_stage(name).products:
        path = context.product(product)
        if path.exists() and product.endswith(".json") and not product.startswith(BASE):
            found += [str(text) for text in context.read_json(product).get("warnings", [])]
    return found
