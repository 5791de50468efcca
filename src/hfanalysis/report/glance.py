"""A test in four sentences and six numbers: what the first screen, the summary and the terminal say."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from hfanalysis.health.reasons import Doubt, reasons
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.diagnosis import Diagnosis
from hfanalysis.products.flight import Flight
from hfanalysis.products.health import KINDS, UNUSABLE, Health
from hfanalysis.products.segments import Segments
from hfanalysis.products.validation import Validation
from hfanalysis.quantity import DOUBTED, Quantity
from hfanalysis.report.material import Material
from hfanalysis.report.names import called, plain
from hfanalysis.sentences import capitalised
from hfanalysis.wording.numbers import effect_in_words, fixed, listed

KEY_NUMBERS = ("total_impulse", "burn_time", "peak_thrust", "peak_chamber_pressure", "specific_impulse")
"""What is asked for first, where the validation has it; the apogee comes after them."""

_FEW = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine")
_MOST_NAMED = 2
"""Channels that a sentence names; of more it says how many there are."""


class Told(NamedTuple):
    """One of the four: the question that it answers, and the answer with its caveat."""

    head: str
    words: str


def four(material: Material) -> list[Told]:
    """Did it work, what is wrong with the measurement, what does the model lack, and what next."""
    parts = (("Result", result), ("Measurement", measurement), ("Model", model), ("Next", following))
    return [Told(head, plain(say(material))) for head, say in parts]


def key_numbers(material: Material) -> dict[str, Quantity]:
    """The measured numbers [SI] that come first; where there are none, what the calibration has instead."""
    validation, calibration, flight = material.get(Validation), material.get(Calibration), material.get(Flight)
    found: dict[str, Quantity] = {}
    if validation is not None:
        measured = validation.performance.measured.quantities
        found = {name: measured[name] for name in KEY_NUMBERS if measured[name].value is not None}
    if flight is not None and flight.apogee.value is not None:
        found["apogee"] = flight.apogee
    flow = calibration.oxidizer_flow_peak if calibration is not None else None
    return found or ({"oxidizer_flow_peak": flow} if flow is not None and flow.value is not None else {})


def motor_class(material: Material) -> str:
    """The letter of the impulse's class; empty where it has none."""
    validation = material.get(Validation)
    words = validation.performance.motor_class if validation is not None else None
    return words.split()[0] if words else ""


def result(material: Material) -> str:
    """Whether it burned or flowed, for how long, and how smoothly."""
    segments = material.get(Segments)
    if not material.fired or segments is None:
        why = material.why_not("segments") if segments is None else "no opening of the valve was found"
        return f"No firing was found in this log, so nothing can be calibrated: {why}."
    if segments.kind != "hot_fire":
        return f"It flowed and did not burn, as far as its channels tell{_until(material)}."
    if segments.misfire:
        return "It did not burn as it should: the log shows a misfire, and the numbers are of what burned."
    return f"It burned{_until(material)}{_smoothly(material)}."


def _until(material: Material) -> str:
    validation, segments = material.get(Validation), material.get(Segments)
    burn = validation.performance.measured.burn_time if validation is not None else None
    if burn is None or burn.value is None:
        end = segments.time("t_end") if segments is not None else None
        return "" if end is None else f" for {fixed(end, 1)} s"
    stated = " (as stated)" if (burn.why or "").startswith("[observed]") else ""
    return f" for {fixed(burn.value, 1)} s{stated}"


_SMOOTHLY = {"smooth": ", and smoothly", "unseen": "; how smoothly, the log does not tell"}
_OTHERWISE = {"rough": ", but roughly", "unstable": ", but unstably"}


def _smoothly(material: Material) -> str:
    validation = material.get(Validation)
    found = validation.stability if validation is not None else None
    if found is None:
        return "; how smoothly was not judged"
    return _SMOOTHLY.get(found.verdict) or f"{_OTHERWISE.get(found.verdict, '')}: {found.why}"


def measurement(material: Material) -> str:
    """Which channels look wrong, and what that does to the numbers."""
    doubts = [doubt for doubt in material.reasons if not doubt.trust]
    if not material.log.channels:
        return "The log holds no channels that could be judged."
    if not doubts:
        trusted = ", though the engineer overrules a finding" if material.reasons else ""
        return f"No sensor looks wrong, as far as known kinds of fault show{trusted}."
    lost = any(doubt.finding.verdict == UNUSABLE for doubt in doubts)
    if lost:
        return f"{_faults(doubts)}: what is unusable is left out, and numbers that need it are missing."
    marked = any(q.verdict == DOUBTED for q in key_numbers(material).values())
    effect = "the numbers marked doubted rest on it" if marked else "none of the six numbers rests on it"
    return f"{_faults(doubts)}: {effect}."


def _faults(doubts: list[Doubt]) -> str:
    """Whose channels, and what is wrong with them: what is lost throughout first, moments of a log last."""
    by_channel: dict[str, list[str]] = {}
    for doubt in sorted(doubts, key=_weight):
        kinds = by_channel.setdefault(_whose(doubt), [])
        if (kind := KINDS.get(doubt.finding.kind, doubt.finding.kind)) not in kinds:
            kinds.append(kind)
    told = [f"{whose} ({listed(kinds[:_MOST_NAMED])})" for whose, kinds in by_channel.items()]
    more = len(told) - _MOST_NAMED
    rest = [f"{_count(more)} more"] if more > 0 else []
    return capitalised(listed([*told[:_MOST_NAMED], *rest]))


def _weight(doubt: Doubt) -> tuple[bool, bool]:
    """What comes first: what concerns the whole test, and of that what is unusable."""
    return not doubt.finding.whole, doubt.finding.verdict != UNUSABLE


def _whose(doubt: Doubt) -> str:
    """A few channels by name, of many how many."""
    names = list(map(called, doubt.channels))
    return listed(names) if len(names) <= _MOST_NAMED else f"{_count(len(names))} channels"


def _count(number: int) -> str:
    return _FEW[number] if number < len(_FEW) else str(number)


def model(material: Material) -> str:
    """What the model lacks, or has had added."""
    product = material.get(Diagnosis)
    if included(material):
        return included(material)
    if product is None:
        test = material.definition.test.id
        if "calibration" in material.absent:
            return "What the model lacks cannot be told by the model: this test has no calibration to start from."
        return f"What the model lacks is not known yet: hfa diagnose {test} looks for it."
    if product.effects and product.constants is not None:
        return _named(product)
    if product.constants is None:
        names = [product.plain(name) for name in (*product.set90, *product.partners)]
        what = listed([*dict.fromkeys(names)][:_MOST_NAMED])
        return f"No model could be run: the channels by themselves point to {what}."
    if product.verdict == "none":
        return "Nothing is missing from the model that these channels can show; what they cannot show may be."
    likely = listed([f"{product.plain(name)} ({product.posterior[name]:.2f})" for name in product.set90[:_MOST_NAMED]])
    if product.verdict == "unknown":
        return f"Something without a name is missing: {likely}; no effect of the library explains it."
    return f"Something is missing, and its name is open: {likely}."


def included(material: Material) -> str:
    """The adopted effects in a sentence; empty where there are none."""
    effects = material.included
    if not effects:
        return ""
    first = effects[0]
    if not first.table:
        first = first.but(parameters=dict(list(first.parameters.items())[:1]))
    words, more = effect_in_words(first, called), len(effects) - 1
    return f"Included in the model: {words}{f', and {_count(more)} more' if more else ''}; the numbers hold with it."


def _named(product: Diagnosis) -> str:
    first, more = product.effects[0], len(product.effects) - 1
    name = f"{product.plain(first.name)} (probability {first.probability:.2f})"
    wide = [row for row in product.effects if row.plausibility.plausible is False]
    doubt = (
        f"though the size of {_count(len(wide)) if more else 'it'} is hard to believe"
        if wide
        else "of a size that is plausible"
        if not more
        else "all of plausible size"
    )
    return f"Missing from the model: {name}{f' and {_count(more)} more' if more else ''}, {doubt}."


def following(material: Material) -> str:
    """What to do next."""
    product, cure = material.get(Diagnosis), _cure(material)
    test = material.definition.test.id
    if not material.fired:
        return "Look at the log: if the valve opened, state when, in test.toml."
    if lost := _lost(material):
        without = ", without which this one has no calibration" if "calibration" in material.absent else ""
        return f"Repair or replace the sensor of {lost} before the next test{without}."
    if cure:
        return f"Write the cure of {cure} into test.toml (hfa health {test} --apply), if the finding is right."
    if included(material):
        return "Weigh, measure and fire again: the next test shows whether what is included holds there."
    if product is None and not material.has("validation"):
        return f"State what is missing in test.toml, then run hfa run {test}: without it no model can be tried."
    if product is None:
        return f"Run hfa diagnose {test}, which takes minutes: it looks for what the model lacks."
    decisive = next(iter(product.decisive_measurements), "").partition(": ")[2].partition(";")[0]
    if product.verdict == "named" and product.effects and product.constants is not None:
        return f"Decide with {decisive}; or include it on what is known: hfa diagnose {test} --apply."
    if decisive:
        return f"Measure what would decide: {decisive}."
    if product.verdict == "unknown":
        return "Check the stated values and the sensors, for no effect that is known explains the misfit."
    return "Nothing has to be measured again for the model; a test of another load would try it harder."


def _lost(material: Material) -> str:
    """The channels that are unusable throughout and that no line of test.toml cures."""
    doubts = [d for d in material.reasons if d.finding.whole and d.finding.verdict == UNUSABLE and not d.trust]
    names = [_whose(doubt) for doubt in doubts if not doubt.finding.cure]
    return listed(names[:_MOST_NAMED]) if names else ""


def _cure(material: Material) -> str:
    """The channels of the weightiest finding that a line of test.toml cures."""
    cured = [doubt for doubt in material.reasons if doubt.finding.cure and not doubt.trust]
    return _whose(min(cured, key=_weight)) if cured else ""


class Against(NamedTuple):
    """A number [SI] now and last time; ``change`` is the share [-] by which it changed, None from zero."""

    name: str
    now: Quantity
    was: Quantity
    change: float | None


def against_last(material: Material) -> list[Against]:
    """What changed since the stand's test before: the injector's coefficient, and the numbers that come first."""
    if material.last is None:
        return []
    then = Material(material.definition, material.log, material.last.products)
    sides = [key_numbers(one) | _coefficient(one) for one in (material, then)]
    return list(_compared(*sides))


def _coefficient(material: Material) -> dict[str, Quantity]:
    calibration = material.get(Calibration)
    return {"C_i": calibration.C_i} if calibration is not None else {}


def _compared(now: Mapping[str, Quantity], before: Mapping[str, Quantity]) -> Iterator[Against]:
    for name, quantity in now.items():
        was = before.get(name)
        if was is not None and was.value is not None and quantity.value is not None:
            yield Against(name, quantity, was, quantity.value / was.value - 1.0 if was.value else None)


def sensors_then(material: Material) -> str:
    """What looked wrong with the sensors last time; empty where there was no last time."""
    health = material.last.products.get("health") if material.last is not None else None
    if not isinstance(health, Health):
        return ""
    doubts = [doubt for doubt in reasons(health.channels) if not doubt.trust]
    return _faults(doubts) if doubts else "none looked wrong"
