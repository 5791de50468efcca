"""Engines simulated and designed: an engine file, and what is to be different."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hfanalysis.errors import InputError
from hfanalysis.record.document import read_toml
from hfanalysis.record.engine_file import EngineFile, engine_of

if TYPE_CHECKING:
    import xarray as xr

    from hfanalysis.products.engines import Designed, NextTests

BETWEEN = "__"
"""Between a section and its key where a dot cannot be."""


def simulate(
    engine: str | Path | Mapping[str, Any], until: float | None = None, draws: int = 0, **changes: Any
) -> xr.Dataset:
    """The unsteady model of an engine: histories over ``time`` [s], and the numbers of ``hfa simulate`` as attributes.

    Args:
        engine: an engine file, or what it would state, by section.
        draws: engines drawn over what is stated with a +/-, for bands about the numbers (the command's: 400).
        until: how long to go on through vapor and cold gas [s]; else to burn-out.
        changes: what is stated otherwise, as ``injector__C_i=0.3`` or ``**{"tank.volume": "18 L"}``.

    Raises:
        InputError: the file is at fault, or lacks what the model needs.
    """
    from hfanalysis.simulation.unsteady_run import simulate as run
    from hfanalysis.simulation.write import histories

    found = run(_stated(engine, changes), until, draws)
    return _dataset(histories(found), found.product.to_json())


def design(engine: str | Path | Mapping[str, Any], draws: int = 0, **changes: Any) -> Designed:
    """The steady-state design of an engine, as ``hfa design`` has it; arguments as of :func:`simulate`."""
    from hfanalysis.simulation.steady_run import design as run

    return run(_stated(engine, changes), draws).product


def next_tests(engine: str | Path | Mapping[str, Any], wanted: str | None = None, **changes: Any) -> NextTests:
    """What to test next, as ``hfa next`` ranks it.

    Args:
        engine: an engine file with its [covariance], or what it would state, by section.
        wanted: what is to be narrowed: apogee, total_impulse, or a constant.
        changes: as of :func:`simulate`.

    Raises:
        InputError: the file is at fault, lacks what the model needs, or nothing of that name is in it.
    """
    from hfanalysis.simulation.next_test import next_tests as rank
    from hfanalysis.simulation.unsteady_run import effects_of

    file = _stated(engine, changes)
    return rank(file, effects_of(file), wanted)


def _stated(engine: str | Path | Mapping[str, Any], changes: Mapping[str, Any]) -> EngineFile:
    if isinstance(engine, Mapping):
        path, raw, content = Path("engine"), b"", copy.deepcopy(dict(engine))
    else:
        path = Path(engine)
        raw, content = read_toml(path)
    for name, value in changes.items():
        section, dot, key = name.replace(BETWEEN, ".").partition(".")
        if not dot:
            raise InputError(f"{name}: expected a section and its key, as {section}{BETWEEN}KEY")
        content[section] = {**content.get(section, {}), key: value}
    return engine_of(content, path, raw)


def _dataset(table: Mapping[str, Any], product: dict[str, Any]) -> xr.Dataset:
    """Columns "name [unit]" over the first of them."""
    import xarray as xr

    columns = {name.partition(" [")[0]: (name.partition(" [")[2].rstrip("]"), values) for name, values in table.items()}
    about = {name: {"units": unit, "long_name": name.replace("_", " ")} for name, (unit, _) in columns.items()}
    made = {name: ("time", values, about[name]) for name, (_, values) in columns.items()}
    time = made.pop("time")
    return xr.Dataset(made, coords={"time": time}, attrs={"title": f"engine {product['engine']}", "result": product})
