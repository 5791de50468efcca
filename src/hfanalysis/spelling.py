"""What was probably meant: near misses of a misspelt name."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def close_to(name: str, known: Iterable[str], most: int = 3) -> list[str]:
    """Names among ``known`` that ``name`` may be a misspelling of, the nearest first; case does not count.

    >>> close_to("hf_5", ["HF4", "HF5", "MRT-HF2.6"])
    ['HF5', 'HF4']
    """
    by_fold = {item.casefold(): item for item in known}
    return [by_fold[hit] for hit in difflib.get_close_matches(name.casefold(), by_fold, n=most, cutoff=0.55)]


def near_misses(name: str, known: Iterable[str]) -> str:
    """The end of a message about an unknown name: what was probably meant, then everything there is.

    >>> near_misses("segmnet", ["ingest", "segment"])
    '; did you mean "segment"? There are: ingest, segment'
    """
    there = list(known)
    hits = " or ".join(f'"{hit}"' for hit in close_to(name, there))
    meant = f"; did you mean {hits}?" if hits else "."
    return f"{meant} There are: {', '.join(there) or 'none'}"
