"""What people call what has a name in code: channels and effects."""

from __future__ import annotations

import functools
from collections.abc import Mapping

from hfanalysis.effects import library
from hfanalysis.record.channels import LONG_NAMES
from hfanalysis.wording.plain import in_plain


@functools.cache
def names() -> Mapping[str, str]:
    """Channels and effects of the library by their names, in the words of people; those whose name is a plain word need
    none."""
    effects = {name: effect.plain_name for name, effect in library().items() if effect.plain_name}
    return {name: words for name, words in {**LONG_NAMES, **effects}.items() if "_" in name}


def called(name: str) -> str:
    """One of them in words.

    >>> called("p_chamber"), called("some_channel")
    ('chamber pressure', 'some channel')
    """
    return names().get(name) or name.replace("_", " ")


def plain(words: str) -> str:
    """A text of a product as people read it."""
    return in_plain(words, names())
