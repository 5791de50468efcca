"""Engine files: an engine that is no test, in the words of test.toml; what a test would calibrate is given."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import BeforeValidator

from hfanalysis.errors import InputError
from hfanalysis.record.definition import check_version
from hfanalysis.record.document import place, read_toml, validate
from hfanalysis.record.rocket import Rocket
from hfanalysis.record.schema import Refused, Section, section
from hfanalysis.record.sections import (
    Chamber,
    CovarianceSection,
    DesignSection,
    EngineSection,
    Feed,
    FuelSection,
    GrainSection,
    Injector,
    Model,
    NozzleSection,
    Purge,
    Site,
    Tank,
)
from hfanalysis.record.unused import LOOSE_OF_ENGINES, OF_ENGINES, unused

T = TypeVar("T")

TANK_SIZES = ("volume", "length", "ullage")
"""The keys of [tank], one of which says how large it is."""


@section
class EngineStatements(Section):
    """The whole of an engine file; sections that are not stated have no key.

    ``effects``: by name, their parameters as files of adopted effects have them, [effects.tank_heat].
    """

    engine: EngineSection
    schema: Annotated[int, BeforeValidator(check_version)]
    model: Model = Model()
    tank: Tank = Tank()
    feed: Feed = Feed()
    injector: Injector = Injector()
    purge: Purge | None = None
    fuel: FuelSection | None = None
    grain: GrainSection = GrainSection()
    chamber: Chamber = Chamber()
    nozzle: NozzleSection = NozzleSection()
    site: Site = Site()
    rocket: Rocket | None = None
    design: DesignSection = DesignSection()
    effects: dict[str, dict[str, Any]] = field(default_factory=dict)
    covariance: CovarianceSection | None = None

    def check(self) -> None:
        given = [key for key in TANK_SIZES if getattr(self.tank, key) is not None]
        if len(given) > 1:
            raise Refused(f"both {given[0]!r} and {given[1]!r} are given; expected one of them", "tank")


@dataclass(frozen=True, kw_only=True)
class EngineFile(EngineStatements):
    """A validated engine file and where it is; every number in SI."""

    path: Path
    sha256: str
    warnings: tuple[str, ...] = ()

    def where(self, *keys: str) -> str:
        """A place in this file, for messages."""
        return place(str(self.path), *keys)


def load_engine(path: Path) -> EngineFile:
    """The engine file at ``path``, validated; raises :class:`InputError` naming file, key, found and expected."""
    raw, content = read_toml(path)
    return engine_of(content, path, raw)


def engine_of(content: Mapping[str, Any], path: Path, raw: bytes) -> EngineFile:
    """The same of what such a file states, by section; ``raw`` [bytes] of the file at ``path`` that it came from."""
    stated = validate(EngineStatements, {"schema": None, **content}, path)
    idle = unused(stated, OF_ENGINES, lambda name: name not in LOOSE_OF_ENGINES, str(path))
    return EngineFile(**vars(stated), path=path, sha256=hashlib.sha256(raw).hexdigest(), warnings=idle)


@dataclass(frozen=True)
class Needs:
    """What a command needs of an engine file: a missing key is refused with the name of both."""

    file: EngineFile
    command: str

    def value(self, found: T | None, section: str, key: str) -> T:
        """``found``, the value of a key; raises :class:`InputError` where it is not given."""
        if found is None:
            table = self.file.where(section)
            raise InputError(f"{table}: key {key!r} is missing; {self.command} needs it")
        return found
