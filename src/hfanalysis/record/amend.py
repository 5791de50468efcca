"""Changes of a test.toml that leave everything else in it as it is written: comments, order, spelling."""

from __future__ import annotations

import json
import os
import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hfanalysis.errors import InputError
from hfanalysis.products import disk
from hfanalysis.record.definition import load_definition

_HEADER = re.compile(r"^\s*\[")


def amended(text: str, channel: str, lines: str) -> str:
    """A test.toml with lines put in: keys outside a table into ``[channels.CHANNEL]``, ``[[exclude]]`` at the end.

    Args:
        text: the file's content.
        channel: whose table keys without one belong to.
        lines: TOML, as a finding's cure has it.

    Raises:
        InputError: the file says it in a way that lines cannot be put into (an inline table of channels).
    """
    wanted = tomllib.loads(lines)
    expected = tomllib.loads(text)
    for key, value in wanted.items():
        if key == "channels":
            for name, keys in value.items():
                text = _with_keys(text, name, keys)
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            if all(table in expected.get(key, []) for table in value):
                continue
            text = text.rstrip("\n") + "\n\n" + _tables(lines)
        elif not isinstance(value, dict):
            text = _with_keys(text, channel, {key: value})
    if _plain(tomllib.loads(text)) != _plain(_merged(expected, channel, wanted)):
        raise InputError(f"cannot put {lines!r} in by itself; write it into [channels.{channel}] by hand")
    return text


def write(path: Path, text: str) -> None:
    """Write a test.toml whole or not at all; its content has to load as one.

    Raises InputError where it does not; the file is then as it was.
    """
    scratch = disk.temporary_path(path)
    try:
        scratch.write_text(text, encoding="utf-8")
        scratch.chmod(path.stat().st_mode & 0o7777)
        load_definition(scratch)
        disk.fsync(scratch)
        os.replace(scratch, path)
    except InputError as error:
        said = str(error).replace(str(scratch), str(path))
        raise InputError(f"{said}; nothing was written") from None
    finally:
        scratch.unlink(missing_ok=True)


def _with_keys(text: str, channel: str, keys: Mapping[str, Any]) -> str:
    """A channel's table with these keys, in place of those it has."""
    rows = text.split("\n")
    header = re.compile(rf"^\s*\[\s*channels\s*\.\s*(?:{re.escape(channel)}|\"{re.escape(channel)}\")\s*\]")
    start = next((i for i, row in enumerate(rows) if header.match(row)), None)
    if start is None:
        return text
    end = next((i for i in range(start + 1, len(rows)) if _HEADER.match(rows[i])), len(rows))
    for key, value in keys.items():
        line = f"{key} = {json.dumps(value, ensure_ascii=False)}"
        place = next((i for i in range(start + 1, end) if re.match(rf"^\s*{re.escape(key)}\s*=", rows[i])), None)
        if place is None:
            rows.insert(_last(rows, start, end) + 1, line)
            end += 1
        else:
            rows[place] = line + _comment(rows[place])
    return "\n".join(rows)


def _last(rows: Sequence[str], start: int, end: int) -> int:
    """The last row of a table that says something."""
    return max(i for i in range(start, end) if rows[i].strip() and (i == start or not rows[i].lstrip().startswith("#")))


def _comment(row: str) -> str:
    """The comment at the end of a row, where its value holds no sign of one."""
    value, mark, words = row.rpartition("#")
    return f"  {mark}{words}" if mark and value.count('"') % 2 == 0 and value.count("'") % 2 == 0 else ""


def _tables(lines: str) -> str:
    """The part of ``lines`` that begins with a table of its own."""
    rows = lines.split("\n")
    first = next(i for i, row in enumerate(rows) if _HEADER.match(row))
    return "\n".join(rows[first:]) + "\n"


def _merged(content: Mapping[str, Any], channel: str, wanted: Mapping[str, Any]) -> dict[str, Any]:
    """What the file should say then."""
    found = {**content, "channels": {name: dict(keys) for name, keys in content.get("channels", {}).items()}}
    for key, value in wanted.items():
        if key == "channels":
            for name, keys in value.items():
                found["channels"].setdefault(name, {}).update(keys)
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            there = found.get(key, [])
            found[key] = there if all(table in there for table in value) else [*there, *value]
        elif not isinstance(value, dict):
            found["channels"].setdefault(channel, {})[key] = value
    return found


def _plain(content: Mapping[str, Any]) -> str:
    return repr(sorted(content.items(), key=lambda item: item[0]))
