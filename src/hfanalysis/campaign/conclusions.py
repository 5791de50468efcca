"""What the tests of one stand say together, in sentences: what is the same in all, and what is not."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import hypot

from hfanalysis.campaign.pooling import DISAGREE, pooled
from hfanalysis.campaign.sensors import courses, drifts
from hfanalysis.campaign.trends import STEADY
from hfanalysis.campaign.words import NAMED, by_chance, tests_named
from hfanalysis.products.campaign import (
    CommonLaw,
    Course,
    EffectRow,
    Odd,
    SensorRow,
    StandRow,
    TestRow,
    Together,
    Trend,
)
from hfanalysis.quantity import NORMAL_95, Quantity
from hfanalysis.record.channels import LONG_NAMES
from hfanalysis.report.names import called
from hfanalysis.sentences import said
from hfanalysis.wording.numbers import in_words, listed, shown

TWICE = 1.5
"""Ratio of an effect's size in two tests from which on it is worth a look, if they differ beyond their deviations.
Source: by choice, half more."""


def conclusions(stand: StandRow, tests: Mapping[str, TestRow]) -> list[str]:
    """Sentences on the constants of a stand and on its effects; nothing of a stand with one test.

    ``tests``: all rows of the campaign, by name.
    """
    if len(stand.tests) < 2:
        return []
    rows = {test: tests[test] for test in stand.tests}
    return [
        *_constants(stand.constants, rows),
        *_odd_ones(stand),
        *_with_holes(rows),
        *_trends(stand.trends),
        *_effects(stand.effects, stand.tests),
        *_sensors(stand.sensors),
    ]


def _constants(constants: Mapping[str, Together], rows: Mapping[str, TestRow]) -> Iterator[str]:
    same = [name for name, together in constants.items() if _agree(together) and set(together.tests) == set(rows)]
    if same:
        both = "both" if len(rows) == 2 else f"all {len(rows)}"
        yield f"The same {listed([in_words(name) for name in same])} in {both} tests, within their deviations."
    for name, together in constants.items():
        if together.agreement is not None and not _agree(together):
            found = {test: rows[test].calibration[name] for test in together.tests}
            yield _apart(in_words(name), found)


def _odd_ones(stand: StandRow) -> Iterator[str]:
    """Which test does not fit the rest, by which number, and what else sets it apart."""
    for name, together in stand.constants.items():
        if together.odd is not None:
            yield from _odd(together.odd, in_words(name))
        for test in together.left:
            yield f"{test} left the family of the {in_words(name)}: it is beyond the natural limits of all in order."
    law = stand.regression
    if isinstance(law, CommonLaw) and law.odd is not None:
        yield from _odd(law.odd, f"regression rate at {law.flux:.0f} kg/(m² s)")


def _odd(odd: Odd, words: str) -> Iterator[str]:
    apart, rest = odd.apart.value or 0.0, odd.of.value or 0.0
    if rest == 0.0:
        yield f"{odd.test} does not fit the rest: its {words} is not zero, as theirs is."
        return
    by, off = abs(100.0 * apart / rest), abs(100.0 * (odd.apart.std or 0.0) / rest)
    yield (
        f"{odd.test} does not fit the rest: its {words} is {by:.1f} ± {off:.1f} % "
        f"{'above' if apart * rest > 0.0 else 'below'} theirs (by chance: {by_chance(odd.probability)})."
    )
    if odd.special:
        yield f"What else sets it apart: {listed(list(odd.special))}."
    else:
        yield "Nothing else that is known sets it apart: look at its fuel, its injector and its sensors."


def _agree(together: Together) -> bool:
    return together.agreement is not None and together.agreement.probability >= DISAGREE


def _apart(words: str, found: Mapping[str, Quantity]) -> str:
    """That a number differs, with the tests in which it is least and largest."""
    low, high = _ends(found)
    small, large = shown(found[low]), shown(found[high])
    unit = f" {large.unit}" if large.unit else ""
    return (
        f"The {words} differs: {small.value} ± {small.std}{unit} in {low}, {large.value} ± {large.std}{unit} in {high}."
    )


def _ends(found: Mapping[str, Quantity]) -> tuple[str, str]:
    """The tests with the least and the largest value."""
    in_order = sorted(found, key=lambda test: found[test].value or 0.0)
    return in_order[0], in_order[-1]


def _with_holes(rows: Mapping[str, TestRow]) -> Iterator[str]:
    """Whether the coefficient of an injector goes with the area of its holes: then it is no property of the hole."""
    known = {
        test: (row.injector_area, q)
        for test, row in rows.items()
        if row.injector_area is not None and (q := row.calibration.get("C_i")) is not None and q.value and q.std
    }
    if len({area for area, _ in known.values()}) < 2:
        return
    in_order = sorted(known, key=lambda test: known[test][0])
    values = [known[test][1].value or 0.0 for test in in_order]
    few, many = (known[test][1] for test in (in_order[0], in_order[-1]))
    rising, falling = values == sorted(values), values == sorted(values, reverse=True)
    if not _beyond_chance(few, many):
        yield f"Injectors of other hole areas have the same C_i: {tests_named(in_order, len(rows))}."
    elif rising or falling:
        word = "rises" if rising else "falls"
        yield f"C_i {word} with the area of the holes: it is no property of the hole."
    else:
        yield "C_i differs between the injectors, but not with the area of their holes."


def _beyond_chance(one: Quantity, other: Quantity) -> bool:
    """Whether two numbers differ by more than their deviations allow."""
    return abs((one.value or 0.0) - (other.value or 0.0)) > NORMAL_95 * hypot(one.std or 0.0, other.std or 0.0)


def _effects(effects: Mapping[str, EffectRow], tests: tuple[str, ...]) -> Iterator[str]:
    for name, effect in effects.items():
        others = [test for test in tests if test not in effect.named_in]
        where = tests_named(effect.named_in, len(tests))
        if len(effect.named_in) > NAMED or len(others) > NAMED:
            yield f"{_capital(called(name))} is named in {where}."
        elif others:
            yield f"{_capital(called(name))} is named in {where}, and not in {listed(others)}."
        else:
            yield f"{_capital(called(name))} is named in {'both' if len(tests) == 2 else 'all'} tests."
        for parameter, row in effect.parameters.items():
            if row.together.agreement is not None and not _agree(row.together):
                yield from _larger(called(name), parameter, row.by_test)


def _larger(name: str, parameter: str, found: Mapping[str, Quantity]) -> Iterator[str]:
    """By how many times a number of an effect differs between tests."""
    low, high = _ends(found)
    least, most = found[low].value or 0.0, found[high].value or 0.0
    if least > 0.0 and most > TWICE * least:
        times = f"{most / least:.1f} times that in {low}"
        yield f"{_capital(name)}: its {parameter.replace('_', ' ')} in {high} is {times}; look at what changed."


def _trends(found: Sequence[Trend]) -> Iterator[str]:
    """Which constant goes with which condition; where one is steady enough."""
    for one in found:
        if one.probability >= STEADY:
            continue
        word = "rises" if (one.slope.value or 0.0) > 0.0 else "falls"
        yield (
            f"{one.of} {word} with the {in_words(one.over)} over {len(one.tests)} tests "
            f"(by chance: {by_chance(one.probability)}), or a pressure's sensor moves both."
        )


def _sensors(sensors: Mapping[str, SensorRow]) -> Iterator[str]:
    """Which sensor's zero or gain drifts, in which tests it was off, and whose gain is none."""
    for name, what, course in courses(sensors):
        whose = f"The {what} of {_sensor(name, sensors[name])}"
        if drifts(course):
            (first, low), *_, (last, high) = course.by_test.items()
            yield f"{whose} drifts, from {_number(low)} in {first} to {_number(high)} in {last}: have it checked."
        for test in course.left:
            yield f"{whose} was off in {test}: {_number(course.by_test[test])}."
        if what == "gain":
            yield from _not_one(whose, course)


def _not_one(whose: str, course: Course) -> Iterator[str]:
    """That a cell shows another load than the one stated, test for test, by more than it is known to in any of them:
    its own error is the same in all."""
    least = min(quantity.std or 0.0 for quantity in course.by_test.values())
    together = pooled(course.by_test, least)
    if together is not None and together.mean.interval is not None:
        low, high = together.mean.interval
        if not low <= 1.0 <= high:
            off = said(together.mean.value or 0.0, "", ".3g")
            yield f"{whose} is {off} ({low:.3g} to {high:.3g}): it shows another load than the one stated."


def _sensor(name: str, row: SensorRow) -> str:
    words = LONG_NAMES.get(row.channel, row.channel.replace("_", " "))
    return words if name == row.channel else f"{name} ({words})"


def _number(found: Quantity) -> str:
    return str(said(found.value or 0.0, "bar" if found.unit == "Pa" else found.unit, ".3g"))


def _capital(words: str) -> str:
    return words[:1].upper() + words[1:]
