"""The content of diagnosis.json: what the model lacks, with probabilities and proof."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar

from pydantic import ConfigDict, Field

from hfanalysis.products.model import Is, Notes, Numbers, Part, Product, Warnings, Words
from hfanalysis.quantity import Quantity

Sizes = dict[str, float]
AS_SAID = "as unit says"


class Plausibility(Part):
    """How large an effect is, and whether that can be."""

    size: Annotated[Words | None, Is("in words; null where nothing is known of how large it can be")]
    plausible: Annotated[bool | None, Is("whether it can be so large")]
    why: Annotated[Words, Is("why it can, or cannot")]


class NamedEffect(Part):
    """An effect that was added to the model."""

    name: Annotated[str, Is("as the library of effects has it")]
    probability: Annotated[float, Is("of being there", "")]
    equation: Annotated[str, Is("that it acts in")]
    meaning: Annotated[str, Is("what it is")]
    parameters: Annotated[dict[str, Quantity], Is("as fitted, by name; ci95 within the parameter's bounds")]
    plausibility: Annotated[Plausibility, Is("of its size")]


class SourceHistory(Part):
    """A source over time with its band."""

    unit: Annotated[str, Is("of the source")]
    time: Annotated[Numbers, Is("after the opening", "s")]
    mean: Annotated[Numbers, Is("its mean", AS_SAID)]
    low90: Annotated[Numbers, Is("lower end of its 90 % band", AS_SAID)]
    high90: Annotated[Numbers, Is("upper end of its 90 % band", AS_SAID)]


class Place(Part):
    """Where, when and how much the model lacks; an unknown has further quantities that it is known by, such as
    ``opens_in``, ``fails_within`` or ``delay`` [s] and ``frequency`` [Hz]."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Quantity] = Field(init=False)

    equation: Annotated[str, Is("in which it is")]
    site: Annotated[str, Is("the effect, or the place in the equation")]
    phase: Annotated[str, Is("liquid, vapor or purge: that of most of its square, in the unit of the equation")]
    t_start: Annotated[Quantity, Is("it begins", "s")]
    t_end: Annotated[Quantity, Is("it ends", "s")]
    source: Annotated[Quantity, Is("its mean between the two")]
    rms: Annotated[Quantity | None, Is("its root mean square between the two")] = None
    channel: Annotated[str | None, Is("the sensor that it is of")]
    significance: Annotated[float, Is("gain of log evidence by it", "")]
    part: Annotated[float | None, Is(
        "its largest size over what goes through its equation, or over the largest reading of its sensor", ""
    )] = None  # fmt: skip
    history: Annotated[SourceHistory | None, Is("over time")] = None
    beside: Annotated[bool, Is("whether it is open beside what is named")] = False

    def known_by(self, name: str) -> Quantity | None:
        """A further quantity [SI]; None where it has none of that name."""
        return self.__pydantic_extra__.get(name)


class FormError(Part):
    """The model-form error, as parts of the channels' ranges."""

    tank: Annotated[float, Is("of the pressures and mass of the feed side", "")]
    chamber: Annotated[float, Is("of the chamber's pressure and the thrust", "")]


class PowerLaw(Part):
    """A form that a source without a name may have: a factor times powers of states of the engine. It is no name."""

    factor: Annotated[float, Is("of the powers, states in SI", AS_SAID)]
    powers: Annotated[Sizes, Is("by state", "")]
    start: Annotated[float, Is("from when on it is seen", "s")]
    end: Annotated[float, Is("until when it is seen", "s")]
    words: Annotated[Words, Is("the same in words")]


class Learnt(Part):
    """A source without a name as a table over a state of the engine; ``hfa diagnose --apply --unknown`` adopts it."""

    effect: Annotated[str, Is("what it is called as an effect")]
    site: Annotated[str, Is("the place in the equation")]
    equation: Annotated[str, Is("in which it is")]
    state: Annotated[str, Is("that it follows best, the likeliest beforehand of those alike")]
    parameters: Annotated[dict[str, Quantity], Is("the table: ends of the state, values, and their deviations")]
    evidences: Annotated[Sizes, Is("log evidence of its course by state, less the largest", "")]
    alike: Annotated[tuple[str, ...], Is("states that it follows nearly as well")]
    closed_fraction: Annotated[float, Is("of the gap, by the table, on the test itself", "")]
    hint: Annotated[PowerLaw | None, Is("at its form; null where no simple one fits")]
    beside: Annotated[
        tuple[NamedEffect, ...], Is("effects that were in the model with it, and are adopted with it")
    ] = ()


class Tried(Part):
    """An explanation that was fitted."""

    names: Annotated[tuple[str, ...], Is("its effects, or the site of an unknown source last")]
    unknown: Annotated[bool, Is("whether an unknown source is in it")]
    log_evidence: Annotated[float, Is("beyond the base model's", "")]
    model_form_error: Annotated[FormError, Is("at which it was judged")]
    held_out: Annotated[float | None, Is(
        "log probability of held-out data, by a fit to the rest, beyond the base model's; of what a claim rests on", ""
    )] = None  # fmt: skip


class ClosedFraction(Part):
    """How much of the gap of all channels closes, in four arms."""

    same: Annotated[float | None, Is("on the data that named it", "")]
    held_out: Annotated[float | None, Is("on stretches that were held out", "")]
    other_test: Annotated[float | None, Is("on another test, constants frozen", "")]
    placebo: Annotated[float | None, Is("with the best wrong effect", "")]


class GapByPhase(Part):
    """What is beyond the noise, sqrt(rms^2 - noise^2), by channel and phase."""

    before: Annotated[dict[str, Sizes], Is("without what was found", "of the channel")]
    after: Annotated[dict[str, Sizes], Is("with it", "of the channel")]


class OtherTest(Part):
    """The gap of another test without and with the effects, their constants frozen."""

    test: Annotated[str, Is("its name")]
    closed_fraction: Annotated[float | None, Is("of its gap", "")]
    before: Annotated[Sizes, Is("rms without, by channel", "of the channel")]
    after: Annotated[Sizes, Is("rms with them, by channel", "of the channel")]


class Gap(Part):
    """Measured less model without and with what was found."""

    calibrated: Annotated[Sizes | None, Is(
        "rms with the constants as calibrated, by channel; null where no engine runs with them", "of the channel"
    )] = None  # fmt: skip
    before: Annotated[Sizes, Is("rms without, the base model's constants refitted, by channel", "of the channel")]
    after: Annotated[Sizes, Is("rms with it, by channel", "of the channel")]
    noise: Annotated[Sizes, Is("of the means that are compared", "of the channel")]
    closed_by_refitting: Annotated[float | None, Is(
        "part of the calibrated gap that refitting the base alone closes; it is counted for no effect", ""
    )] = None  # fmt: skip
    by_phase: Annotated[GapByPhase | None, Is("what of it is beyond the noise")] = None
    closed_fraction: Annotated[ClosedFraction, Is("of all channels together, each in units of its noise")]
    closed_by_free_form: Annotated[float | None, Is("by a spline of equal freedom", "")] = None
    other_test: Annotated[OtherTest | None, Is("the test that it was proved on")] = None


class Constants(Part):
    """The base model's constants, by the fit that they are from."""

    calibrated: Annotated[Mapping[str, Quantity], Is("as calibration.json has them without adopted effects")] = {}
    without: Annotated[dict[str, Quantity], Is("of the refitted base: to all channels together, without the effects")]
    better: Annotated[dict[str, Quantity], Is("to all channels together, with them"), Field(alias="with")]


class ChiSquare(Part):
    """A sum of squares against zero."""

    chi_square: Annotated[float, Is("weighted by the stated noise", "")]
    degrees_of_freedom: Annotated[int, Is("of it", "")]


class Lacking(Part):
    """What a governing equation lacks by the channels alone; only ``unit`` and ``reason`` where some are missing."""

    unit: Annotated[str, Is("of the equation: W, L, kg/s, bar or N")]
    reason: Annotated[Words | None, Is("why the equation cannot be asked")] = None
    time: Annotated[Numbers, Is("after the opening", "s")] = ()
    value: Annotated[Numbers, Is("what it lacks", AS_SAID)] = ()
    low90: Annotated[Numbers, Is("lower end of its 90 % band", AS_SAID)] = ()
    high90: Annotated[Numbers, Is("upper end of its 90 % band", AS_SAID)] = ()
    explained: Annotated[Numbers, Is("part of it that the engine's effects explain", AS_SAID)] = ()
    phase: Annotated[str | None, Is("that holds most of what is left")] = None
    t_start: Annotated[Quantity | None, Is("from when on what is left is beyond two deviations", "s")] = None
    t_end: Annotated[Quantity | None, Is("until when it is", "s")] = None
    mean: Annotated[Quantity | None, Is("of what is left in between")] = None
    significance: Annotated[ChiSquare | None, Is("of what is left")] = None
    closing_mass: Annotated[Quantity | None, Is(
        "in the tank at the end of the liquid by the injector's flow, less the vapor that fits", "kg"
    )] = None  # fmt: skip


class Compared(Part):
    """What was compared, and how well."""

    channels: Annotated[tuple[str, ...], Is("by name")]
    start: Annotated[float | None, Is("from when on", "s")] = None
    end: Annotated[float | None, Is("until when", "s")] = None
    model_form_error: Annotated[FormError | None, Is("that the explanation asks for")] = None
    chi_square: Annotated[float | None, Is("per observation, with what was found", "")] = None
    chi_square_without: Annotated[float | None, Is("per observation, without it", "")] = None
    fuel_fade: Annotated[Quantity | None, Is("time in which the fire went out", "s")] = None
    abrupt_end: Annotated[Quantity | None, Is("time in which the chamber empties without fuel", "s")] = None


class TriedOn(Part):
    """How the test was taken, and what became of the diagnosis on simulated tests that it was tried on."""

    rate: Annotated[float, Is("samples of a channel", "1/s")]
    rest: Annotated[float, Is("before the opening", "s")]
    noise: Annotated[float, Is("of a mean, over the channel's largest value", "")]
    load: Annotated[float, Is("oxidizer", "kg")]
    like: Annotated[int, Is("simulated tests most like this one", "")]
    sure: Annotated[int, Is("tests of these with a statement above 0.9", "")]
    right: Annotated[int, Is("tests of those in which all such were right", "")]
    outside: Annotated[tuple[Words, ...], Is("in what this test is outside of all that were tried")] = ()
    misled: Annotated[float, Is(
        "of a test outside: share of sure statements that were wrong in the world where that was worst; counted in", ""
    )] = 0.0  # fmt: skip


WITHOUT_NAME = {"none": "nothing", "unknown": "something without a name"}
"""What people call the two answers that are no effect."""


class Diagnosis(Product):
    """What the model lacks; without a model that runs, what the channels show by themselves."""

    file: ClassVar[str] = "diagnosis.json"

    verdict: Annotated[str, Is("none, named, ambiguous or unknown")]
    effects: Annotated[tuple[NamedEffect, ...], Is("what was added to the model")]
    set90: Annotated[tuple[str, ...], Is("the fewest names that hold 90 % of the probability")]
    posterior: Annotated[Sizes, Is("probability of every name, none and unknown as the first of what is missing", "")]
    partners: Annotated[Sizes, Is("probability of each further effect if the first is there", "")]
    by_equation: Annotated[Mapping[str, float], Is(
        "probability that the first of what is missing is in an equation, whatever its name", ""
    )] = {}  # fmt: skip
    evidences: Annotated[Mapping[str, float], Is("log evidence by label (none: 0)", "")] = {}
    unknown_elsewhere: Annotated[float | None, Is(
        "log evidence of the best unknown source in another equation than the best name's", ""
    )] = None  # fmt: skip
    tried: Annotated[tuple[Tried, ...], Is("every explanation that was fitted")] = ()
    leftover: Annotated[float | None, Is("chi-square per observation that the best name leaves", "")] = None
    localisation: Annotated[tuple[Place, ...], Is("places, the most significant first")]
    likeliest_place: Annotated[Place | None, Is(
        "where nothing is claimed, where something would most likely be; without history"
    )] = None  # fmt: skip
    gap: Annotated[Gap, Is("measured less model")]
    upper_limits: Annotated[dict[str, Quantity], Is(
        "of every effect that is not in the model: it stays below that with 95 % probability; without a value where "
        "the channels would not show it at any size"
    )]  # fmt: skip
    too_small: Annotated[Mapping[str, float], Is(
        "what is there but too small to matter, by effect or site: its part of what goes through its equation", ""
    )] = {}  # fmt: skip
    doubts: Annotated[tuple[Words, ...], Is(
        "why the name that is likeliest is not the whole story, where the verdict is unknown beside it"
    )] = ()  # fmt: skip
    unknown_beside: Annotated[tuple[str, ...], Is("that name, or those names; none were added to the model")] = ()
    learnt: Annotated[Learnt | None, Is("what is unknown, over the state that it follows best")] = None
    not_learnt: Annotated[Words | None, Is("why an unknown cannot be adopted as it was found")] = None
    at_limit: Annotated[Words | None, Is(
        "what would be said on the other side, where a probability is within 0.01 of a limit"
    )] = None  # fmt: skip
    not_converged: Annotated[Words | None, Is("why the search did not converge, where it did not")] = None
    twins: Annotated[tuple[tuple[str, ...], ...], Is("groups that the library declares hard to tell apart")]
    not_it: Annotated[tuple[str, ...], Is("effects with a probability below 0.02, first or beside it")]
    decisive_measurements: Annotated[tuple[Words, ...], Is("what would decide between the names that are left")]
    plausibility: Annotated[dict[str, Plausibility], Is("how plausible their sizes are")]
    constants: Annotated[Constants | None, Is("the base model's, without and with the effects")] = None
    weak_form: Annotated[Mapping[str, Lacking], Is(
        "what each governing equation lacks over time, by the channels alone"
    )] = {}  # fmt: skip
    compared: Annotated[Compared, Is("with what")]
    tried_on: Annotated[TriedOn | None, Is("how far the answer can be believed on such a stand")] = None
    probabilities_from: Annotated[str | None, Is("what made evidences probabilities")] = None
    notes: Notes
    warnings: Warnings
    runtime_s: Annotated[Quantity, Is("has no value: times stand in run.log", "s")]
    seed: Annotated[int, Is("nothing is drawn: 0", "")]
    sentences: Annotated[tuple[Words, ...], Is("all of it in words")] = ()
    called: Annotated[Mapping[str, str], Is("what people call every effect of the library, by its name")] = {}

    def plain(self, name: str) -> str:
        """What people call an effect, an unknown or nothing.

        >>> Diagnosis.plain(Diagnosis.model_construct(called={"n2_purge": "nitrogen into the tank"}), "n2_purge")
        'nitrogen into the tank'
        """
        return self.called.get(name) or WITHOUT_NAME.get(name) or name.replace("_", " ")


NO_TIME = Quantity.absent("times stand in run.log, so that products are the same from run to run")
