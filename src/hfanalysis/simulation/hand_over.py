"""A solved steady design as an engine file that ``hfa simulate`` runs at once."""

from __future__ import annotations

import copy
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hfanalysis.assembly import engine as build
from hfanalysis.drafting.document import plain
from hfanalysis.errors import InputError
from hfanalysis.products.disk import atomic
from hfanalysis.record.document import read_toml
from hfanalysis.record.engine_file import EngineFile, Needs, engine_of
from hfanalysis.record.written import table_lines
from hfanalysis.simulation import sized
from hfanalysis.simulation.steady_run import COMMAND, DesignRun
from hfanalysis.version import __version__

RUNS = "hfa simulate"

Solved = dict[tuple[str, str], Any]
"""What a design has found, by section and key."""


def refuse_taken(out: Path) -> None:
    """Raise InputError where there is something at ``out``: it is somebody's."""
    if out.exists() or out.is_symlink():
        raise InputError(f"--hand-over {out}: is there already; expected the name of a new file")


def write(out: Path, file: EngineFile, run: DesignRun) -> None:
    """The design ``run`` of an engine ``file``, written whole to ``out``.

    Raises InputError where there is a file, or where the engine file lacks what a simulation needs.
    """
    refuse_taken(out)
    words = text(file, run, out)
    with atomic(out) as scratch:
        scratch.write_text(words, encoding="utf-8")
        refuse_taken(out)


def text(file: EngineFile, run: DesignRun, out: Path) -> str:
    """What :func:`write` writes."""
    raw, content = read_toml(file.path)
    found = solved(file, run)
    old, new = file.path.parent.resolve(), out.parent.resolve()
    needs = Needs(engine_of(merged(content, found, old, old), file.path, raw), RUNS)
    tank = build.tank(needs)
    made = build.engine(needs, tank)  # complete, or refused with the key that lacks
    asked = sized.area(Needs(file, COMMAND), run.task.requirement)
    lines = (
        f"{plain(file.engine.id)}, solved by {COMMAND} of hfanalysis {__version__} from {plain(file.path.name)};",
        "marked is what was solved, the rest is that file's.",
        f"Injector: C_i N_i A_i = {asked:.4g} m^2 by the design, {made.feed.area:.4g} m^2 with whole holes.",
        f"Tank: {tank.volume * 1e3:.4g} L{f', {tank.size.length * 1e3:.4g} mm long' if tank.size else ''}.",
        "A burn of the same load falls short of a steady design: the tank cools, and vapor is left in it.",
    )
    tables = table_lines(merged(content, found, old, new), remarks=dict.fromkeys(found, "solved"))
    return "".join(f"# {line}\n" for line in lines) + "\n".join(tables) + "\n"


def solved(file: EngineFile, run: DesignRun) -> Solved:
    """Load, grain, nozzle and holes of a design, in the words of an engine file.

    Raises InputError where the injector cannot be had.
    """
    holes, engine = sized.holes(Needs(file, COMMAND), run.task.requirement), run.engine
    return {
        ("tank", "oxidizer_mass"): _said(engine.oxidizer_mass, "kg"),
        ("injector", "holes"): holes.count,
        ("injector", "hole_area"): _said(holes.area * 1e6, "mm^2"),
        ("grain", "mass"): _said(engine.fuel_mass, "kg"),
        ("nozzle", "throat_radius"): _said(engine.throat_radius * 1e3, "mm"),
        ("nozzle", "exit_radius"): _said(engine.exit_radius * 1e3, "mm"),
    }


def merged(content: Mapping[str, Any], found: Solved, old: Path, new: Path) -> dict[str, Any]:
    """The ``content`` of an engine file with what was ``found`` in its place; files that it names are looked for from
    the folder ``new`` instead of ``old``."""
    made = copy.deepcopy(dict(content))
    for (section, key), value in found.items():
        made.setdefault(section, {})[key] = value
    made["injector"].pop("hole_diameter", None)
    table = made.get("rocket", {}).get("drag_table")
    if table is not None and old != new:
        made["rocket"]["drag_table"] = Path(os.path.relpath(old / table, new)).as_posix()
    return made


def _said(value: float, unit: str) -> str:
    return f"{value:.9g} {unit}"
