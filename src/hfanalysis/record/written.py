"""Tables written as TOML that reads back as they are."""

from __future__ import annotations

import json
import re
from collections.abc import Container, Iterator, Mapping
from typing import Any

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def table_lines(
    part: Mapping[str, Any],
    *names: str,
    inline: Container[str] = (),
    remarks: Mapping[tuple[str, ...], str] | None = None,
) -> Iterator[str]:
    """A table of TOML under its ``names``, and those within it; tables called as in ``inline`` stay on their line.

    ``remarks``: by the names down to a key, what is said behind it.
    """
    said = remarks or {}
    plain = {key: value for key, value in part.items() if not isinstance(value, Mapping) or key in inline}
    if names and (plain or not part):
        yield f"\n[{'.'.join(map(key_text, names))}]"
    for key, value in plain.items():
        remark = said.get((*names, key))
        yield f"{key_text(key)} = {value_text(value)}{f'   # {remark}' if remark else ''}"
    for key, value in part.items():
        if key not in plain:
            yield from table_lines(value, *names, key, inline=inline, remarks=remarks)


def key_text(name: str) -> str:
    """A key, in quotes where it needs them."""
    return name if _BARE.fullmatch(name) else _string(name)


def value_text(value: Any) -> str:
    """JSON's strings, numbers and lists are TOML's; a table within a line is not."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key_text(key)} = {value_text(part)}" for key, part in value.items()) + " }"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(value_text, value))}]"
    if hasattr(value, "isoformat"):
        return str(value.isoformat())
    return _string(value.item() if hasattr(value, "item") else value)


def _string(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
