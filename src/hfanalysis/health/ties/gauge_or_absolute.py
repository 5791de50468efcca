"""Gauge pressures logged as absolute ones, or the reverse: what is open to the air rests at ambient."""

from __future__ import annotations

from collections.abc import Iterator

from hfanalysis.health.firing import OPEN_TO_AIR
from hfanalysis.health.seen import Seen, SeenTest
from hfanalysis.health.words import level
from hfanalysis.products.health import Finding
from hfanalysis.sentences import text
from hfanalysis.units import is_gauge

SURE = 3.0
"""Deviations of its accuracy by which a channel at rest has to differ from ambient [-]."""
NEARER = 0.5
"""How much nearer than to ambient it has to rest to where the other kind of gauge would rest [-]: an offset of half
the ambient pressure is as likely either's."""


def find(test: SeenTest) -> Iterator[Finding]:
    """Chamber and line by their rest; pressures that cannot be seen at ambient by what all the others are."""
    judged = {name: _wrong(seen) for name in OPEN_TO_AIR if (seen := test.get(name)) is not None and _told(seen)}
    wrong = {name: side for name, side in judged.items() if side}
    for name in wrong:
        yield _finding(test.channels[name])
    if len(wrong) == len(judged) >= 2:
        yield from _likely(test, wrong)


def _told(seen: Seen) -> bool:
    """Whether its rest can tell: it is known, taken off by nobody, and no pressure is held behind a valve."""
    rest = seen.coarse.rest
    return seen.channel.zero_std is None and rest is not None and rest.value < SURE * seen.ambient


def _wrong(seen: Seen) -> int:
    """+1: ambient is missing; -1: it was added where it was in already; 0: neither."""
    assert seen.coarse.rest is not None
    rest, side = seen.coarse.rest.value, -1 if seen.spec.gauge else 1
    off = abs(rest - seen.ambient)
    other = seen.ambient * (2.0 if seen.spec.gauge else 0.0)
    return side if off > SURE * seen.channel.accuracy and abs(rest - other) < NEARER * off else 0


def _finding(seen: Seen) -> Finding:
    assert seen.coarse.rest is not None
    words = "reads {rest} absolute at rest, open to the air, where ambient is {ambient}"
    evidence = text(
        words, rest=level(seen.coarse.rest.value, "pressure"), ambient=level(seen.ambient, "pressure")
    )  # fmt: skip
    return seen.finding(
        "gauge_or_absolute", "suspect", evidence=evidence, means=_means(seen), cure=_cure(seen), bias=seen.ambient
    )


def _likely(test: SeenTest, wrong: dict[str, int]) -> Iterator[Finding]:
    side = next(iter(wrong.values()))
    alike = {test.channels[name].spec.unit for name in wrong}
    for seen in test.channels.values():
        if seen.dimension != "pressure" or seen.name in wrong or seen.spec.unit not in alike:
            continue
        if (-1 if seen.spec.gauge else 1) == side and test.get(seen.name) is not None:
            words = "{others}, logged in the same unit, are off by one ambient pressure"
            evidence = text(words, others=" and ".join(wrong))
            yield seen.finding(
                "gauge_or_absolute", "suspect", evidence=evidence, means=_means(seen), cure=_cure(seen),
                bias=seen.ambient,
            )  # fmt: skip


def _means(seen: Seen) -> str:
    if seen.spec.gauge:
        return "the log is of absolute pressures already: all of them would be one ambient pressure too high"
    return "the log is of gauge pressures: all of them would be one ambient pressure too low"


def _cure(seen: Seen) -> str:
    if not seen.spec.gauge:
        return "gauge = true"
    unit = seen.spec.unit
    return f'unit = "{unit[:-1] if unit.endswith("g") else unit}"\ngauge = false' if is_gauge(unit) else "gauge = false"
