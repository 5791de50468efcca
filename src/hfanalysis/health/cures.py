"""Lines of test.toml that cure a finding; those outside a table belong to ``[channels.NAME]`` of its channel."""

from __future__ import annotations

import json
from collections.abc import Sequence

FINEST = 6
"""Decimals of an instant [s] that is written into test.toml: microseconds. Source: definition."""


def setting(key: str, value: str | float | bool | Sequence[float]) -> str:
    """A key of the channel.

    >>> setting("gauge", True), setting("scale", 2.0), setting("missing", [999.0])
    ('gauge = true', 'scale = 2.0', 'missing = [999.0]')
    """
    return f"{key} = {json.dumps(value, ensure_ascii=False)}"


def exclude(channels: Sequence[str], start: float, end: float) -> str:
    """A stretch [s, log time] of some channels that is not to be used.

    >>> print(exclude(["thrust"], 4583.1, 4590.0))
    [[exclude]]
    channels = ["thrust"]
    start = "4583.1 s"
    end = "4590 s"
    """
    return "\n".join(["[[exclude]]", f"channels = {json.dumps(list(channels))}", *_times(start, end)])


def _times(start: float, end: float) -> list[str]:
    return [f'{name} = "{_plain(time)} s"' for name, time in (("start", start), ("end", end))]


def _plain(time: float) -> str:
    text = f"{time:.{FINEST}f}"
    return text.rstrip("0").rstrip(".")
