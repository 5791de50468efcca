"""What a team wrote and photographed on the day: ``raw_tests/ID/notes.md`` and the pictures beside it."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path

from hfanalysis.errors import InputError

FILE = "notes.md"
PICTURES = (".jpg", ".jpeg", ".png", ".webp")

MOST_BYTES = 1_000_000
"""Of all photos together, as the page has them [B]. Source: a page has to pass through a phone."""

MOST_TEXT = 200_000
"""Of the text [B]: a note is no log."""

SIDE, SMALLEST_SIDE = 1280, 160
"""Longer side of a photo on the page at most, and where the pictures are too many for that, at least [px]."""

QUALITY = 80
"""Of a JPEG, of 100."""


def files_of(folder: Path) -> list[Path]:
    """The notes of a test's folder, and its pictures by name; those that are there."""
    notes = folder / FILE
    pictures = (path for path in folder.iterdir() if path.suffix.lower() in PICTURES and path.is_file())
    return [*([notes] if notes.is_file() else []), *sorted(pictures)]


def read_notes(folder: Path) -> tuple[str, tuple[tuple[str, bytes], ...]]:
    """The text, and the name and JPEG of every picture, without what a camera writes beside it (place, time, device).

    Raises InputError for a text that is not UTF-8 or too long, and for a picture that is none.
    """
    found = files_of(folder)
    pictures = [path for path in found if path.name != FILE]
    return _text(folder / FILE) if folder / FILE in found else "", tuple(_small(pictures))


def _text(path: Path) -> str:
    raw = path.read_bytes()
    if len(raw) > MOST_TEXT:
        raise InputError(f"{path}: found {len(raw)} bytes; expected a note of {MOST_TEXT} at most")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: byte {error.start} is not UTF-8; expected text in UTF-8") from None


def _small(pictures: list[Path]) -> Iterator[tuple[str, bytes]]:
    """Every picture as a JPEG of its share of MOST_BYTES."""
    for path in pictures:
        yield path.name, _jpeg(path, MOST_BYTES // len(pictures))


def _jpeg(path: Path, most: int) -> bytes:
    from PIL import Image, ImageOps

    try:
        with Image.open(path) as opened:
            upright = ImageOps.exif_transpose(opened).convert("RGB")
    except (OSError, ValueError, Image.DecompressionBombError, SyntaxError) as error:
        raise InputError(f"{path}: cannot be read as a picture ({error}); expected JPEG, PNG or WebP") from None
    side = SIDE
    while True:
        upright.thumbnail((side, side))
        out = io.BytesIO()
        upright.save(out, "JPEG", quality=QUALITY)
        if out.tell() <= most or side <= SMALLEST_SIDE:
            return out.getvalue()
        side = side * 3 // 4
