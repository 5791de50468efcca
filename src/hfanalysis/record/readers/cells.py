"""Cells of text as numbers, a column at a time."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.readers.base import Text

if TYPE_CHECKING:
    import pyarrow as pa

NONE = r"(?i)^(nan|null|none|n/?a|#n/a|-nan|-+|\?+|inf|infinity|[+-]inf)?$"
"""Cells that say that there is no number, and are no text to be told of."""
_OTHER = {".": ",", ",": "."}
_WORDS = (("true", "false"), ("on", "off"), ("open", "closed"))
"""Words for one and zero."""


def numbers(cells: pa.Array[Any], decimal: str) -> Array:
    """The numbers (n,) of cells, NaN where one holds none; words for one and zero are those."""
    import pyarrow as pa
    import pyarrow.compute as pc

    text = pc.utf8_trim_whitespace(cells)
    mark, other = re.escape(decimal), re.escape(_OTHER[decimal])
    plain = rf"^[+-]?(\d+({mark}\d*)?|{mark}\d+)([eEdD][+-]?\d+)?$"
    grouped = rf"^[+-]?\d{{1,3}}({other}\d{{3}})+({mark}\d*)?$"
    spaced = pc.match_substring_regex(text, grouped)
    text = pc.if_else(spaced, pc.replace_substring(text, _OTHER[decimal], ""), text)
    text = pc.if_else(pc.match_substring_regex(text, plain), text, None)
    if decimal == ",":
        text = pc.replace_substring(text, ",", ".")
    text = pc.replace_substring_regex(pc.utf8_ltrim(text, "+"), "[dD]", "e")
    found = np.array(pc.cast(text, pa.float64()).to_numpy(zero_copy_only=False), dtype=np.float64)
    return _words(cells) if len(found) and not np.isfinite(found).any() else found


def _words(cells: pa.Array[Any]) -> Array:
    import pyarrow.compute as pc

    text = pc.utf8_lower(pc.utf8_trim_whitespace(cells))
    found = np.full(len(cells), np.nan)
    met = set(pc.unique(text).to_pylist()) - {None, ""}
    for one, zero in _WORDS:
        if met and met <= {one, zero}:
            for word, value in ((one, 1.0), (zero, 0.0)):
                found[pc.fill_null(pc.equal(text, word), False).to_numpy(zero_copy_only=False)] = value
    return found


def text_among(cells: pa.Array[Any], found: Array, lines: Any) -> Text | None:
    """What the cells without a number hold, where it is text; ``lines``: of each cell, in the file."""
    import pyarrow.compute as pc

    none = pc.fill_null(pc.match_substring_regex(pc.utf8_trim_whitespace(cells), NONE), True)
    bad = np.flatnonzero(np.isnan(found) & ~none.to_numpy(zero_copy_only=False))
    return Text(len(bad), int(lines[bad[0]]), str(cells[int(bad[0])])) if len(bad) else None
