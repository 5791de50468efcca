"""Missing effects that a test's channels show without any model: what a saturated tank and a shut valve do not do.

A saturated tank's pressure falls all but evenly while liquid flows, from what it was at rest. The line through the
second half of that fall meets the pressure at rest, and what lies between, within about a bar; in a line behind a check
valve that lets nothing pass, what is shut in follows the tank (``python -m benchmarks.signs``; docs/diagnosis.md).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.health.reasons import Doubt
from hfanalysis.inference.subject import Subject
from hfanalysis.products.health import HEALTHY, Finding
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.sentences import capitalised, joined, said, text

SHIFTS, FACTORS = ("zero", "drift"), ("scale", "unit")
"""Kinds of finding that say by how much a cell's zero is off, and that a channel's size is."""

BAR = 1e5
"""A bar [Pa]. Source: definition."""

COURSE = 0.5 * BAR
"""Standard deviation of the pressure at rest by the line through the later fall [Pa]."""

LEAST_FALL, LEAST_DIP, LEAST_FLOW = 2.0 * BAR, 1.5 * BAR, 5.0 * BAR
"""What is called a fall at the opening, a dip below the bulk's pressure, and a valve that nitrogen passes [Pa].
Evidence: twice of what 231 tests of the calibration split have at most that lack these. Layers of a bar are none, and
larger ones are seen with their size (tests/diagnose/test_model_free.py)."""

SURE = 3.0
"""Standard deviations that a fall has to have besides."""

SAGS = 0.05
"""Part of its pressure by which a purge line has to fall if something leaves it."""

LATER = (0.5, 0.9)
"""The part of the liquid's time through which the line is laid."""

WIDTH = 0.1
"""Seconds of a running median, which no single wild sample moves."""

FEWEST = 8
"""Samples that a line takes."""


@dataclass(frozen=True)
class Sign:
    """What is seen in a ``channel`` from ``start`` to ``end`` [s], how large it is, and which effect it may be.

    ``besides``: what may have a part in it, or not.
    """

    names: tuple[str, ...]
    channel: str
    start: float
    end: float
    size: Quantity
    text: str
    besides: tuple[str, ...] = ()


def signs_of(log: TestLog, segments: Segments) -> list[Sign]:
    """All that is seen; nothing of a tank that is supercharged, whose pressure falls for other reasons."""
    found = [] if segments.supercharged else [fall_at_opening(log, segments)]
    found.append(open_check_valve(log, segments))
    return [sign for sign in found if sign is not None]


@dataclass(frozen=True)
class ShownByChannels:
    """What the channels of a test show by themselves: thrust and chamber gauge that are ``wrong``, and signs of missing
    effects."""

    wrong: tuple[Finding, ...]
    signs: tuple[Sign, ...]

    @property
    def disagree(self) -> bool:
        """Whether thrust and chamber pressure do not go together."""
        return any(found.kind in FACTORS for found in self.wrong)

    @property
    def sentences(self) -> list[str]:
        """All of it, sensors first."""
        of_sensors = (Doubt(found, found.channels).words for found in self.wrong)
        texts = [*of_sensors, *(sign.text for sign in self.signs)]
        return [joined("", [words if words[1] == "_" else capitalised(words), "."]) for words in texts]


def shown(subject: Subject) -> ShownByChannels:
    """Everything that takes no model to see."""
    return ShownByChannels(
        tuple(found for found in subject.found if _concerns(found)), tuple(signs_of(subject.log, subject.segments))
    )


def _concerns(found: Finding) -> bool:
    """Whether a finding is of what a model is compared with: a thrust cell's zero; thrust and p_c A_t that disagree."""
    if found.verdict == HEALTHY or found.overruled:
        return False
    shifted = found.kind in SHIFTS and "thrust" in found.channels and found.cure is None
    return shifted or (found.kind in FACTORS and bool({"thrust", "p_chamber"} & set(found.channels)))


@dataclass(frozen=True)
class OpeningTransient:
    """How far a tank at rest was above the line through its later fall, and how far it then came below it [Pa].

    ``straight``: standard deviation of where that line begins [Pa]; ``lowest``: when it is furthest below [s after the
    opening].
    """

    fall: float
    dip: float
    straight: float
    lowest: float

    @property
    def std(self) -> float:
        """Standard deviation of the fall [Pa]."""
        return float(np.hypot(self.straight, COURSE))


def opening_of(log: TestLog, segments: Segments) -> OpeningTransient | None:
    """What the tank's pressure [Pa] does as the valve opens [s after the opening]; None where its later fall cannot be
    told."""
    tank, end = _signal(log, segments, "p_tank"), _steady_until(segments)
    if tank is None or end is None:
        return None
    still, later = tank.between(-2.0, -0.1), tank.between(LATER[0] * end, LATER[1] * end)
    if min(still.time.size, later.time.size) < FEWEST:
        return None
    line, spread = np.polyfit(later.time, later.value, 1, cov=True)
    lowest, dip = _dip(tank, line, LATER[0] * end)
    return OpeningTransient(float(np.median(still.value) - line[1]), dip, float(np.sqrt(spread[1, 1])), lowest)


def fall_at_opening(log: TestLog, segments: Segments) -> Sign | None:
    """A tank at rest that was warmer above than its bulk, or boils late: its pressure [Pa] falls fast as the valve
    opens.

    None where it falls by less than LEAST_FALL and dips by less than LEAST_DIP, or than is uncertain of either.
    """
    found = opening_of(log, segments)
    if found is None:
        return None
    falls = found.fall >= max(LEAST_FALL, SURE * found.std)
    dips = found.dip >= max(LEAST_DIP, SURE * found.straight)
    if not falls and not dips:
        return None
    size = Quantity(-found.fall if falls else -found.dip, "Pa", found.std)
    names = ("tank_nonequilibrium",) if dips else ("tank_stratification", "tank_nonequilibrium")
    besides = ("tank_stratification",) if dips and falls else ()
    return Sign(names, "p_tank", 0.0, found.lowest, size, _in_words(found, falls, dips), besides)


def _in_words(found: OpeningTransient, falls: bool, dips: bool) -> str:
    parts: list[str] = []
    if falls:
        parts.append(
            text(
                "the tank's pressure falls by {fall} as the valve opens, beyond its later fall; at rest it was not "
                "the bulk's",
                fall=said(found.fall, "bar", ".1f", found.std, ".1f"),
            )
        )
    if dips:
        parts.append(
            text(
                "at {lowest:.1f} s the tank's pressure is {dip} below the course of its later fall; it comes back, so "
                "vapor is made late",
                lowest=found.lowest,
                dip=said(found.dip, "bar", ".1f"),
            )
        )
    if not dips:
        parts.append(
            "it was that of a hot ullage over a colder bulk, or vapor is made late; these channels do not tell which"
        )
    elif falls:
        parts.append("how much of the fall is a hot ullage's these channels do not tell")
    return joined("; ", parts)


def _steady_until(segments: Segments) -> float | None:
    """Up to when nothing but the liquid's flow moves the tank's pressure [s]; None where that is too short."""
    liquid_out = segments.time("t_v")
    if liquid_out is None:
        return None
    times = (liquid_out, segments.time("t_purge"), segments.time("t_fuel_out"))
    end = min(t for t in times if t is not None)
    return end if LATER[0] * end > (segments.time("t_feed") or 0.0) else None


def _dip(tank: Signal, line: Array, end: float) -> tuple[float, float]:
    """When a tank is furthest below a line before ``end`` [s], and by how much it is [Pa]."""
    middle = np.arange(WIDTH, end, 0.5 * WIDTH)
    around = [tank.between(t - 0.5 * WIDTH, t + 0.5 * WIDTH).value for t in middle]
    if not middle.size:
        return 0.0, 0.0
    level = np.array([np.median(v) if v.size else np.inf for v in around])
    below = np.polyval(line, middle) - level
    return float(middle[np.argmax(below)]), float(below.max())


@dataclass(frozen=True)
class PurgeLineSign:
    """How far a purge line is above the tank as its check valve ``opens`` and at the ``end`` [s after the opening], how
    far it ``fell``, and its ``pressure`` as it opens [Pa]."""

    opens: float
    end: float
    above: float
    above_at_end: float
    fell: float
    pressure: float

    @property
    def more(self) -> float:
        """By how much more it is above the tank at the end [Pa]."""
        return self.above_at_end - self.above


def purge_line_of(log: TestLog, segments: Segments) -> PurgeLineSign | None:
    """What a purge line does [Pa] from the opening of its valve on [s after the opening]; None where that is not
    recorded."""
    tank, line = _signal(log, segments, "p_tank"), _signal(log, segments, "p_purge")
    opens, end = segments.time("t_purge"), segments.time("t_end")
    if tank is None or line is None or opens is None or end is None:
        return None
    tank_0, line_0, tank_1, line_1 = (s.mean(t - 3.0 * WIDTH, t) for t in (opens, end) for s in (tank, line))
    if not np.isfinite([tank_0, line_0, tank_1, line_1]).all():
        return None
    return PurgeLineSign(opens, end, line_0 - tank_0, line_1 - tank_1, line_0 - line_1, line_0)


def open_check_valve(log: TestLog, segments: Segments) -> Sign | None:
    """A purge line that stays above the tank by more than its valve opens at [Pa], and falls: nitrogen flows.

    None where it is less than LEAST_FLOW more, or falls by less than SAGS of its pressure.
    """
    found = purge_line_of(log, segments)
    if found is None or found.more < LEAST_FLOW or found.fell < SAGS * found.pressure:
        return None
    std = float(np.sqrt(2.0) * np.hypot(log["p_tank"].accuracy, log["p_purge"].accuracy))
    words = text(
        "the purge line falls from {opens:.1f} s on, but stays {above} above the tank at the end, {more} more than as "
        "its check valve opened: nitrogen flows into the tank",
        opens=found.opens,
        above=said(found.above_at_end, "bar", ".1f"),
        more=said(found.more, "bar", ".1f"),
    )
    return Sign(("n2_purge",), "p_purge", found.opens, found.end, Quantity(found.more, "Pa", std), words)


def _signal(log: TestLog, segments: Segments, name: str) -> Signal | None:
    """A channel's good samples, in seconds after the opening; None without them."""
    if name not in log or segments.t_open.value is None:
        return None
    signal = Signal.of(log[name]).shifted(segments.t_open.value)
    return None if signal.dead else signal
