"""A TOML file read into a validated section, or one plain message: file, dotted key, found, expected, near misses."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Hashable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar, cast

from pydantic import TypeAdapter, ValidationError
from pydantic_core import ErrorDetails

from hfanalysis.errors import InputError
from hfanalysis.record.schema import Refused
from hfanalysis.units import near

T = TypeVar("T")

_EXPECTED = {
    "bool_type": "true or false",
    "dataclass_type": "a table of keys",
    "dict_type": "a table of keys",
    "finite_number": "a finite number without quotes or unit",
    "float_type": "a finite number without quotes or unit",
    "greater_than": "a number that is more than zero",
    "greater_than_equal": "a number of at least {ge:g}",
    "int_type": "a whole number",
    "less_than_equal": "a number of at most {le:g}",
    "string_pattern_mismatch": "text in quotes",
    "string_type": "text in quotes",
    "too_short": "a list in square brackets with at least one entry",
    "tuple_type": "a list in square brackets with at least one entry",
    "value_error": "{error}",
}
"""What pydantic's errors mean to whoever wrote the file."""


def read_toml(path: Path) -> tuple[bytes, dict[str, Any]]:
    """The bytes of a TOML file, and its content."""
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); expected a TOML file there") from None
    try:
        return raw, tomllib.loads(raw.decode("utf-8-sig").replace("\r\n", "\n"))
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: byte {error.start} is not UTF-8; expected TOML text in UTF-8") from None
    except (ValueError, RecursionError) as error:
        raise InputError(f'{path}: not valid TOML: {error}; expected lines such as key = "value"') from None


def validate(section: type[T], content: Mapping[str, Any], path: Path) -> T:
    """The content of the file at ``path`` as a section; raises :class:`InputError` for the first fault in it."""
    try:
        return cast(T, _adapter(cast(Hashable, section)).validate_python(content))
    except ValidationError as error:
        raise InputError(_message(error, str(path))) from None


@lru_cache(maxsize=32)
def _adapter(section: Any) -> TypeAdapter[Any]:
    """What reads a section: made once, for making it takes fifty times as long as reading."""
    return TypeAdapter(section)


def place(file: str, *keys: str | int) -> str:
    """A place in a TOML file, for messages: ``file, rocket.geometry.nose`` or ``file, exclude[0].start``."""
    dotted = "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in keys).removeprefix(".")
    return f"{file}, {dotted}" if dotted else file


def _message(error: ValidationError, file: str, *above: str | int) -> str:
    """The first fault in words; a section made again inside a validator brings an error of its own."""
    first = error.errors(include_url=False)[0]
    keys = (*above, *first["loc"])
    cause = first.get("ctx", {}).get("error")
    if isinstance(cause, ValidationError):
        return _message(cause, file, *keys)
    if isinstance(cause, Refused):
        return f"{place(file, *keys, *cause.keys)}: {cause}"
    if first["type"] == "missing":
        what = f"key {keys[-1]!r}" if keys[:-1] else f"section [{keys[-1]}]"
        return f"{place(file, *keys[:-1])}: {what} is missing; expected it in this {'table' if keys[:-1] else 'file'}"
    return f"{place(file, *keys)}: found {first['input']!r}; expected {_expected(first)}"


def _expected(error: ErrorDetails) -> str:
    context = error.get("ctx", {})
    if error["type"] == "literal_error":
        return str(context["expected"]) + near(str(error["input"]), re.findall("'(.*?)'", context["expected"]))
    if error["type"] in _EXPECTED:
        return _EXPECTED[error["type"]].format(**context)
    return f"something else: {error['msg']}"
