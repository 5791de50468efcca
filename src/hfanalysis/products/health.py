"""The content of health.json: which channels can be believed, from when to when, and why not."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from hfanalysis.products.model import Is, Part, Product, Warnings, Words

Verdict = Literal["healthy", "suspect", "unusable"]
HEALTHY: Verdict = "healthy"
SUSPECT: Verdict = "suspect"
UNUSABLE: Verdict = "unusable"
SEVERITY: tuple[Verdict, ...] = (HEALTHY, SUSPECT, UNUSABLE)
"""The verdicts, from good to bad."""

TRUSTED = " trusted ("
"""How it is said, after a channel's name, that the engineer trusts it."""

KINDS = {
    "dead": "dead",
    "railed": "at its rail",
    "stuck": "stuck",
    "coarse": "resolution too coarse",
    "noise": "noise only",
    "open": "open or broken thermocouple",
    "dropout": "drop-outs coded as numbers",
    "zero": "zero off",
    "drift": "zero drifts",
    "gauge_or_absolute": "gauge or absolute pressure mistaken",
    "scale": "scale off",
    "unit": "wrong unit",
    "sign": "sign flipped",
    "swapped": "channels swapped",
    "gross_mass": "reads more than the load",
    "lag": "slow",
    "clock": "clock off",
    "repeated": "rows repeated",
    "edge": "wild values at an end of the log",
}
"""The kinds of finding, in plain words; docs/health.md has a section for each."""


class Finding(Part):
    """Something about a channel that may not be believed."""

    kind: Annotated[str, Is("of finding, one of those in docs/health.md")]
    channels: Annotated[tuple[str, ...], Is("that it speaks about, by canonical name")]
    verdict: Annotated[Verdict, Is("what it makes of them: suspect, unusable; healthy where it only tells")]
    start: Annotated[float | None, Is("from when on; null: throughout", "s, log time")] = None
    end: Annotated[float | None, Is("until when; null: throughout", "s, log time")] = None
    evidence: Annotated[Words, Is("what was seen, in numbers")]
    means: Annotated[Words, Is("the likely cause, and what it would mean if it were so")]
    cure: Annotated[str | None, Is("lines of test.toml that cure it; those outside a table belong to the channel's")]
    bias: Annotated[float | None, Is("one standard deviation of the offset that it may mean", "of the channel")] = None
    gain: Annotated[float | None, Is("one standard deviation of the factor that it may mean", "")] = None
    delay: Annotated[float | None, Is("one standard deviation of how late it may be", "s")] = None
    pace: Annotated[float | None, Is("one standard deviation of the factor that its times may be off by", "")] = None
    overruled: Annotated[bool, Is("by the engineer's trust in the channel")] = False

    @property
    def whole(self) -> bool:
        """Whether it holds for the whole log."""
        return self.start is None and self.end is None

    @property
    def span(self) -> tuple[float, float]:
        """From when to when [s, log time]; infinite where that is open."""
        low, high = float("-inf"), float("inf")
        return (low if self.start is None else self.start, high if self.end is None else self.end)


class ChannelHealth(Part):
    """Whether one channel can be believed."""

    verdict: Annotated[Verdict, Is("the worst that its findings lead to")]
    trust: Annotated[str | None, Is("why the engineer trusts it, whatever was found")] = None
    findings: Annotated[tuple[Finding, ...], Is("what was found, those between channels that point to it among them")]


class Health(Product):
    """Which channels can be believed, from when to when, and why not."""

    file: ClassVar[str] = "health.json"

    channels: Annotated[dict[str, ChannelHealth], Is("by canonical name")]
    between: Annotated[tuple[Finding, ...], Is("findings that tie channels, or this test to others of its stand")]
    firing: Annotated[tuple[float, float] | None, Is(
        "from when to when most channels are away from rest, by a coarse look", "s, log time"
    )] = None  # fmt: skip
    compared: Annotated[tuple[str, ...], Is("other tests of the stand that were looked at")] = ()
    warnings: Warnings

    @property
    def findings(self) -> tuple[Finding, ...]:
        """All of them, each once."""
        return tuple(dict.fromkeys(finding for channel in self.channels.values() for finding in channel.findings))

    def of(self, name: str) -> ChannelHealth:
        """The health of a channel; one that was not judged is healthy."""
        return self.channels.get(name) or ChannelHealth(verdict=HEALTHY, findings=())
