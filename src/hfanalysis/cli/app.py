"""The commands and their options. Nothing heavy is imported before a command needs it."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from hfanalysis.cli.engine_commands import OF_ENGINES
from hfanalysis.cli.exit_status import plain_exit
from hfanalysis.cli.options import Firing, Force, Json, Out, Pdf, ProductJson, Quiet, Root, Set, Test, Trust
from hfanalysis.cli.request import Request, named
from hfanalysis.cli.several_commands import OF_SEVERAL
from hfanalysis.cli.trust import ask
from hfanalysis.errors import InputError
from hfanalysis.stages import RUN, STAGES
from hfanalysis.version import __version__

app = typer.Typer(
    name="hfa",
    help="Hot-fire test data analysis for nitrous oxide / paraffin hybrid engines.",
    epilog="Exit status: 0 done, 2 the input is at fault, 3 the log does not hold what was asked, 1 a defect of ours.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"hfa {__version__}")
        raise typer.Exit


@app.callback()
def _hfa(
    version: Annotated[
        bool, typer.Option("--version", "-V", callback=_version, is_eager=True, help="Print the version and stop.")
    ] = False,
) -> None:
    """Hot-fire test data analysis for nitrous oxide / paraffin hybrid engines."""


def _common(
    test: Test,
    root: Root = Path(),
    out: Out = None,
    as_json: Json = False,
    force: Force = False,
    quiet: Quiet = False,
    settings: Set = None,
    firing: Firing = None,
    trust_effects: Trust = False,
) -> Request:
    """What every stage is asked with."""
    test, root = named(test, root)
    ask(root, trust_effects)
    request = Request(test, root, out, as_json, force, quiet, tuple(settings or ()))
    return request if firing is None else request.setting(f"segment.firing={firing}")


def _stage(name: str, text: str, does: Callable[..., None]) -> None:
    """A command with the common options, and those that ``does`` takes beside the request."""
    common, own = inspect.signature(_common, eval_str=True), inspect.signature(does, eval_str=True)
    options = [*common.parameters.values(), *list(own.parameters.values())[1:]]

    def command(**given: Any) -> None:
        with plain_exit():
            request = _common(**{key: given.pop(key) for key in common.parameters})
            does(request, **given)

    command.__signature__ = inspect.Signature(options)  # type: ignore[attr-defined]
    command.__annotations__ = {option.name: option.annotation for option in options}
    app.command(name, help=text)(command)


def _plain(name: str) -> Callable[[Request], None]:
    """A stage without options of its own."""

    def does(request: Request) -> None:
        from hfanalysis.cli import perform

        perform.stage(name, request)

    return does


Raw = Annotated[bool, typer.Option("--raw-thrust", help="Fly the thrust as measured on the stand, as the report does.")]


def _flight(request: Request, raw_thrust: Raw = False) -> None:
    from hfanalysis.cli import perform

    perform.stage("flight", request.setting("flight.raw_thrust=true") if raw_thrust else request)


Apply = Annotated[bool, typer.Option("--apply", help="Adopt what is named: engines/TEST.effects.toml.")]
Unknown = Annotated[
    bool, typer.Option("--unknown", help="With --apply: adopt what has no name, as a table over what it follows.")
]
Retract = Annotated[bool, typer.Option("--retract", help="Remove that file again; nothing is diagnosed.")]
Stand = Annotated[bool, typer.Option("--stand", help="Adopt or retract for all tests of the test's stand.")]
ProofTest = Annotated[
    str | None,
    typer.Option("--proof-test", metavar="OTHER", help="The test to prove it on, instead of another of the stand."),
]


def _diagnose(
    request: Request,
    apply: Apply = False,
    unknown: Unknown = False,
    retract: Retract = False,
    stand: Stand = False,
    proof_test: ProofTest = None,
) -> None:
    from hfanalysis.cli import adopt, perform

    if proof_test is not None:
        request = request.setting(perform.proof_test(request.root, request.test, proof_test))
    if unknown and not apply:
        raise InputError("found --unknown alone; expected it with --apply")
    if not (apply or retract or stand):
        perform.stage("diagnose", request)
    elif apply == retract:
        raise InputError("found --apply and --retract together, or --stand alone; expected one of the two")
    else:
        adopt.apply(request, stand, unknown) if apply else adopt.retract(request, stand)


Plots = Annotated[bool, typer.Option("--plots", help="Also write every chart as PNG and CSV to TEST/plots/.")]
Summary = Annotated[bool, typer.Option("--summary", help="Also write the first screen as one page: summary.pdf (A4).")]
Letter = Annotated[bool, typer.Option("--letter", help="With --summary: on Letter paper.")]


def _report(
    request: Request, pdf: Pdf = False, plots: Plots = False, summary: Summary = False, letter: Letter = False
) -> None:
    from hfanalysis.cli import exports

    if letter and not summary:
        raise InputError("found --letter alone; expected it with --summary")
    size = ("letter" if letter else "a4") if summary else None
    exports.report(request, pdf, plots, size)


Cure = Annotated[bool, typer.Option("--apply", help="Write the cures of what is found into test.toml, after asking.")]
Yes = Annotated[bool, typer.Option("--yes", help="With --apply: do not ask.")]


def _health(request: Request, apply: Cure = False, yes: Yes = False) -> None:
    from hfanalysis.cli import health, perform

    if yes and not apply:
        raise InputError("found --yes alone; expected it with --apply")
    if apply:
        health.apply(request, yes)
    else:
        perform.stage("health", request)


Quick = Annotated[
    bool,
    typer.Option(
        "--quick", help="Within seconds: phases, peaks, impulse, C_i and which sensors to believe. Only shown."
    ),
]


Verbose = Annotated[bool, typer.Option("--verbose", "-v", help="Print what every stage found, and every warning.")]


Check = Annotated[bool, typer.Option("--check", help="End with status 4 where a rule of limits.toml is broken.")]


def _run(request: Request, quick: Quick = False, verbose: Verbose = False, check: Check = False) -> None:
    if quick and check:
        raise InputError("found --quick and --check together; expected one of the two: the rules are of the whole run")
    if quick:
        from hfanalysis.cli import quick as at_stand

        at_stand.quick(request)
    else:
        from hfanalysis.cli import perform

        context = perform.stage(RUN, replace(request, verbose=verbose))
        if check:
            from hfanalysis.cli import limits

            limits.check(context)


_WITH_OPTIONS: dict[str, Callable[..., None]] = {
    "health": _health,
    "diagnose": _diagnose,
    "flight": _flight,
    "report": _report,
    RUN: _run,
}

for _name, _text in {**STAGES, RUN: "Every stage; the diagnosis takes longest."}.items():
    _stage(_name, _text, _WITH_OPTIONS.get(_name) or _plain(_name))


def _budget(request: Request) -> None:
    from hfanalysis.cli import budget

    budget.budget(request)


_stage("budget", "What the standard deviations of a test's quantities are made of.", _budget)


@app.command("watch")
def _watch(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="The folder into which the logger writes.")],
    root: Root = Path(),
    once: Annotated[bool, typer.Option("--once", help="Look at the logs that are there, and end.")] = False,
    as_json: Json = False,
    trust_effects: Trust = False,
) -> None:
    """A quick look (as hfa run --quick) at each log as it lands in FOLDER; nothing is written.

    Its test.toml is that of the last test with the same columns, else a draft, without masses and C_i.
    """
    with plain_exit():
        from hfanalysis.cli.landing import watch_folder

        ask(root, trust_effects)
        watch_folder(folder, root, once, as_json)


for _name, _command in {**OF_ENGINES, **OF_SEVERAL}.items():
    app.command(_name)(_command)


AnyTest = Annotated[
    str | None, typer.Argument(metavar="TEST", help="Name of a test: what can be told apart with its channels.")
]


@app.command("effects")
def _effects(
    test: AnyTest = None,
    root: Root = Path(),
    out: Out = None,
    as_json: ProductJson = False,
    trust_effects: Trust = False,
) -> None:
    """List the effects that can be added to the model; for a TEST, what its channels can tell apart."""
    with plain_exit():
        ask(root, trust_effects)
        if test is None:
            from hfanalysis.cli import effects

            effects.effects(root, as_json)
        else:
            from hfanalysis.cli import separability

            separability.separability(test, root, out, as_json)


@app.command("new")
def _new(
    test: Annotated[str, typer.Argument(metavar="ID", help="Name of the new test.")],
    log: Annotated[
        list[Path],
        typer.Option(help="Its log file, copied to raw_tests/ID/ if it is elsewhere; again for every other."),
    ],
    root: Root = Path(),
    edit: Annotated[bool, typer.Option("--edit", help="Ask at the terminal what each column is.")] = False,
) -> None:
    """Draft raw_tests/ID/test.toml from what logs show, and draw every column. Never overwrites."""
    with plain_exit():
        from hfanalysis.cli import new

        new.new(root, test, log, edit)


@app.command("demo")
def _demo(
    folder: Annotated[
        Path, typer.Argument(metavar="[FOLDER]", help="Where to write them.", show_default="here")
    ] = Path(),
) -> None:
    """Write examples to start from: the tests HF5 and HF4 (generated, not measured) and the report's engine."""
    with plain_exit():
        from hfanalysis.cli import demo

        demo.demo(folder)


@app.command("docs")
def _docs(
    page: Annotated[str | None, typer.Argument(metavar="[PAGE]", help="Such as tutorial; none: the list.")] = None,
) -> None:
    """Show a page of the documentation that comes with the package, or list them."""
    with plain_exit():
        from hfanalysis.cli import demo

        demo.docs(page)
