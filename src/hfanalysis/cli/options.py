"""Arguments and options that several commands have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def tests_of(ctx: typer.Context, incomplete: str) -> list[str]:
    """Names of the tests under ROOT/raw_tests/ that begin so, for a shell that completes them."""
    raw = Path(ctx.params.get("root") or ".") / "raw_tests"
    names = (path.parent.name for path in raw.glob("*/test.toml"))
    return sorted(name for name in names if name.startswith(incomplete))


Test = Annotated[
    str,
    typer.Argument(metavar="TEST", help="Name of the test, or its folder: raw_tests/TEST.", autocompletion=tests_of),
]
Root = Annotated[Path, typer.Option(help="Folder that holds raw_tests/ and processed/.", show_default="here")]
Out = Annotated[Path | None, typer.Option(help="Write products to OUT/TEST/ instead of ROOT/processed/TEST/.")]
Json = Annotated[bool, typer.Option("--json", help="Print the stage's JSON product on standard output, nothing else.")]
ProductJson = Annotated[bool, typer.Option("--json", help="Print the JSON product on standard output, nothing else.")]
Force = Annotated[bool, typer.Option("--force", help="Redo the stage and all before it, even if nothing changed.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No table and no progress; warnings still show.")]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="STAGE.NAME=VALUE", help="Set a parameter of a stage; help lists them."),
]
Firing = Annotated[
    int | None,
    typer.Option("--firing", min=1, metavar="N", help="Take this firing of the log; products go to TEST.firing-N/."),
]
Trust = Annotated[bool, typer.Option("--trust-effects", help="Run the code in ROOT/effects/, until it changes.")]
Pdf = Annotated[bool, typer.Option("--pdf", help="Also print the page to PDF; needs Chromium or Chrome.")]
