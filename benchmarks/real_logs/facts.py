"""The facts of each log, and how they are put into its draft."""

from __future__ import annotations

import copy
import json
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

FACTS = Path(__file__).with_name("facts.toml")


@dataclass(frozen=True)
class Facts:
    """What is known about one log; ``hand``: quantity -> value, half width, unit; ``origin``: what its times count
    from.
    """

    name: str
    about: str
    format: str
    add: Mapping[str, Any] = field(default_factory=dict)
    hand: Mapping[str, tuple[float, float, str]] = field(default_factory=dict)
    origin: str = "run line"
    files: tuple[str, ...] = ()
    leave_out: tuple[str, ...] = ()
    copy: tuple[str, ...] = ()

    def logs(self, folder: Path) -> list[Path]:
        """The log files in the folder."""
        there = sorted(path for path in folder.iterdir() if path.is_file())
        named = [path for path in there if not self.files or path.name in self.files]
        return [path for path in named if path.name not in (*self.leave_out, *self.copy)]


def all_facts() -> list[Facts]:
    """The logs in the order of the file."""
    content = tomllib.loads(FACTS.read_text(encoding="utf-8"))
    stands = content.pop("stand")
    return [_facts(name, table, stands) for name, table in content.items()]


def _facts(name: str, table: Mapping[str, Any], stands: Mapping[str, Any]) -> Facts:
    add = copy.deepcopy(stands[table["stand"]]) if "stand" in table else {}
    _merge(add, table.get("add", {}))
    hand = dict(table.get("hand", {}))
    origin = hand.pop("from", "run line")
    lists = {key: tuple(table.get(key, ())) for key in ("files", "leave_out", "copy")}
    return Facts(name, table["about"], table["format"], add, {k: tuple(v) for k, v in hand.items()}, origin, **lists)


def _merge(into: dict[str, Any], more: Mapping[str, Any]) -> None:
    for key, value in more.items():
        if isinstance(value, Mapping) and isinstance(into.get(key), dict):
            _merge(into[key], value)
        else:
            into[key] = value


def completed(draft: str, facts: Facts) -> str:
    """A draft with the facts put in, as an engineer would: what is stated replaces what was guessed."""
    content = tomllib.loads(draft)
    stated = facts.add.get("channels", {})
    columns = [table["column"] for table in stated.values()]
    drafted = content["channels"]
    content["channels"] = {
        name: table
        for name, table in drafted.items()
        if name not in stated and table["column"] not in columns and ("unit" in table or name == "valve" or not stated)
    }
    for name, table in stated.items():
        content["channels"][name] = dict(table)
    _merge(content, {key: value for key, value in facts.add.items() if key != "channels"})
    return "\n".join(_written(content)) + "\n"


def _written(content: Mapping[str, Any], *above: str) -> Iterator[str]:
    """TOML: values first, then tables."""
    tables = {key: value for key, value in content.items() if isinstance(value, Mapping) and len(above) < 2}
    for key, value in content.items():
        if key not in tables:
            yield f"{json.dumps(key)} = {_value(value)}"
    for key, value in tables.items():
        yield f"\n[{'.'.join(json.dumps(part) for part in (*above, key))}]"
        yield from _written(value, *above, key)


def _value(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{json.dumps(key)} = {_value(one)}" for key, one in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    return json.dumps(value, ensure_ascii=False)
