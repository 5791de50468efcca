"""test.toml as data that can be mutated, and its text."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from typing import Any

from benchmarks.fuzz import formats
from benchmarks.fuzz.table import CHANNELS, REPOSITORY, UNITS

ID = "T"


def base(stand: str, format: str) -> dict[str, Any]:
    """What the replica's test.toml states, for a log of another format."""
    path = REPOSITORY / "raw_tests" / stand / "test.toml"
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    content["test"]["id"] = ID
    content["log"] = {
        "files": [file_of(format)],
        "time": {"column": formats.column("time", format), "unit": "s"},
    }
    for name, unit in zip(CHANNELS, UNITS, strict=True):
        content["channels"][name] |= {"column": formats.column(name, format), "unit": unit}
    return content


def file_of(format: str) -> str:
    """The log's file."""
    return f"log{formats.WRITERS[format][0]}"


def text(content: Mapping[str, Any]) -> str:
    """TOML of tables, numbers, text, truths and lists of them."""
    plain = [f"{_key(key)} = {value(item)}" for key, item in content.items() if not isinstance(item, Mapping)]
    tables = [line for key, item in content.items() if isinstance(item, Mapping) for line in _table((key,), item)]
    return "\n".join([*plain, *tables]) + "\n"


def _table(keys: tuple[str, ...], content: Mapping[str, Any]) -> list[str]:
    inner = [key for key, item in content.items() if isinstance(item, Mapping) and keys[0] in ("channels", "rocket")]
    lines = ["", f"[{'.'.join(map(_key, keys))}]"] if len(inner) < len(content) or not content else []
    lines += [f"{_key(key)} = {value(item)}" for key, item in content.items() if key not in inner]
    return lines + [line for key in inner for line in _table((*keys, key), content[key])]


def _key(key: str) -> str:
    return key if key.replace("_", "").isalnum() and key.isascii() else value(key)


def value(item: Any) -> str:
    """A value as TOML has it."""
    if isinstance(item, bool):
        return str(item).lower()
    if isinstance(item, str):
        escaped = "".join(c if c.isprintable() and c not in '"\\' else f"\\U{ord(c):08x}" for c in item)
        return f'"{escaped}"'
    if isinstance(item, Mapping):
        return "{ " + ", ".join(f"{_key(key)} = {value(one)}" for key, one in item.items()) + " }"
    if isinstance(item, list | tuple):
        return "[" + ", ".join(map(value, item)) + "]"
    return str(item)
