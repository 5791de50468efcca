"""Effects that the report's model lacks: one file each, found by its name. See docs/effects.md for adding one."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from functools import lru_cache
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType

from hfanalysis.effects import trust
from hfanalysis.effects.learnt import is_learnt, with_learnt
from hfanalysis.engine.effect import Effect
from hfanalysis.errors import InputError

FOLDER = "effects"
"""Folder below the root of the tests in which a team keeps effects of its own."""

_NO_EFFECTS = ("learnt", "trust")


def library(folder: Path | None = None) -> dict[str, Effect]:
    """Every effect by its name, in the order of names: those that come along, and those of the files in ``folder``.

    Files whose names begin with an underscore are no effects. Raises InputError for a folder that nobody has agreed to
    run, for a file that does not hold an effect of its name, or that takes the name of one that comes along.
    """
    if folder is None or not folder.is_dir():
        return dict(_built_in())
    trust.check(folder)
    found = {**_built_in()}
    for path in trust.files(folder):
        if path.stem in _built_in():
            raise InputError(f"{path}: an effect called {path.stem!r} is there already; expected a name of its own")
        found[path.stem] = _from_file(path.resolve(), path.stat().st_mtime_ns)
    return dict(sorted(found.items()))


def beside(engine_file: Path) -> Path:
    """The folder of a team's own effects that an engine file may name: below the root that ``engines/`` is in, or else
    beside the file.

    >>> beside(Path("stand/engines/HF6.toml")).as_posix(), beside(Path("HF6.toml")).as_posix()
    ('stand/effects', 'effects')
    """
    folder = engine_file.parent
    return (folder.parent if folder.name == "engines" else folder) / FOLDER


def library_of(engine_file: Path, names: Iterable[str]) -> dict[str, Effect]:
    """The effects among which an engine file may name some, also as tables of what no name explains; a team's own only
    where ``names`` ask for one.

    Raises as :func:`library`: code that nobody asks for needs nobody to agree to it.
    """
    names = list(names)
    own = any(name not in _built_in() and not is_learnt(name) for name in names)
    return with_learnt(library(beside(engine_file.absolute())) if own else library(), names)


def effect(name: str, folder: Path | None = None) -> Effect:
    """One effect; ValueError, with those there are, for an unknown name."""
    there = library(folder)
    if name not in there:
        raise ValueError(f"no effect is called {name!r}; there are {', '.join(there)}")
    return there[name]


@lru_cache(maxsize=1)
def _built_in() -> dict[str, Effect]:
    names = sorted(m.name for m in iter_modules(__path__) if m.name not in _NO_EFFECTS)
    return {name: _named(import_module(f"{__name__}.{name}"), name, f"{name}.py") for name in names}


@lru_cache(maxsize=256)
def _from_file(path: Path, changed: int) -> Effect:
    """The effect in a file outside the package; ``changed`` is when it was last written."""
    name = f"{__name__}.of_team.{path.stem}"
    spec = spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        raise InputError(f"{path}: cannot be loaded ({type(error).__name__}: {error})") from error
    return _named(module, path.stem, str(path))


def _named(module: ModuleType, name: str, where: str) -> Effect:
    found = getattr(module, "EFFECT", None)
    if not isinstance(found, Effect):
        raise InputError(f"{where}: found no EFFECT; expected one of hfanalysis.engine.effect.Effect")
    if found.name != name:
        raise InputError(f"{where}: the effect in it calls itself {found.name!r}; expected {name!r}, as the file")
    return found
