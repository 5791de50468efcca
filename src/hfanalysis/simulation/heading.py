"""What every product made from an engine file says of its making."""

from __future__ import annotations

from typing import Any

from hfanalysis.assembly.engine import OxidizerEnthalpy
from hfanalysis.products import engines
from hfanalysis.products.disk import sha256_file
from hfanalysis.record.engine_file import EngineFile
from hfanalysis.record.sections import fuel_of
from hfanalysis.version import __version__


def heading(file: EngineFile, command: str, enthalpy: OxidizerEnthalpy) -> dict[str, Any]:
    """Which engine, by which command, under which conventions, with which oxidizer enthalpy [J/kg]."""
    return {
        "engine": file.engine.id,
        "command": command,
        "conventions": file.model.conventions,
        "properties": file.model.properties,
        "fuel": fuel_of(file.fuel).name,
        "oxidizer_enthalpy": engines.Enthalpy(value=enthalpy.value, unit="J/kg", std=None, ci95=None, of=enthalpy.of),
    }


def provenance(file: EngineFile) -> dict[str, Any]:
    """Package version, and the engine file and its rocket's drag table by name and SHA-256."""
    table = file.rocket.drag_table if file.rocket else None
    tables = {"drag_table": {table: sha256_file(file.path.parent / table)}} if table else {}
    return {"hfanalysis": __version__, "engine_toml": {file.path.name: file.sha256}, **tables}
