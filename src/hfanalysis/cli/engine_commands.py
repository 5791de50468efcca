"""The commands that take or make engines and predictions of them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from hfanalysis.cli.exit_status import plain_exit
from hfanalysis.cli.options import ProductJson, Quiet, Root, Test, Trust
from hfanalysis.cli.request import Request, named
from hfanalysis.cli.trust import ask

EngineToml = Annotated[Path, typer.Argument(metavar="ENGINE.toml", help="An engine file, see engines/.")]
Folder = Annotated[Path | None, typer.Option(help="Also write what was found to this folder.")]


Until = Annotated[
    float | None,
    typer.Option("--until", metavar="SECONDS", help="Run on after burn-out, through vapor and cold gas, to this time."),
]


Draws = Annotated[
    int, typer.Option("--draws", min=0, metavar="N", help="Drawn over what is stated with +/-; 0: no bands.")
]


def _simulate(
    engine: EngineToml,
    as_json: ProductJson = False,
    out: Folder = None,
    quiet: Quiet = False,
    until: Until = None,
    draws: Draws = 400,
    trust_effects: Trust = False,
) -> None:
    """Run the unsteady model of an engine: tank, injector, grain, chamber, nozzle and flight."""
    with plain_exit():
        from hfanalysis.cli import engines
        from hfanalysis.effects import beside

        ask(beside(engine.absolute()).parent, trust_effects)
        engines.simulate(engine, out, as_json, quiet, until, draws)


HandOver = Annotated[
    Path | None,
    typer.Option("--hand-over", metavar="OUT.toml", help="Also write the solved engine, for hfa simulate; a new file."),
]
Flows = Annotated[list[str] | None, typer.Option("--flow", metavar='"2.5 kg/s"', help="Of the study; several.")]
Lengths = Annotated[list[str] | None, typer.Option("--length", metavar='"610 mm"', help="Of the study; several.")]
Pressures = Annotated[list[str] | None, typer.Option("--pressure", metavar='"400 psi"', help="Of the study; several.")]


def _design(
    engine: EngineToml,
    as_json: ProductJson = False,
    out: Folder = None,
    hand_over: HandOver = None,
    flow: Flows = None,
    length: Lengths = None,
    pressure: Pressures = None,
    draws: Draws = 200,
    quiet: Quiet = False,
) -> None:
    """Steady-state design of an engine; with --out also the parametric study and a .eng file."""
    with plain_exit():
        from hfanalysis.cli import engines

        study = {"flow": flow or [], "length": length or [], "pressure": pressure or []}
        engines.design(engine, out, as_json, quiet, study, hand_over, draws)


def _engine(
    test: Test,
    of: Annotated[
        str | None, typer.Option("--of", metavar="STAND", help="Constants and effects of this stand.")
    ] = None,
    flight: Annotated[
        bool, typer.Option("--flight", help="In its rocket: without what is of the stand alone.")
    ] = False,
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="Instead of ROOT/engines/TEST.toml.")] = None,
    root: Root = Path(),
    quiet: Quiet = False,
    trust_effects: Trust = False,
) -> None:
    """Write the engine file of a calibrated test, for simulate: geometry as stated, constants and effects as found."""
    with plain_exit():
        from hfanalysis.cli import engine_of

        test, root = named(test, root)
        ask(root, trust_effects)
        engine_of.engine(Request(test, root, None, False, False, quiet), of, flight, out)


def _predict(
    plan: Annotated[Path, typer.Argument(metavar="NEXT.toml", help="A test.toml without its log: as planned.")],
    tests: Annotated[list[str], typer.Option("--from", metavar="TEST", help="A fired test; again for every other.")],
    root: Root = Path(),
    temperature: Annotated[
        str | None, typer.Option(metavar="VALUE", help="The tank's on the day, as '18 degC': NEXT.day.json.")
    ] = None,
    draws: Annotated[int, typer.Option(min=20, help="Engines drawn.")] = 400,
    as_json: ProductJson = False,
    quiet: Quiet = False,
    trust_effects: Trust = False,
) -> None:
    """Freeze what a planned test will measure, with 90 % bands: predictions/NEXT.json, never written over."""
    with plain_exit():
        from hfanalysis.cli import predict

        ask(root, trust_effects)
        predict.predict(plan, tests, root, temperature, draws, as_json, quiet)


def _score(
    name: Annotated[str, typer.Argument(metavar="NEXT", help="Name of a prediction.")],
    test: Annotated[str | None, typer.Option(metavar="TEST", help="The fired test, if it has another name.")] = None,
    root: Root = Path(),
    as_json: ProductJson = False,
    quiet: Quiet = False,
    trust_effects: Trust = False,
) -> None:
    """Lay a fired test over its prediction: which bands hold, and the errors beside those of two rivals."""
    with plain_exit():
        from hfanalysis.cli import predict

        ask(root, trust_effects)
        predict.score(name, test, root, as_json, quiet)


def _next(
    engine: EngineToml,
    wanted: Annotated[
        str | None, typer.Option("--for", metavar="NAME", help="apogee, total_impulse, or a constant of [covariance].")
    ] = None,
    as_json: ProductJson = False,
    quiet: Quiet = False,
    trust_effects: Trust = False,
) -> None:
    """Rank what to test next by how far each test would narrow the apogee, the impulse or a constant."""
    with plain_exit():
        from hfanalysis.cli import engines
        from hfanalysis.effects import beside

        ask(beside(engine.absolute()).parent, trust_effects)
        engines.next_tests(engine, wanted, as_json, quiet)


OF_ENGINES: dict[str, Callable[..., None]] = {
    "simulate": _simulate,
    "design": _design,
    "engine": _engine,
    "next": _next,
    "predict": _predict,
    "score": _score,
}
"""By name; their first lines are the help."""
