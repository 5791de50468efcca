"""A test's health: every channel by itself, then the ties between them, last the other tests of the stand."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from hfanalysis.health import kinds, stand, ties
from hfanalysis.health.seen import SeenTest, Sister, look
from hfanalysis.products.health import (
    HEALTHY,
    KINDS,
    SEVERITY,
    SUSPECT,
    UNUSABLE,
    ChannelHealth,
    Finding,
    Health,
    Verdict,
)
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.sentences import text


def judge(log: TestLog, definition: TestDefinition, sisters: Sequence[Sister] = ()) -> Health:
    """The health of a log as ingested; ``sisters``: other tests of the stand."""
    test = look(log, definition)
    own = [f for seen in test.channels.values() for find in kinds.detectors().values() for f in find(seen)]
    tied = _all(ties, replace(test, found=tuple(own)))
    against = _all(stand, replace(test, found=(*own, *tied), sisters=tuple(sisters))) if sisters else []
    doubts = [_no_worse_than_suspect(finding) for finding in against]
    found = [*own, *tied, *doubts]
    return Health(
        channels={name: _channel(name, found, definition) for name in log.channels},
        between=tuple(_overruled(finding, definition) for finding in (*tied, *doubts)),
        firing=test.fire,
        compared=tuple(sister.name for sister in sisters),
        warnings=tuple(_warnings(found, definition)),
    )


def _all(package: object, test: SeenTest) -> list[Finding]:
    return [finding for find in package.detectors().values() for finding in find(test)]  # type: ignore[attr-defined]


def _channel(name: str, found: Iterable[Finding], definition: TestDefinition) -> ChannelHealth:
    trust = definition.channels[name].trust
    own = tuple(f.but(overruled=True) if trust else f for f in found if name in f.channels)
    worst: Verdict = max((f.verdict for f in own if not f.overruled), key=SEVERITY.index, default=HEALTHY)
    return ChannelHealth(verdict=worst, **({"trust": trust} if trust else {}), findings=own)


def _overruled(finding: Finding, definition: TestDefinition) -> Finding:
    """A finding all of whose channels are trusted is overruled."""
    trusted = all(definition.channels[name].trust for name in finding.channels if name in definition.channels)
    return finding.but(overruled=True) if trusted and finding.channels else finding


def _warnings(found: Iterable[Finding], definition: TestDefinition) -> Iterator[str]:
    """A sentence for every finding that makes a channel worse than healthy, or would if nobody trusted it."""
    for finding in found:
        for trust in dict.fromkeys(definition.channels[name].trust for name in finding.channels):
            if finding.verdict == HEALTHY:
                continue
            names = [name for name in finding.channels if definition.channels[name].trust == trust]
            whose = f"channel {names[0]}" if len(names) == 1 else f"channels {', '.join(names)}"
            yield text(
                "{whose}: {verdict} ({kind}{when}): {evidence}: {means}",
                whose=whose,
                verdict=f"trusted by the engineer ({trust}), would be {finding.verdict}" if trust else finding.verdict,
                kind=KINDS.get(finding.kind, finding.kind),
                when=_when(finding),
                evidence=finding.evidence,
                means=finding.means,
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


def _no_worse_than_suspect(finding: Finding) -> Finding:
    return finding.but(verdict=SUSPECT) if finding.verdict == UNUSABLE else finding
