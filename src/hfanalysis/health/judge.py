"""A test's health: every channel by itself, then the ties between them, last the other tests of the stand."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from hfanalysis.health import kinds, stand, ties
from hfanalysis.health.reasons import reasons
from hfanalysis.health.seen import SeenTest, Sister, look
from hfanalysis.products.health import (
    HEALTHY,
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


def judge(log: TestLog, definition: TestDefinition, sisters: Sequence[Sister] = ()) -> Health:
    """The health of a log as ingested; ``sisters``: other tests of the stand."""
    test = look(log, definition)
    own = [f for seen in test.channels.values() for find in kinds.detectors().values() for f in find(seen)]
    tied = _all(ties, replace(test, found=tuple(own)))
    against = _all(stand, replace(test, found=(*own, *tied), sisters=tuple(sisters))) if sisters else []
    doubts = [_no_worse_than_suspect(finding) for finding in against]
    found = [*own, *tied, *doubts]
    channels = {name: _channel(name, found, definition) for name in log.channels}
    return Health(
        channels=channels,
        between=tuple(_overruled(finding, definition) for finding in (*tied, *doubts)),
        firing=test.fire,
        compared=tuple(sister.name for sister in sisters),
        warnings=tuple(doubt.sentence for doubt in reasons(channels)),
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


def _no_worse_than_suspect(finding: Finding) -> Finding:
    return finding.but(verdict=SUSPECT) if finding.verdict == UNUSABLE else finding
