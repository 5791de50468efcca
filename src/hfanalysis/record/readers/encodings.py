"""The bytes of a text file as whole lines of UTF-8, whatever they are written in."""

from __future__ import annotations

import codecs
from collections.abc import Iterable, Iterator
from pathlib import Path

SAMPLE = 1 << 18
"""Bytes looked at at the beginning of a file [B]. Evidence: headers of some hundred lines fit."""
FURTHER = 1 << 16
"""Bytes looked at in its middle and at its end [B]. Evidence: test_number_marks.py: a mark between thousands may first
come when the engine burns."""
NULS_OF_UTF16 = 0.25
"""Share of zero bytes from which a text is written in two bytes a character. Evidence: test_dirt.py: half of the bytes
of a log in UTF-16 are zero; a lost block or a mark of two bytes by chance has few of them."""
_BOMS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))


def encoding_of(sample: bytes) -> str:
    """The encoding of a text that begins like this."""
    wide = sample[:2000].count(0) > NULS_OF_UTF16 * len(sample[:2000])
    for mark, name in _BOMS:
        if sample.startswith(mark) and (wide or name == "utf-8-sig"):
            return name
    if wide:
        return "utf-16-le" if sample[1:2000:2].count(0) > sample[0:2000:2].count(0) else "utf-16-be"
    try:
        sample[: sample.rfind(b"\n") + 1].decode("utf-8")
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"


def in_utf8(blocks: Iterable[bytes], encoding: str) -> Iterator[bytes]:
    """The blocks in UTF-8, without a mark at the beginning; what is no text stays as it is in UTF-8."""
    if encoding.replace("_", "-").lower() in ("utf-8", "ascii"):
        yield from blocks
        return
    for text in codecs.iterdecode(blocks, encoding, errors="replace"):
        yield text.encode()


def whole_lines(blocks: Iterable[bytes]) -> Iterator[bytes]:
    """The blocks cut at the ends of lines, LF or else CR; only the last may lack one, and has whole lines above it."""
    ready, rest = b"", b""
    for block in blocks:
        whole = rest + block if rest else block
        end = whole.rfind(b"\n") + 1 or _after_lone_return(whole)
        if end and ready:
            yield ready
        ready, rest = (whole[:end] if end < len(whole) else whole, whole[end:]) if end else (ready, whole)
    if ready or rest:
        yield ready + rest if rest else ready


def _after_lone_return(text: bytes) -> int:
    """The place behind the last CR that something follows: at the very end the LF may be still to come."""
    return text.rfind(b"\r", 0, -1) + 1


def samples(path: Path, encoding: str) -> list[str]:
    """Text from the beginning, the middle and the end of a file, each without the lines that it cuts."""
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(SAMPLE)
        parts = [head.decode(encoding, errors="replace").removeprefix("\ufeff")]
        for place in sorted({max(SAMPLE, size // 2), max(SAMPLE, size - FURTHER)}) if size > SAMPLE else ():
            file.seek(place - place % 4)
            parts.append(file.read(FURTHER).decode(_no_mark(encoding, head), errors="replace"))
    if size > SAMPLE:
        parts[0] = _up_to_last_line(parts[0])
    return [parts[0], *(_up_to_last_line(_from_next_line(part)) for part in parts[1:])]


def _no_mark(encoding: str, head: bytes) -> str:
    """The encoding of a part that does not begin with the file's mark."""
    if encoding == "utf-16":
        return "utf-16-be" if head.startswith(codecs.BOM_UTF16_BE) else "utf-16-le"
    return encoding


def _up_to_last_line(text: str) -> str:
    return text[: max(text.rfind("\n"), text.rfind("\r"), 0)] or text


def _from_next_line(text: str) -> str:
    ends = [place for mark in "\r\n" if (place := text.find(mark)) >= 0]
    return text[min(ends) + 1 :] if ends else ""
