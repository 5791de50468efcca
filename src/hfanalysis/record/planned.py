"""A test that is planned: a test.toml without its log."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator

from hfanalysis.errors import InputError
from hfanalysis.record.definition import Test, check_version
from hfanalysis.record.document import read_toml, validate
from hfanalysis.record.rocket import Rocket
from hfanalysis.record.schema import Section, section
from hfanalysis.record.sections import (
    Chamber,
    Feed,
    FuelSection,
    GrainSection,
    Injector,
    Model,
    NozzleSection,
    Purge,
    Site,
    StandSection,
    Tank,
)

FIRED = ("log", "channels", "observed", "segments", "exclude", "deviations")
"""Sections of a test.toml that there are after the firing alone."""


@section
class PlannedStatements(Section):
    """The whole of such a file; sections that are not stated are None."""

    test: Test
    schema: Annotated[int, BeforeValidator(check_version)]
    model: Model | None = None
    tank: Tank | None = None
    feed: Feed | None = None
    injector: Injector | None = None
    purge: Purge | None = None
    fuel: FuelSection | None = None
    grain: GrainSection | None = None
    chamber: Chamber | None = None
    nozzle: NozzleSection | None = None
    site: Site | None = None
    stand: StandSection | None = None
    rocket: Rocket | None = None


@dataclass(frozen=True, kw_only=True)
class PlannedTest(PlannedStatements):
    """A validated plan and where it is; every number in SI. ``content``: its own words, by section."""

    path: Path
    sha256: str
    content: dict[str, Any]


def load_planned(path: Path) -> PlannedTest:
    """The plan at ``path``, validated; raises :class:`InputError` naming file, key, found and expected."""
    raw, content = read_toml(path)
    if after := [name for name in FIRED if name in content]:
        raise InputError(f"{path}: found [{after[0]}]; expected a test that is still to be fired, without it")
    stated = validate(PlannedStatements, {"schema": None, **content}, path)
    return PlannedTest(**vars(stated), path=path, sha256=hashlib.sha256(raw).hexdigest(), content=content)
