"""Why channels are doubted: each reason once, in the same words wherever it stands, and numbered.

A number that rests on such a channel holds the words of its reasons; who shows many such numbers marks each with the
number of its reason, and says the reason once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hfanalysis.products.health import HEALTHY, KINDS, TRUSTED, UNUSABLE, ChannelHealth, Finding
from hfanalysis.quantity import Quantity
from hfanalysis.sentences import Text, text


@dataclass(frozen=True)
class Doubt:
    """Something found of channels; ``trust``: why the engineer overrules it."""

    finding: Finding
    channels: tuple[str, ...]
    trust: str | None = None

    @property
    def words(self) -> Text:
        """Whose, what, and its evidence: as it stands beside a number."""
        kind = self.finding.kind.replace("_", " ")
        return text(
            "{names}{trusted} ({kind}{left}): {evidence}",
            names=", ".join(self.channels),
            trusted=f"{TRUSTED}{self.trust}) against" if self.trust else "",
            kind=kind,
            left=", left out" if self.finding.verdict == UNUSABLE and not self.trust else "",
            evidence=self.finding.evidence,
        )

    @property
    def sentence(self) -> Text:
        """The same with its verdict, from when to when, and what it means."""
        verdict = self.finding.verdict
        return text(
            "channel{s} {whose}: {verdict} ({kind}{when}): {evidence}: {means}",
            s="s" if len(self.channels) > 1 else "",
            whose=", ".join(self.channels),
            verdict=f"trusted by the engineer ({self.trust}), would be {verdict}" if self.trust else verdict,
            kind=KINDS.get(self.finding.kind, self.finding.kind),
            when=_when(self.finding),
            evidence=self.finding.evidence,
            means=self.finding.means,
        )


def _when(finding: Finding) -> str:
    if finding.whole:
        return ""
    start, end = finding.span
    ends = [
        f"from {start:.2f}" if finding.start is not None else "",
        f"to {end:.2f}" if finding.end is not None else "",
    ]
    return f", {' '.join(filter(None, ends))} s of log time"


def reasons(channels: Mapping[str, ChannelHealth]) -> list[Doubt]:
    """Every reason that makes channels worse than healthy, or would if nobody trusted them.

    Channels that the same is said of stand in one, unless one of them is trusted and another is not.
    """
    whose: dict[tuple[str | None, str, str, tuple[float, float]], Doubt] = {}
    for name, channel in channels.items():
        for finding in channel.findings:
            if finding.verdict != HEALTHY:
                key = (channel.trust, finding.kind, finding.evidence, finding.span)
                before = whose[key].channels if key in whose else ()
                whose[key] = Doubt(finding, (*before, name), channel.trust)
    return list(whose.values())


def marked(quantity: Quantity, known: Sequence[Doubt]) -> tuple[list[int], Text]:
    """Which of the ``known`` reasons a quantity holds, counted from 1, and what else is said of it."""
    rest = quantity.why or quantity.reason or Text("")
    quoted = rest.quoted if isinstance(rest, Text) else {}
    numbers = [number for number, doubt in enumerate(known, 1) if doubt.words in rest]
    for number in numbers:
        words = str.__str__(known[number - 1].words)
        for part in (f"{words}; ", f"; {words}", words):
            rest = str.__str__(rest).replace(part, "")
    return numbers, Text(rest, quoted)
