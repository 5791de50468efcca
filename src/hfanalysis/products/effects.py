"""The content of ``hfa effects --json``: the library of effects, and with a test what its channels can tell apart."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar

from hfanalysis.products.model import Is, Part


class EffectParameter(Part):
    """A parameter of an effect, and what is known of it before a test."""

    strength: Annotated[bool, Is("whether the effect is none where it is 0")]
    unit: Annotated[str, Is("SI")]
    meaning: Annotated[str, Is("what it is")]
    center: Annotated[float, Is("of its prior", "as unit says")]
    typical: Annotated[float, Is("size", "as unit says")]
    low: Annotated[float | None, Is("bound, where there is one", "as unit says")]
    high: Annotated[float | None, Is("bound, where there is one", "as unit says")]
    given: Annotated[bool, Is("whether the test states it, so that it is not estimated")]


class EffectEntry(Part):
    """An effect of the library."""

    equation: Annotated[str, Is("that it acts on")]
    meaning: Annotated[str, Is("what it is")]
    formula: Annotated[str, Is("of what it does")]
    sites: Annotated[tuple[str, ...], Is("where it acts")]
    phases: Annotated[tuple[str, ...], Is("in which it acts")]
    parameters: Annotated[dict[str, EffectParameter], Is("by name")]
    twins: Annotated[tuple[str, ...], Is("effects that look alike")]
    decisive: Annotated[str, Is("measurement that would decide")]
    reference: Annotated[str, Is("where it is from")]
    plain_name: Annotated[str, Is("what people call it; empty where it says none")] = ""


class Rival(Part):
    """Another effect that looks alike."""

    name: Annotated[str, Is("of the effect")]
    apart: Annotated[float, Is("what it leaves of a nominal d'", "")]
    correlation: Annotated[float, Is("of the two strengths", "")]


class Visibility(Part):
    """How well a test shows an effect."""

    strength: Annotated[str, Is("parameter")]
    unit: Annotated[str, Is("SI, of the strength")]
    typical: Annotated[float, Is("strength", "as unit says")]
    detectability: Annotated[float, Is("d' of the typical strength", "")]
    seen_at: Annotated[float | None, Is("strength from which on it is seen", "as unit says")]
    in_reach: Annotated[bool, Is("whether a strength within its bounds is seen")]
    decisive: Annotated[str, Is("measurement that would decide")]
    rivals: Annotated[tuple[Rival, ...], Is("the closest, nearest first")]


class Pair(Part):
    """Two effects."""

    effects: Annotated[tuple[str, str], Is("their names")]
    apart: Annotated[float, Is("the lesser of what each leaves of the other's nominal d'", "")]


class TwinPair(Pair):
    """Two effects that the test does not tell apart."""

    declared: Annotated[bool, Is("whether the library calls them twins")]


class AddedSensor(Part):
    """A sensor that the test does not have, and what it would tell apart."""

    words: Annotated[str, Is("what it is")]
    accuracy: Annotated[float, Is("one standard deviation", "as unit says")]
    unit: Annotated[str, Is("SI")]
    twins: Annotated[tuple[Pair, ...], Is("the test's twins with it")]
    shows: Annotated[tuple[str, ...], Is("effects that it would show and the test does not")]


class Separability(Part):
    """What the channels of a test can tell apart, before its residuals are looked at."""

    id: Annotated[str, Is("of the test")]
    channels: Annotated[tuple[str, ...], Is("that are compared")]
    seen_from: Annotated[float, Is("d' from which on an effect counts as seen", "")]
    nominal: Annotated[float, Is("d' at which effects are told apart", "")]
    twins_below: Annotated[float, Is("what is left of a nominal d' of twins", "")]
    effects: Annotated[dict[str, Visibility], Is("by name")]
    twins: Annotated[tuple[TwinPair, ...], Is("that the test does not tell apart")]
    declared_twins_apart: Annotated[tuple[Pair, ...], Is("twins of the library that it does tell apart")]
    sensors: Annotated[dict[str, AddedSensor], Is("that would help, by name")]
    called: Annotated[Mapping[str, str], Is("what people call every effect, by its name")] = {}


class EffectLibrary(Part):
    """The library of effects, those of the team included."""

    file: ClassVar[str] = "effects.json"

    effects: Annotated[dict[str, EffectEntry], Is("by name")]
    test: Annotated[Separability | None, Is("what a test can show of them; only with one")] = None
