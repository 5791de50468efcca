"""Notes of the day: what the team wrote, and its photos."""

from __future__ import annotations

import base64
from collections.abc import Iterator

from markupsafe import Markup

from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section

HEADING = "h3"
"""What a heading of the notes becomes: the page has its own above it."""


def render(material: Material) -> Iterator[Block]:
    """The text as it is marked up, and the photos below it."""
    if material.notes.text.strip():
        yield Markup('<div class="notes">{}</div>').format(_marked_up(material.notes.text))
    if material.notes.photos:
        yield Markup('<div class="photos">{}</div>').format(Markup().join(map(_photo, material.notes.photos)))


def _marked_up(text: str) -> Markup:
    """Markdown as HTML: what is HTML in it stands there as text, and nothing is loaded."""
    from markdown_it import MarkdownIt

    reader = MarkdownIt("js-default", {"html": False, "linkify": False}).disable("image")
    tokens = reader.parse(text)
    for token in tokens:
        if token.type in ("heading_open", "heading_close"):
            token.tag = HEADING
    return Markup(reader.renderer.render(tokens, reader.options, {}))


def _photo(photo: tuple[str, bytes]) -> Markup:
    name, jpeg = photo
    coded = base64.b64encode(jpeg).decode()
    picture = Markup(
        '<figure><img src="data:image/jpeg;base64,{}" alt="{}"><figcaption><bdi>{}</bdi></figcaption></figure>'
    )
    return picture.format(coded, name, name)


SECTION = Section("Notes of the day", 12, (), render, unasked=True)
