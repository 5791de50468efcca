"""test.toml: what an engineer knows about a test, validated before anything runs."""

# ruff: noqa: RUF009  (key() makes dataclass fields, not defaults)
from __future__ import annotations

import datetime
import hashlib
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hfanalysis.errors import InputError
from hfanalysis.testdata import logspec
from hfanalysis.testdata.channels import CANONICAL
from hfanalysis.testdata.logspec import ChannelSpec, Exclusion, FileSpec, LogSpec, TimeSpec
from hfanalysis.testdata.rocket import Rocket
from hfanalysis.testdata.schema import POSITIVE, Where, build, key, one_of, quantity, section, text
from hfanalysis.testdata.sections import Chamber, Grain, Injector, Model, Nozzle, Observed, Purge, Site, Tank
from hfanalysis.units import Value, near

__all__ = ["ChannelSpec", "Exclusion", "FileSpec", "LogSpec", "TestDefinition", "TimeSpec", "Value", "find_definition",
           "load_definition"]  # fmt: skip

SCHEMA = 1
STANDARD_PRESSURE = Value(101325.0, 2000.0)
"""[Pa] where neither altitude nor ambient pressure is stated: sea level, give or take weather and terrain."""
WEATHER = 1000.0
"""[Pa] standard deviation of the ambient pressure about the altitude's mean."""


def _date(found: Any, where: Where) -> datetime.date:
    if isinstance(found, datetime.datetime):
        return found.date()
    if isinstance(found, str):
        try:
            return datetime.date.fromisoformat(found)
        except ValueError:
            raise where.wrong(found, "a date such as 2022-04-03") from None
    if not isinstance(found, datetime.date):
        raise where.wrong(found, "a date such as 2022-04-03")
    return found


def _id(found: Any, where: Where) -> str:
    name = text(found, where)
    if _unsafe(name):
        raise where.wrong(found, "the name of the test's folder, without path separators")
    return name


def _unsafe(name: str) -> bool:
    return any(mark in name for mark in "/\\\0") or name in (".", "..") or name != name.strip()


@dataclass(frozen=True)
class Test:
    """[test]: which test this is."""

    __test__ = False

    id: str = key(_id)
    kind: str = key(one_of("hot_fire", "cold_flow"))
    date: datetime.date | None = key(_date, None)
    source: str = key(one_of("measured", "replica", "synthetic"), "measured")
    description: str = key(text, "")
    stand: str | None = key(text, None)


_AFTER = quantity("time", POSITIVE)


@dataclass(frozen=True)
class Segments:
    """[segments]: set by the engineer [s]; ``t_open`` in log time, the others after it."""

    t_open: Value | None = key(quantity("time"), None)
    t_feed: Value | None = key(_AFTER, None)
    t_v: Value | None = key(_AFTER, None)
    t_purge: Value | None = key(_AFTER, None)
    t_fuel_out: Value | None = key(_AFTER, None)
    t_end: Value | None = key(_AFTER, None)


def _segments(found: Any, where: Where) -> dict[str, Value]:
    stated = build(Segments, found, where)
    return {name: value for name, value in vars(stated).items() if value is not None}


@dataclass(frozen=True)
class TestDefinition:
    """A validated test.toml; every number in SI. Sections that are not stated are None."""

    __test__ = False

    path: Path
    sha256: str
    test: Test
    log: LogSpec
    channels: dict[str, ChannelSpec]
    model: Model = field(default_factory=Model)
    tank: Tank | None = None
    injector: Injector | None = None
    purge: Purge | None = None
    grain: Grain | None = None
    chamber: Chamber | None = None
    nozzle: Nozzle | None = None
    site: Site | None = None
    observed: Observed | None = None
    rocket: Rocket | None = None
    segments: dict[str, Value] = field(default_factory=dict)
    exclude: tuple[Exclusion, ...] = ()
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


_SECTIONS: dict[str, Callable[[Any, Where], Any]] = {
    "test": section(Test),
    "model": section(Model),
    "log": section(LogSpec),
    "channels": logspec.channels,
    "tank": section(Tank),
    "injector": section(Injector),
    "purge": section(Purge),
    "grain": section(Grain),
    "chamber": section(Chamber),
    "nozzle": section(Nozzle),
    "site": section(Site),
    "observed": section(Observed),
    "rocket": section(Rocket),
    "segments": _segments,
}


def find_definition(root: Path, test_id: str) -> Path:
    """The path of a test's test.toml under ``root``/raw_tests.

    Raises :class:`InputError` where the name is not one of a folder there, or the folder has no test.toml.
    """
    if not test_id or _unsafe(test_id):
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
    known = f"; expected one of {', '.join(names)}" if names else f"; {tests} holds no test"
    return f"test {path.parent.name!r}: no such folder in {tests}{near(path.parent.name, names) or known}"


def load_definition(path: Path) -> TestDefinition:
    """The test.toml at ``path``, validated; raises :class:`InputError` naming file, key, found and expected."""
    raw, content = _read(path)
    where = Where(str(path))
    _known_sections(content, where)
    if content.get("schema") != SCHEMA:
        raise (where / "schema").wrong(content.get("schema"), f"schema = {SCHEMA} at the top of the file")
    made = {name: read(content[name], where / name) for name, read in _SECTIONS.items() if name in content}
    if "exclude" in content:
        made["exclude"] = logspec.exclusions(content["exclude"], where / "exclude", made["channels"])
    definition = TestDefinition(path, hashlib.sha256(raw).hexdigest(), warnings=_odd_names(made["channels"]), **made)
    _check_folder(definition, where)
    return definition


def _read(path: Path) -> tuple[bytes, dict[str, Any]]:
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); expected the test's definition there") from None
    try:
        return raw, tomllib.loads(raw.decode("utf-8-sig").replace("\r\n", "\n"))
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: byte {error.start} is not UTF-8; expected TOML text in UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise InputError(f'{path}: not valid TOML: {error}; expected lines such as key = "value"') from None


def _known_sections(content: Mapping[str, Any], where: Where) -> None:
    known = ("schema", *_SECTIONS, "exclude")
    for name in content:
        if name not in known:
            offer = near(name, known) or f"; expected some of {', '.join(known)}"
            raise InputError(f"{where}: unknown section or key {name!r}{offer}")
    for name in ("test", "log", "channels"):
        if name not in content:
            raise InputError(f"{where}: section [{name}] is missing; expected [test], [log] and [channels.*]")


def _odd_names(channels: Mapping[str, ChannelSpec]) -> tuple[str, ...]:
    """A channel under its own name that looks like a misspelt canonical one is worth a word, not a refusal."""
    absent = [name for name in CANONICAL if name not in channels]
    offers = {name: near(name, absent) for name in channels if name not in CANONICAL}
    return tuple(f"channel {name!r} is carried through under its own name{o}" for name, o in offers.items() if o)


def _check_folder(definition: TestDefinition, where: Where) -> None:
    """What the definition says about its folder: the test's name and the files in it."""
    folder = definition.path.resolve().parent
    if definition.test.id != folder.name:
        raise (where / "test.id").wrong(definition.test.id, f"{folder.name!r}, the name of the test's folder")
    for spec in definition.log.files:
        _inside(spec.file, folder, where / "log.files")
    files = [spec.file for spec in definition.log.files]
    for name, channel in definition.channels.items():
        if channel.file is not None and channel.file not in files:
            offer = near(channel.file, files) or f"; expected one of {', '.join(files)}"
            raise InputError(f"{where}, channels.{name}.file: {channel.file!r} is not in log.files{offer}")
    if definition.rocket is not None and definition.rocket.drag_table is not None:
        _inside(definition.rocket.drag_table, folder, where / "rocket.drag_table")


def _inside(name: str, folder: Path, where: Where) -> None:
    """The file must be there, and within the test's own folder."""
    path = (folder / name).resolve()
    if not path.is_relative_to(folder) or path == folder:
        raise where.wrong(name, "a file inside the test's own folder")
    if not path.is_file():
        others = [str(p.relative_to(folder)) for p in sorted(folder.rglob("*")) if p.is_file()]
        offer = near(name, others) or f"; the folder holds {', '.join(others)}"
        raise InputError(f"{where}: {name!r} is not in the test's folder{offer}")
