"""MATLAB's format 5 as plain values, every length checked against what is there: a damaged file is an error.

Source: MathWorks, "MAT-File Format", version 5. (scipy's reader brings the process down on some damaged files.)
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

HEADER, TAG = 128, 8
"""Bytes of the file's header and of an element's tag [B]. Source: as above."""
MATRIX, COMPRESSED = 14, 15
"""Types of elements. Source: as above."""
NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8", 16: "u1"}
"""numpy's word for each type of number. Source: as above."""
CELL, STRUCT, OBJECT, CHAR, SPARSE, FUNCTION, OPAQUE = 1, 2, 3, 4, 5, 16, 17
"""Classes of arrays. Source: as above."""
COMPLEX = 0x0800
"""Bit of an array that has imaginary parts. Source: as above."""
DEEPEST = 32
"""Arrays within arrays. Evidence: nobody names a channel so deep."""
LARGEST = 1 << 31
"""Bytes of a variable unpacked [B]. Evidence: a log of an hour of 20 channels at 1 kHz has a quarter."""


class Damaged(Exception):
    """The file does not hold what it says."""


@dataclass(frozen=True)
class Struct:
    """An array of structs: its fields, and the values of each element by field, columns first."""

    fields: tuple[str, ...]
    elements: tuple[dict[str, Any], ...]


@dataclass(frozen=True)
class Opaque:
    """A value of a class that only MATLAB reads."""

    kind: str


def variables(content: bytes) -> Iterator[tuple[str, Any]]:
    """Names and values: arrays (n, k) of numbers or of values (cells), text, :class:`Struct` or :class:`Opaque`.

    Raises :class:`Damaged` where lengths do not fit, or what is packed cannot be unpacked.
    """
    order = {b"IM": "<", b"MI": ">"}.get(content[126:HEADER])
    if order is None:
        raise Damaged("its header does not say how numbers are written")
    data = _Data(content, order, HEADER)
    while data.at + TAG <= len(content):
        kind, body = data.element()
        if kind == COMPRESSED:
            kind, body = _Data(_unpacked(body), order).element()
        if kind == MATRIX and body:
            name, value = _array(_Data(body, order), 0)
            if name:
                yield name, value


def _unpacked(body: bytes) -> bytes:
    unpacking = zlib.decompressobj()
    try:
        found = unpacking.decompress(body, LARGEST)
    except zlib.error as error:
        raise Damaged(str(error)) from None
    if unpacking.unconsumed_tail:
        raise Damaged("a variable is larger than any log")
    return found


@dataclass
class _Data:
    """Elements one after the other."""

    content: bytes
    order: str
    at: int = 0

    def element(self) -> tuple[int, bytes]:
        """Type and bytes of the next element."""
        head = self.content[self.at : self.at + TAG]
        if len(head) < TAG:
            raise Damaged("it ends in the middle of a variable")
        kind, size = struct.unpack(f"{self.order}II", head)
        if kind >> 16:
            size, kind = kind >> 16, kind & 0xFFFF
            self.at += TAG
            return kind, head[4 : 4 + min(size, 4)]
        start = self.at + TAG
        self.at = start + size + (-size % 8 if kind != COMPRESSED else 0)
        if start + size > len(self.content):
            raise Damaged("it ends in the middle of a variable")
        return kind, self.content[start : start + size]

    def numbers(self) -> Any:
        """The next element's numbers."""
        kind, body = self.element()
        if kind not in NUMBERS or len(body) % np.dtype(NUMBERS[kind]).itemsize:
            raise Damaged(f"found an element of type {kind} where numbers belong")
        return np.frombuffer(body, dtype=np.dtype(self.order + NUMBERS[kind]))

    def text(self) -> str:
        """The next element's bytes as text."""
        return self.element()[1].rstrip(b"\0").decode("latin-1")


def _array(data: _Data, depth: int) -> tuple[str, Any]:
    """Name and value of an array."""
    if depth > DEEPEST:
        raise Damaged("arrays within arrays without end")
    flags = data.numbers()
    kind = int(flags[0]) & 0xFF if len(flags) else 0
    if kind == OPAQUE:
        name, _, own = data.text(), data.text(), data.text()
        return name, Opaque(own)
    shape = tuple(int(length) for length in data.numbers())
    name = data.text()
    if len(shape) < 2 or min(shape) < 0:
        raise Damaged(f"variable {name!r} has a shape of {shape}")
    if kind == CELL:
        return name, _cells(data, shape, depth)
    if kind in (STRUCT, OBJECT):
        return name, Opaque(data.text()) if kind == OBJECT else _structs(data, shape, depth)
    if kind in (SPARSE, FUNCTION):
        return name, None
    if kind == CHAR:
        return name, _characters(data)
    return name, _of_shape(data.numbers(), shape, name)


def _characters(data: _Data) -> str:
    kind, body = data.element()
    form = {17: "utf-16", 4: "utf-16", 18: "utf-32"}.get(kind)
    if form is None:
        return body.decode("utf-8", errors="replace")
    return body.decode(form + ("-le" if data.order == "<" else "-be"), errors="replace")


def _count(shape: tuple[int, ...]) -> int:
    count = 1
    for length in shape:
        count *= length
    return count


def _of_shape(flat: Any, shape: tuple[int, ...], name: str) -> Any:
    if len(flat) != _count(shape):
        raise Damaged(f"variable {name!r} has {len(flat)} numbers for a shape of {shape}")
    return flat.astype(flat.dtype.newbyteorder("=")).reshape(shape, order="F")


def _inner(data: _Data, depth: int) -> Any:
    kind, body = data.element()
    if kind != MATRIX:
        raise Damaged(f"found an element of type {kind} where an array belongs")
    return _array(_Data(body, data.order), depth + 1)[1] if body else np.empty((0, 0))


def _enough(data: _Data, count: int) -> None:
    """Each array has a tag at least."""
    if count * TAG > len(data.content) - data.at:
        raise Damaged(f"{count} arrays cannot be in {len(data.content) - data.at} bytes")


def _cells(data: _Data, shape: tuple[int, ...], depth: int) -> Any:
    count = _count(shape)
    _enough(data, count)
    found = np.empty(count, dtype=object)
    for i in range(count):
        found[i] = _inner(data, depth)
    return found.reshape(shape, order="F")


def _structs(data: _Data, shape: tuple[int, ...], depth: int) -> Struct:
    lengths = data.numbers()
    length, names = int(lengths[0]) if len(lengths) else 0, data.element()[1]
    if length < 1 and names:
        raise Damaged("a struct's fields have no names")
    fields = tuple(
        names[i : i + length].partition(b"\0")[0].decode("latin-1") for i in range(0, len(names), max(length, 1))
    )
    count = _count(shape)
    _enough(data, count * len(fields))
    if not fields and count > 1:
        count = 0
    return Struct(fields, tuple({field: _inner(data, depth) for field in fields} for _ in range(count)))
