"""What people call what has a name in code: channels and effects."""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from importlib.util import find_spec
from pkgutil import iter_modules

from hfanalysis.record.channels import LONG_NAMES
from hfanalysis.wording.plain import in_plain

CHANNELS = {name: words for name, words in LONG_NAMES.items() if "_" in name}


@functools.cache
def names() -> Mapping[str, str]:
    """Channels and effects of the library by their names, in the words of people; those whose name is a plain word need
    none."""
    from hfanalysis.effects import library  # start-up: its laws are compiled code

    effects = {name: effect.plain_name for name, effect in library().items() if effect.plain_name and "_" in name}
    return CHANNELS | effects


@functools.cache
def _of_effects() -> frozenset[str]:
    """Names that effects of the library have, none of which is loaded for it."""
    found = find_spec("hfanalysis.effects")
    places = found.submodule_search_locations if found is not None else None
    return frozenset(module.name for module in iter_modules(places))


def _asked(words: str) -> Mapping[str, str]:
    """The names that a text needs."""
    return names() if _of_effects() & set(re.findall(r"\w+", words)) else CHANNELS


def called(name: str) -> str:
    """One of them in words.

    >>> called("p_chamber"), called("some_channel")
    ('chamber pressure', 'some channel')
    """
    return _asked(name).get(name) or name.replace("_", " ")


def plain(words: str) -> str:
    """A text of a product as people read it."""
    return in_plain(words, _asked(words))
