"""Texts of products as people read them: code names in words, and one thought a sentence."""

from __future__ import annotations

import re
from collections.abc import Mapping

from hfanalysis.sentences import Text, quoted_in

MOST_WORDS = 25
"""Words of a sentence beyond which it is cut where a semicolon stands. Source: what plain English asks for (GOV.UK
content design: sentences of up to 25 words)."""

_KEPT = r"(?<![\w.\[\]/\"'`-]){}(?![\w\"'`]|\.\w|\s*=)"
"""A name that stands in a sentence, and is not part of a key, a path or a quotation."""

_END = re.compile(r"(?<=[.!?])\s+(?=[A-Z0-9])")


def in_plain(words: str, names: Mapping[str, str]) -> Text:
    """The text with every code name of ``names`` in words, and long sentences cut at their semicolons.

    Keys of test.toml and what stands in quotation marks stay as they are.

    >>> in_plain("p_run is late; see [channels.p_run]", {"p_run": "run line pressure"})
    'run line pressure is late; see [channels.p_run]'
    """
    said = str.__str__(words)
    if names:
        either = "|".join(map(re.escape, sorted(names, key=len, reverse=True)))
        said = re.sub(_KEPT.format(f"({either})"), lambda found: names[found[1]], said)
    return Text(" ".join(_cut(sentence) for sentence in sentences_of(said)), quoted_in([words]))


def sentences_of(words: str) -> list[str]:
    """The sentences of a text.

    >>> sentences_of("It burned. The mass was 8.35 kg.")
    ['It burned.', 'The mass was 8.35 kg.']
    """
    return _END.split(str.__str__(words))


def _cut(sentence: str) -> str:
    """A sentence of too many words in as many as it has parts between semicolons."""
    if len(sentence.split()) <= MOST_WORDS or "; " not in sentence:
        return sentence
    first, *rest = sentence.split("; ")
    return ". ".join([first, *(part[:1].upper() + part[1:] for part in rest)])
