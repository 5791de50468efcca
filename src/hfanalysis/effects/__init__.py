"""Effects that the report's model lacks: one file each, found by its name. See docs/effects.md for adding one."""

from __future__ import annotations

from functools import lru_cache
from importlib import import_module
from pkgutil import iter_modules

from hfanalysis.engine.effect import Effect


@lru_cache(maxsize=1)
def library() -> dict[str, Effect]:
    """Every effect of this folder by its name, in the order of names."""
    found = {}
    for module in sorted(m.name for m in iter_modules(__path__) if not m.name.startswith("_")):
        effect = import_module(f"{__name__}.{module}").EFFECT
        if effect.name != module:
            raise ValueError(f"the effect in {module}.py calls itself {effect.name!r}")
        found[effect.name] = effect
    return found


def effect(name: str) -> Effect:
    """One effect; ValueError, with those there are, for an unknown name."""
    if name not in library():
        raise ValueError(f"no effect is called {name!r}; there are {', '.join(library())}")
    return library()[name]
