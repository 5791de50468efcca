"""test.toml: what an engineer knows about a test, validated before anything runs."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator

from hfanalysis.errors import InputError
from hfanalysis.record.channels import CANONICAL
from hfanalysis.record.default_deviations import Deviations, Stated
from hfanalysis.record.document import place, read_toml, validate
from hfanalysis.record.logspec import Channels, ChannelSpec, Exclusion, FileSpec, LogSpec, TimeSpec
from hfanalysis.record.rocket import Rocket
from hfanalysis.record.schema import (
    Date,
    Instant,
    ListOf,
    Name,
    Refused,
    Section,
    Text,
    changed,
    section,
    unknown_key,
    unsafe,
)
from hfanalysis.record.sections import (
    Chamber,
    Feed,
    FuelSection,
    GrainSection,
    Injector,
    Model,
    NozzleSection,
    ObservedSection,
    Purge,
    Site,
    StandSection,
    Tank,
)
from hfanalysis.record.unused import OF_TESTS, SPREADS_OF_FITS, SPREADS_OF_TESTS, for_fits_alone, unused
from hfanalysis.units import Value, near

__all__ = ["ChannelSpec", "Exclusion", "FileSpec", "LogSpec", "TestDefinition", "TimeSpec", "Value", "find_definition",
           "load_definition"]  # fmt: skip

SCHEMA = 1
"""Version of test.toml's form that this package reads. Source: definition."""
STANDARD_PRESSURE = Value(101325.0, 2000.0)
"""[Pa] where neither altitude nor ambient pressure is stated: sea level, give or take weather and terrain. Source:
standard atmosphere (ISO 2533), 101325 Pa at sea level."""
WEATHER = 1000.0
"""[Pa] standard deviation of the ambient pressure about the altitude's mean. Source: weather changes the pressure at
sea level by some 10 hPa from day to day at middle latitudes."""


def check_version(found: Any) -> int:
    """The version of the file's form, which has to be the one this package reads."""
    if found != SCHEMA:
        raise ValueError(f"schema = {SCHEMA} at the top of the file")
    return SCHEMA


@section
class Test(Section):
    """[test]: which test this is."""

    id: Name
    kind: Literal["hot_fire", "cold_flow", "water_flow"]
    date: Date | None = None
    source: Literal["measured", "replica", "synthetic"] = "measured"
    description: Text = ""
    stand: Name | None = None
    engine: Text = ""


_EVENTS = ("t_open", "t_feed", "t_v", "t_purge", "t_fuel_out", "t_fuel_gone", "t_end")


def _known_events(found: dict[str, Value]) -> dict[str, Value]:
    for name, time in found.items():
        if name not in _EVENTS:
            raise unknown_key(name, _EVENTS)
        if name != "t_open" and time.value <= 0.0:
            raise Refused(f"found {time.value:g} s; expected a time after the opening, that is more than zero", name)
    return found


Segments = Annotated[dict[str, Instant], AfterValidator(_known_events)]


@section
class Statements(Section):
    """The whole of test.toml; sections that are not stated are None.

    ``segments``: times of events set by the engineer [s]; ``t_open`` in log time, the others after it.
    """

    test: Test
    log: LogSpec
    channels: Channels
    schema: Annotated[int, BeforeValidator(check_version)] = SCHEMA
    model: Model = Model()
    tank: Tank | None = None
    injector: Injector | None = None
    feed: Feed | None = None
    purge: Purge | None = None
    fuel: FuelSection | None = None
    grain: GrainSection | None = None
    chamber: Chamber | None = None
    nozzle: NozzleSection | None = None
    site: Site | None = None
    stand: StandSection | None = None
    observed: ObservedSection | None = None
    deviations: Deviations = Deviations()
    rocket: Rocket | None = None
    segments: Segments = field(default_factory=dict)
    exclude: ListOf[Exclusion] = ()

    def check(self) -> None:
        files = [spec.file for spec in self.log.files]
        for name, channel in self.channels.items():
            if channel.file is not None and channel.file not in files:
                offer = near(channel.file, files) or f"; expected one of {', '.join(files)}"
                raise Refused(f"{channel.file!r} is not in log.files{offer}", "channels", name, "file")
        for i, exclusion in enumerate(self.exclude):
            exclusion.check_channels(self.channels, "exclude", i)
        self._check_left()
        if self.tank is not None and self.tank.nitrogen_pressure is not None:
            words = "is of an engine file; a test's log tells the pressure of its tank, and whether it is supercharged"
            raise Refused(words, "tank", "nitrogen_pressure")
        if self.feed is not None and self.feed.p_loss is not None:
            raise Refused("a test has K_loss here, which a log may bear out; not a constant loss", "feed", "p_loss")

    def _check_left(self) -> None:
        """No more can be left after a test than there was before it."""
        for key, part, loaded in (
            ("fuel_mass_after", "[grain] mass", self.grain.mass if self.grain else None),
            ("oxidizer_mass_after", "[tank] oxidizer_mass", self.tank.oxidizer_mass if self.tank else None),
        ):
            left = getattr(self.observed, key, None)
            if left is not None and loaded is not None and left.value > loaded.value:
                raise Refused(
                    f"found {left.value:.4g} kg; expected no more than the {loaded.value:.4g} kg of {part}",
                    "observed",
                    key,
                )


@dataclass(frozen=True, kw_only=True)
class TestDefinition(Statements, Stated):
    """A validated test.toml and where it is; every number in SI."""

    path: Path
    sha256: str
    warnings: tuple[str, ...] = ()

    @property
    def folder(self) -> Path:
        """The test's folder, which holds its log files."""
        return self.path.parent

    @property
    def ambient_pressure(self) -> Value:
        """[Pa] as stated, else from the altitude, else of sea level."""
        if self.site is not None and self.site.ambient_pressure is not None:
            return self.site.ambient_pressure
        if self.site is None or self.site.altitude is None:
            return STANDARD_PRESSURE
        from hfanalysis.thermo.atmosphere import pressure

        return Value(float(pressure(self.site.altitude.value)), WEATHER)


def find_definition(root: Path, test_id: str) -> Path:
    """The path of a test's test.toml under ``root``/raw_tests.

    Raises :class:`InputError` where the name is not one of a folder there, or the folder has no test.toml.
    """
    if not test_id or unsafe(test_id):
        raise InputError(f"test {test_id!r}: expected the name of a folder in raw_tests, without path separators")
    tests = root / "raw_tests"
    path = tests / test_id / "test.toml"
    if not path.is_file():
        raise InputError(_no_definition(tests, path))
    return path


def _no_definition(tests: Path, path: Path) -> str:
    if path.parent.is_dir():
        return f"{path}: not found; expected the test's definition there beside its log"
    names = sorted(p.parent.name for p in tests.glob("*/test.toml"))
    known = f"; expected one of {', '.join(names)}" if names else f"; {tests} holds no test (hfa demo writes two)"
    return f"test {path.parent.name!r}: no such folder in {tests}{near(path.parent.name, names) or known}"


def load_definition(path: Path) -> TestDefinition:
    """The test.toml at ``path``, validated; raises :class:`InputError` naming file, key, found and expected."""
    raw, content = read_toml(path)
    stated = _with_fuel_left(validate(Statements, {"schema": None, **content}, path), path)
    idle = unused(stated, OF_TESTS, (SPREADS_OF_TESTS | SPREADS_OF_FITS).__contains__, "test.toml")
    idle = (*idle, *for_fits_alone(stated, "test.toml"))
    digest, warnings = hashlib.sha256(raw).hexdigest(), (*_odd_names(stated.channels), *idle)
    definition = TestDefinition(**vars(stated), path=path, sha256=digest, warnings=warnings)
    _check_folder(definition)
    return definition


def _with_fuel_left(stated: Statements, path: Path) -> Statements:
    """With the fuel that a measured port leaves in its place, where that is what was measured after the test."""
    radius, grain = getattr(stated.observed, "port_radius_after", None), stated.grain
    if radius is None or stated.observed is None:
        return stated
    where = place(str(path), "observed", "port_radius_after")
    if stated.observed.fuel_mass_after is not None:
        raise InputError(f"{where}: found fuel_mass_after as well; expected one of them: each tells the other")
    if grain is None or grain.length is None or grain.density is None or grain.outer_radius is None:
        raise InputError(f"{where}: expected [grain] length, density and outer_radius beside it")
    around = pi * grain.density.value * grain.length.value
    left = around * (grain.outer_radius.value**2 - radius.value**2)
    if left < 0.0 or (grain.mass is not None and left > grain.mass.value):
        raise InputError(
            f"{where}: found {1e3 * radius.value:.4g} mm; expected one from the port's to the grain's radius"
        )
    std = None if radius.std is None else 2.0 * around * radius.value * radius.std
    return changed(stated, observed=changed(stated.observed, fuel_mass_after=Value(left, std)))


def _odd_names(channels: Mapping[str, ChannelSpec]) -> tuple[str, ...]:
    """A channel under its own name that looks like a misspelled canonical one is worth a word, not a refusal."""
    absent = [name for name in CANONICAL if name not in channels]
    offers = {name: near(name, absent) for name in channels if name not in CANONICAL}
    return tuple(f"channel {name!r} is carried through under its own name{o}" for name, o in offers.items() if o)


def _check_folder(definition: TestDefinition) -> None:
    """What the definition says about its folder: the test's name and the files in it."""
    folder, file = definition.path.resolve().parent, str(definition.path)
    stated = definition.test.id
    if stated != folder.name:
        raise InputError(
            f"{place(file, 'test', 'id')}: found {stated!r}; expected {folder.name!r}, the name of the test's folder"
        )
    for spec in definition.log.files:
        _inside(spec.file, folder, place(file, "log", "files"))
    if definition.rocket is not None and definition.rocket.drag_table is not None:
        _inside(definition.rocket.drag_table, folder, place(file, "rocket", "drag_table"))


def _inside(name: str, folder: Path, where: str) -> None:
    """The file must be there, and within the test's own folder."""
    try:
        path = (folder / name).resolve()
        own, there = path.is_relative_to(folder) and path != folder, path.is_file()
    except (OSError, ValueError):  # a name that no file can have
        own = there = False
    if not own:
        raise InputError(f"{where}: found {name[:80]!r}; expected a file inside the test's own folder")
    if not there:
        others = [str(p.relative_to(folder)) for p in sorted(folder.rglob("*")) if p.is_file()]
        offer = near(name, others) or f"; the folder holds {', '.join(others)}"
        raise InputError(f"{where}: {name!r} is not in the test's folder{offer}")
