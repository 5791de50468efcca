"""Texts of products as people read them: code names in words, and one thought a sentence."""

from __future__ import annotations

import re
from collections.abc import Mapping

from hfanalysis.sentences import Text, quoted_in

MOST_WORDS = 25
"""Words of a sentence beyond which it is cut into parts. Source: what plain English asks for (GOV.UK
content design: sentences of up to 25 words)."""

LEAST_WORDS = 4
"""Words of a part from which on it is a sentence of its own: what is shorter is the head of what follows. Source: what
"m: unphysical: ..." and "channel thrust: ..." are."""

_KEPT = r"(?<![\w.\[\]/\"'`-]){}(?![\w\"'`]|\.\w|\s*=)"
"""A name that stands in a sentence, and is not part of a key, a path or a quotation."""

_END = re.compile(r"(?<=[.!?])\s+(?=[A-Z0-9+−\[]|[a-z][*_ ])")
"""Where a sentence ends; the next may begin with a symbol in small letters."""

_CUTS = ("; ", ": ", ", and ", ", but ")
"""Where a long sentence is cut, the first first."""


def in_plain(words: str, names: Mapping[str, str]) -> Text:
    """The text with every code name of ``names`` in words, and long sentences cut where they may be.

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


def _cut(sentence: str, cuts: tuple[str, ...] = _CUTS) -> str:
    """A sentence of too many words in as many as it has parts; what stands in brackets stays whole.

    >>> _cut("one " * 20 + "(a; b); p_c " + "two " * 10)[-60:]
    'one one (a; b). p_c two two two two two two two two two two '
    """
    if len(sentence.split()) <= MOST_WORDS or not cuts:
        return sentence
    parts = _split(sentence, cuts[0])
    told = [parts[0], *(_begun(part, cuts[0]) for part in parts[1:])]
    return ". ".join(_cut(part, cuts[1:]) for part in told)


def _split(sentence: str, cut: str) -> list[str]:
    """The parts between cuts that stand outside of brackets."""
    out = [""]
    for piece in re.split(f"({re.escape(cut)})", sentence):
        inside = out[-1].count("(") + out[-1].count("[") > out[-1].count(")") + out[-1].count("]")
        if piece == cut and not inside and len(out[-1].split()) >= LEAST_WORDS:
            out.append("")
        else:
            out[-1] += piece
    return out


def _begun(part: str, cut: str) -> str:
    """A part as a sentence begins; symbols keep their small letters."""
    word = part.split(" ", 1)[0]
    said = part[:1].upper() + part[1:] if len(word) > 1 and word.isalpha() else part
    return f"But {part}" if cut == ", but " else said
