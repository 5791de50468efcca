"""What can be said of a test whose engine cannot be run: what its channels show by themselves."""

from __future__ import annotations

from dataclasses import dataclass

from hfanalysis.diagnose.answer.posterior import scale
from hfanalysis.diagnose.model_free import SHIFTS, ShownByChannels, Sign, shown
from hfanalysis.effects import effect
from hfanalysis.errors import AbsentError
from hfanalysis.inference.subject import Subject
from hfanalysis.performance.thrust import thrust_of
from hfanalysis.products.diagnosis import NO_TIME, ClosedFraction, Compared, Diagnosis, Gap, Place
from hfanalysis.products.health import KINDS, Finding
from hfanalysis.quantity import Quantity
from hfanalysis.sentences import text


def channels_alone(subject: Subject, why: str) -> Diagnosis:
    """The product of a diagnosis without a model. Raises AbsentError where the channels show nothing wrong either.

    A thrust cell that does not come back to its zero has shifted: that is the sensor's health, and is told as such; by
    itself it is nothing that the model lacks. That thrust and chamber pressure disagree says that one of them, or the
    nozzle, is not what is stated, and not which. What tank and purge line show is in ``diagnose.model_free``. Nothing
    tells which of several explains most, and nothing is added to the model.
    """
    seen = shown(subject)
    if not seen.disagree and not seen.signs:
        of_cell = "".join(f"; {sentence[:1].lower()}{sentence[1:]}" for sentence in map(str, seen.sentences))
        raise AbsentError(f"{why}; its channels, by themselves, show nothing that a model would lack{of_cell}")
    stated = _stated(seen)
    names = [name for name in (*stated.posterior, *stated.partners) if name not in ("none", "unknown")]
    channels = {c for f in seen.wrong for c in f.channels} | {s.channel for s in seen.signs}
    return Diagnosis(
        verdict=stated.verdict,
        effects=(),
        set90=stated.set90,
        posterior=stated.posterior,
        partners=stated.partners,
        localisation=(*(_place(f, subject) for f in seen.wrong), *(_place_of(sign) for sign in seen.signs)),
        gap=Gap(before={}, after={}, noise={}, closed_fraction=NOTHING_CLOSED),
        upper_limits={},
        twins=(),
        not_it=(),
        decisive_measurements=tuple(f"{effect(name).plain_name}: {effect(name).decisive}" for name in names),
        plausibility={},
        compared=Compared(channels=tuple(sorted(channels))),
        notes=(
            "only what the channels show by themselves was judged; no probability of other effects was formed; "
            "what is stated is as sure as any evidence was on simulated tests; of two names, or of one that may have a "
            "part in it, the odds are even",
        ),
        warnings=(),
        runtime_s=NO_TIME,
        seed=0,
        sentences=(*seen.sentences, text("No more can be said without a model to compare with: {why}.", why=why)),
        called={name: effect(name).plain_name for name in dict.fromkeys(names)},
    )


NOTHING_CLOSED = ClosedFraction(same=None, held_out=None, other_test=None, placebo=None)


@dataclass(frozen=True)
class _Stated:
    """The verdict and the probabilities: of the first of what is seen, and of what is beside it."""

    verdict: str
    set90: tuple[str, ...]
    posterior: dict[str, float]
    partners: dict[str, float]


def _stated(seen: ShownByChannels) -> _Stated:
    sure = _sure()
    groups = [sign.names for sign in seen.signs]
    if not groups:
        return _Stated("unknown", ("unknown",), {"unknown": sure, "none": 1.0 - sure}, {})
    even = {name: sure / len(group) for group in groups for name in group}
    first = {name: even[name] for name in groups[0]}
    perhaps = {name: 0.5 * sure for sign in seen.signs for name in sign.besides}
    partners = {name: p for name, p in (even | perhaps).items() if name not in first}
    verdict = "named" if all(len(group) == 1 for group in groups) else "ambiguous"
    return _Stated(verdict, tuple(first), {**first, "unknown": 1.0 - sure}, partners)


def _sure() -> float:
    """As probable as anything is."""
    return 1.0 - scale().misled


def _off_zero(subject: Subject) -> Quantity:
    """What the thrust cell reads beyond its zero once nothing pushes it [N]."""
    channel, thrust = subject.log["thrust"], thrust_of(subject.log, subject.segments, subject.definition)
    return Quantity(thrust.error, "N", channel.zero_std if channel.zero_std is not None else channel.accuracy)


def _place(found: Finding, subject: Subject) -> Place:
    end = subject.segments.time("t_end") or subject.segments.time("t_fuel_out") or 0.0
    shifted = found.kind in SHIFTS
    size = _off_zero(subject) if shifted else Quantity(found.gain or 0.0, "")
    return _row("sensor" if shifted else "nozzle", KINDS[found.kind], "liquid", (0.0, end), size, found.channels[0])


def _place_of(sign: Sign) -> Place:
    equation, phase = effect(sign.names[0]).equation, "purge" if sign.channel == "p_purge" else "liquid"
    return _row(equation, " or ".join(sign.names), phase, (sign.start, sign.end), sign.size, sign.channel)


def _row(equation: str, site: str, phase: str, span: tuple[float, float], size: Quantity, channel: str) -> Place:
    return Place(
        equation=equation,
        site=site,
        phase=phase,
        t_start=Quantity(span[0], "s"),
        t_end=Quantity(span[1], "s"),
        source=size,
        channel=channel,
        significance=0.0,
    )
