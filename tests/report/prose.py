"""What of a page is prose: the texts that people read, sentence by sentence, without code, tables of values and
charts."""

from __future__ import annotations

import re
from html.parser import HTMLParser

from hfanalysis.wording.numbers import EVENTS
from hfanalysis.wording.plain import sentences_of

BLOCKS = {"p", "li", "dd", "dt", "td", "th", "caption", "figcaption", "h1", "h2", "h3", "summary", "div", "ul", "dl",
          "table", "section", "header", "footer", "nav", "figure", "details", "tr", "br"}  # fmt: skip
SILENT = {"script", "style", "title", "svg", "code", "head", "bdi"}
VOID = {"meta", "link", "br", "img", "hr", "input", "path", "rect", "circle"}

CODE = re.compile(r"\b(?:[a-z][a-z0-9]*_[a-z0-9_]+)\b")
"""A name in small letters with an underscore."""

SYMBOLS = {"p_c", "p_a", *EVENTS}
"""Of the field, or of the table of phases, which says what each means."""


class Prose(HTMLParser):
    """The texts of a page by block, and where each is: in a fold that is closed as the page opens, or not."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[tuple[str, dict[str, str | None]]] = []
        self.blocks: list[str] = []
        self.words = self.figures = 0
        self.piece = ""
        self.feed(text)
        self._end()

    @property
    def folded(self) -> bool:
        """Whether what comes now is hidden as the page opens."""
        for place, (tag, attrs) in enumerate(self.open):
            summary = place + 1 < len(self.open) and self.open[place + 1][0] == "summary"
            if tag == "details" and "open" not in attrs and not summary:
                return True
        return False

    def _inside(self, tags: set[str]) -> bool:
        return any(tag in tags for tag, _ in self.open)

    def _end(self) -> None:
        if text := " ".join(self.piece.split()):
            self.blocks.append(text)
        self.piece = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag in BLOCKS:
            self._end()
        self.figures += tag == "figure" and not self.folded
        if tag not in VOID:
            self.open.append((tag, dict(attrs)))

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        pass

    def handle_endtag(self, tag: str) -> None:
        if tag in BLOCKS:
            self._end()
        while tag not in VOID and self.open and self.open.pop()[0] != tag:
            pass

    def handle_data(self, data: str) -> None:
        if self._inside(SILENT):
            return
        self.piece += data
        if not self.folded and not self._inside({"figure"}):
            self.words += len(data.split())

    @property
    def sentences(self) -> list[str]:
        """All of them, folded or not."""
        return [sentence for block in self.blocks for sentence in sentences_of(block)]

    @property
    def long(self) -> list[str]:
        """Those of more words than plain English has."""
        return [sentence for sentence in self.sentences if words_of(sentence) > 25]

    @property
    def code_names(self) -> set[str]:
        """Names of code that stand in it."""
        return {name for block in self.blocks for name in CODE.findall(block)} - SYMBOLS


def words_of(sentence: str) -> int:
    """Words of a sentence: numbers with their units and signs count, single signs do not."""
    return sum(any(sign.isalnum() for sign in word) for word in sentence.split())
