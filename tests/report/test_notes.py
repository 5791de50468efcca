"""Notes and photos of the day on the page."""

from __future__ import annotations

import base64
import io
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests.report.sample import material

from hfanalysis.errors import InputError
from hfanalysis.record.team_notes import MOST_BYTES, files_of, read_notes
from hfanalysis.report.material import Notes
from hfanalysis.report.page import page

TURNED = 6
"""EXIF's orientation of a picture whose right side is up."""


def photo(path: Path, size: tuple[int, int] = (400, 200)) -> None:
    """A picture of noise, which nothing makes small, taken on its side, with a place in it."""
    noise = np.random.default_rng(1).integers(0, 255, (size[1], size[0], 3), dtype=np.uint8)
    exif = Image.Exif()
    exif[0x0112] = TURNED
    exif[0x010F] = "a camera with a name"
    exif.get_ifd(0x8825)[1] = "N"
    Image.fromarray(noise).save(path, exif=exif)


def test_photos_are_upright_and_say_nothing_of_who_took_them(tmp_path: Path) -> None:
    photo(tmp_path / "stand.jpg")
    ((name, jpeg),) = read_notes(tmp_path)[1]
    shown = Image.open(io.BytesIO(jpeg))
    assert (name, shown.size) == ("stand.jpg", (200, 400))
    assert not shown.getexif()
    assert b"camera" not in jpeg


def test_all_photos_together_are_small(tmp_path: Path) -> None:
    for i in range(5):
        photo(tmp_path / f"{i}.png", (1600, 1200))
    assert 0 < sum(len(jpeg) for _, jpeg in read_notes(tmp_path)[1]) <= MOST_BYTES


def test_what_is_neither_text_nor_picture_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "a.jpg").write_bytes(b"not a picture")
    with pytest.raises(InputError, match=r"a\.jpg: cannot be read as a picture"):
        read_notes(tmp_path)
    (tmp_path / "a.jpg").unlink()
    (tmp_path / "notes.md").write_bytes(b"caf\xe9")
    with pytest.raises(InputError, match=r"notes\.md: byte 3 is not UTF-8"):
        read_notes(tmp_path)


def test_only_what_lies_beside_the_test_counts(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("t")
    assert files_of(tmp_path) == []
    (tmp_path / "notes.md").write_text("wind from the west")
    assert [path.name for path in files_of(tmp_path)] == ["notes.md"]


def test_notes_stand_on_the_page_and_neither_run_nor_load_anything(tmp_path: Path) -> None:
    made = material(tmp_path)
    assert "Notes of the day" not in page(made)
    text = "# Wind\n\n**gusts** of 8 m/s\n\n<script>alert(1)</script>\n\n![x](https://example.org/x.png)\n\n[y](javascript:z)"
    found = page(replace(made, notes=Notes(text, (("a.jpg", b"1"),))))
    assert "<h3>Wind</h3>" in found
    assert "<strong>gusts</strong>" in found
    assert "<script>alert" not in found
    assert 'src="https' not in found
    assert 'href="javascript' not in found
    assert re.findall(r'<img src="(.*?)"', found) == [f"data:image/jpeg;base64,{base64.b64encode(b'1').decode()}"]
