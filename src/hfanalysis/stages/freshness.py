"""What a stage's products were made from, and whether that is still so."""

from __future__ import annotations

import contextlib
import functools
import importlib.metadata
import inspect
import os
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from hfanalysis.errors import InputError
from hfanalysis.inference.adopted import adopted_file
from hfanalysis.products import disk as products
from hfanalysis.products.disk import HashCache
from hfanalysis.record.definition import TestDefinition
from hfanalysis.sources import closure, data, digest, libraries, remembered
from hfanalysis.stages import base, way_to
from hfanalysis.stages.base import Context, Stage
from hfanalysis.version import __version__

STATE = ".state"

_INSTALLED = ".dist-info"
"""How the name of a folder ends that an installed distribution is described in. Source: Python packaging, "Recording
installed projects": ``name-version.dist-info``."""


def modules(context: Context, stage: Stage) -> frozenset[Path]:
    """The sources that make a stage's products: what its module imports, directly or not.

    Those of the stages that it runs itself, too, a team's own effects with what they import, and what the stages before
    it say of themselves: what they do is in their products.
    """
    whole, said = _roots(context, stage)
    return closure(*whole) | closure(*said, inside=False)


def _roots(context: Context, stage: Stage) -> tuple[list[Path], list[Path]]:
    """Modules that count with all they import, and those that count with what compiled code of theirs can call."""
    own = [path for path in effect_files(context, stage) if path.suffix == ".py"]
    run = dict.fromkeys(name for last in stage.runs for name in way_to(last))
    whole = [_module(stage), *map(_module, map(base.load_stage, run)), *own]
    return whole, list(map(_module, map(base.load_stage, stage.upstream)))


def _module(stage: Stage) -> Path:
    return Path(inspect.getfile(stage.run)).resolve()


def made_by(context: Context, stage: Stage) -> tuple[str, list[str]]:
    """SHA-256 over the sources that make a stage's products and the data that lie beside them in the package, and the
    libraries that these sources import."""
    whole, said = _roots(context, stage)

    def found() -> tuple[str, list[str]]:
        files = modules(context, stage)
        return code_hash(files), libraries(files)

    code, names = remembered(f"stage {stage.name}", [*whole, *said], found)
    return code, names


def code_hash(files: frozenset[Path]) -> str:
    """SHA-256 over sources and the data that lie beside them in the package."""
    return digest(files | data(files))


def library_versions(names: Iterable[str]) -> dict[str, str]:
    """The versions of libraries by the names that they are imported by."""
    return {name: _version(name) for name in names}


@functools.cache
def _version(name: str) -> str:
    """That of the library imported by this name, be it of a distribution of another name."""
    known = _named_on_disk().get(name)
    if known is not None:
        return known
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return ", ".join(importlib.metadata.version(found) for found in _distributions().get(name, [])) or "none"


@functools.cache
def _named_on_disk() -> dict[str, str]:
    """Versions by distribution, as the names of their folders have them: their files take milliseconds to read."""
    found: dict[str, str] = {}
    for place in sys.path:
        with contextlib.suppress(OSError):
            names = [entry.removesuffix(_INSTALLED) for entry in os.listdir(place or ".") if entry.endswith(_INSTALLED)]
            for name, _, version in (entry.partition("-") for entry in names):
                found.setdefault(name, version)
    return found


@functools.cache
def _distributions() -> Mapping[str, list[str]]:
    return importlib.metadata.packages_distributions()


def _of_others(context: Context, stage: Stage, hashes: HashCache) -> dict[str, Any]:
    """The hashes of what is read of other tests; nothing of a stage that reads none."""
    found = {other.test.id: _of_test(other, hashes) for other in stage.others(context.at(stage))}
    return {"others": found} if found else {}


def _of_products_beside(context: Context, stage: Stage, hashes: HashCache) -> dict[str, Any]:
    """The hashes of finished products of other tests that are read; nothing of a stage that reads none."""
    found = {f"{path.parent.name}/{path.name}": hashes(path) for path in stage.beside(context.at(stage))}
    return {"beside": found} if found else {}


def _of_test(other: TestDefinition, hashes: HashCache) -> dict[str, str]:
    return {
        path.relative_to(other.folder).as_posix(): _raw_hash(path, hashes) for path in (other.path, *raw_files(other))
    }


def raw_files(definition: TestDefinition) -> list[Path]:
    """The files the test's results rest on, besides its ``test.toml``."""
    tables = [definition.rocket.drag_table] if definition.rocket and definition.rocket.drag_table else []
    return [definition.folder / name for name in [*(spec.file for spec in definition.log.files), *tables]]


def effect_files(context: Context, stage: Stage) -> list[Path]:
    """The file of adopted effects that applies to this test, and a team's own effects, where they may be in play."""
    found = adopted_file(context.root, context.definition) if stage.adopts else None
    own = sorted((context.root / "effects").glob("[!_]*.py")) if found is not None or stage.tries_effects else []
    return [*([] if found is None else [found]), *own]


def input_files(context: Context, stage: Stage) -> list[Path]:
    """Every file outside the product folder that the products are made from, but for the package's source."""
    return [context.definition.path, *raw_files(context.definition), *effect_files(context, stage)]


def edited(context: Context) -> bool:
    """Whether test.toml no longer is what was read: the products are of the one before."""
    try:
        return products.sha256_file(context.definition.path) != context.definition.sha256
    except OSError:
        return True


def provenance(context: Context, stage: Stage, hashes: HashCache) -> dict[str, Any]:
    """What ``stage``'s products would be made from if it ran now: the ``provenance`` block of a product."""
    code, names = made_by(context, stage)
    return {
        "hfanalysis": __version__,
        "code": code,
        "test_toml": context.definition.sha256,
        "raw": {
            path.relative_to(context.raw).as_posix(): _raw_hash(path, hashes) for path in raw_files(context.definition)
        },
        **_of_others(context, stage, hashes),
        **_of_products_beside(context, stage, hashes),
        "effects": {path.name: hashes(path) for path in effect_files(context, stage)},
        "libraries": library_versions(names),
        "parameters": context.at(stage).parameters(),
        "inputs": _upstream(context, stage, hashes),
    }


def _raw_hash(path: Path, hashes: HashCache) -> str:
    try:
        return hashes(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); expected a log file named in test.toml") from None


def _upstream(context: Context, stage: Stage, hashes: HashCache) -> dict[str, str]:
    """Upstream products by name with their hashes, or why a stage has none."""
    found: dict[str, str] = {}
    for name in stage.upstream:
        if name in context.absent:
            found[name] = f"absent: {context.absent[name]}"
        else:
            found |= {product: hashes(context.product(product)) for product in stage.reads(base.load_stage(name))}
    return found


def state_path(context: Context, stage: Stage) -> Path:
    """Where it is noted what the stage's products were made from."""
    return context.out / STATE / f"{stage.name}.json"


def recorded(context: Context, stage: Stage) -> dict[str, Any]:
    """The note of the last complete run of ``stage``; empty where there is none or it cannot be read."""
    try:
        note = products.read_json(state_path(context, stage))
    except (OSError, ValueError):
        return {}
    whole = isinstance(note, dict) and all(isinstance(note.get(key, {}), dict) for key in ("products", "parameters"))
    return note if whole else {}


def is_fresh(context: Context, stage: Stage, note: Mapping[str, Any], key: str, hashes: HashCache) -> bool:
    """Whether the products are there, as written, and made from what there is now."""
    if note.get("key") != key:
        return False
    if note.get("absent"):
        return True
    made = note.get("products", {})
    try:
        return all(hashes(path) == made.get(path.name) for path in map(context.product, stage.products))
    except OSError:
        return False
