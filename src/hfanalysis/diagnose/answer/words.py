"""A diagnosis in words an engineer can act on."""

from __future__ import annotations

from hfanalysis.diagnose.answer.posterior import SET, poor_fit
from hfanalysis.diagnose.answer.verdict import LIKELIER
from hfanalysis.inference.unknowns import kind_of
from hfanalysis.products.diagnosis import Compared, Diagnosis, Gap, NamedEffect, Place
from hfanalysis.record.channels import unit_of
from hfanalysis.sentences import joined, said, text
from hfanalysis.wording.numbers import listed

EQUATIONS = {
    "tank_energy": "the tank's energy",
    "tank_volume": "the tank's volume balance",
    "injector": "the injector's flow",
    "feed": "the feed line's loss",
    "grain": "the fuel's regression",
    "chamber_mass": "the chamber's mass",
    "chamber_energy": "the gas's energy",
    "nozzle": "the nozzle's thrust or throat",
    "sensor": "a sensor",
}
"""Where a model may lack something, in words."""

_BY_UNIT = {
    ("tank_volume", "kg/s"): "the flow into the tank",
    ("tank_volume", "Pa"): "the tank's pressure at its temperature",
}
"""The same where the unit of what is lacking says more."""

LIKELY = 0.1
"""Probability from which on an effect that may be beside the first is mentioned."""

MUCH = 1.3
"""Chi-square per observation from which on more is left than noise that was estimated a little too small."""

LITTLE = 0.2
"""Part of the gap below which its closing is not what speaks for an effect."""

BEYOND_PLACEBO = 0.1
"""Part of the gap that has to close beyond the placebo's to speak for an effect."""

SLOW_FADE = 2.0
"""How many times longer than the chamber needs to empty the fire has to take to go out to be worth a sentence."""

UNEVEN = 0.5
"""Part of its root mean square below which a source's mean says little of it."""

GRADUAL = 2.5
"""Standard deviations by which the interval of a beginning reaches back further than the instant is uncertain."""

BRIEF = 0.5
"""Seconds of a stretch below which its beginning and end are said to hundredths."""

_UNITS = {"Pa": "bar", "W": "kW", "kg/s": "g/s", "1": "%"}


def story(product: Diagnosis) -> list[str]:
    """The whole verdict, sentence by sentence."""
    out = [headline(product), *doubts_sentences(product), *poor_fit_sentence(product), *equation_sentence(product)]
    out += [place_sentence(row) for row in product.localisation]
    out += [effect_sentence(row) for row in product.effects]
    out += fade_sentence(product.compared)
    if product.verdict == "none":
        out += left_over(product)
    else:
        out += [line for channel in product.gap.before if (line := gap_line(channel, product.gap))]
        out += proof_sentences(product)
    if product.verdict == "unknown" and product.not_it:
        out.append(f"It is none of these: {', '.join(product.not_it)}.")
    if product.decisive_measurements:
        out.append("What would decide: " + "; ".join(product.decisive_measurements) + ".")
    return out


def headline(product: Diagnosis) -> str:
    """What it is, with its probability."""
    posterior = product.posterior
    label = product.effects[0].name if product.effects else product.verdict
    others = [f"{n} ({posterior[n]:.2f})" for n in product.set90 if n != label]
    if product.verdict == "none" and product.too_small:
        parts = [
            f"{name}{f' ({posterior[name]:.2f})' if name in posterior else ''}, {_percent(part)} of what goes through "
            "its equation"
            for name, part in product.too_small.items()
        ]
        return f"Something is there, but too small to matter: {listed(parts)}."
    if product.verdict == "none":
        likeliest = max(posterior, key=lambda name: (posterior[name], name))
        if likeliest == "none" or posterior[likeliest] < LIKELIER * posterior["none"]:
            return f"Nothing is missing from the model that these channels can show (none {posterior['none']:.2f})."
        return (
            f"Nothing is claimed to be missing: {likeliest} ({posterior[likeliest]:.2f}) is more probable than none "
            f"({posterior['none']:.2f}), but too little in the data speaks for it."
        )
    doubt = f"; {listed(others)} cannot be excluded" if others else ""
    if product.unknown_beside:
        names = listed(product.unknown_beside)
        return (
            f"Something is missing that is not in the library (unknown {posterior['unknown']:.2f}), beside {names}"
            f"{doubt}."
        )
    if product.verdict == "unknown":
        return f"Something is missing that is not in the library (unknown {posterior['unknown']:.2f}){doubt}."
    named = [row.name for row in product.effects]
    names = listed([f"{row.name} ({row.probability:.2f})" for row in product.effects])
    beside = [f"{n} ({p:.2f})" for n, p in product.partners.items() if n not in named and p >= LIKELY]
    either = f"; in place of what is beside it: {', '.join(beside)}" if beside else ""
    return f"The model lacks {names}{doubt}{either}."


def _percent(part: float) -> str:
    return f"{100.0 * part:.2g} %"


def doubts_sentences(product: Diagnosis) -> list[str]:
    """Why a name does not stand by itself, that the verdict is at a limit, and that the search did not converge."""
    out: list[str] = []
    if product.doubts:
        names = listed(product.unknown_beside)
        out.append(joined("", [f"With {names} alone the story is not whole: ", joined("; ", product.doubts), "."]))
    if product.at_limit:
        out.append(f"This verdict is at a limit, where the last digits decide: {product.at_limit}.")
    if product.verdict != "none":
        out += [
            f"{name} is there, but too small to matter: {_percent(part)} of what goes through its equation."
            for name, part in product.too_small.items()
        ]
    if product.not_converged:
        out.append(joined("", ["The search did not converge: ", product.not_converged, "."]))
    return out


def poor_fit_sentence(product: Diagnosis) -> list[str]:
    """That even the best model is far from the test, and what explains most of it all the same."""
    left = product.leftover
    if left is None or not poor_fit(left):
        return []
    named = [row for row in product.tried if not row.unknown]
    best = max(named, key=lambda row: row.log_evidence, default=None)
    closest = f" ({listed(best.names)})" if best is not None and best.log_evidence > 0.0 else ""
    return [
        f"No model comes near this test: the best with names{closest} leaves a chi-square of {left:.1f} per "
        "observation, more than any simulated test by which probabilities were fitted. A stated value or a channel may "
        "be wrong, or more may be missing than the library has; names have no more than the part that is described, "
        "and none is excluded."
    ]


def equation_sentence(product: Diagnosis) -> list[str]:
    """Where names leave a choice, that all the likely ones are in one equation."""
    if product.verdict != "ambiguous" or max(product.posterior.values()) >= SET:
        return []
    equation, probability = next(iter(product.by_equation.items()))
    return [f"Whatever its name, it is in {EQUATIONS[equation]} ({probability:.2f})."] if probability >= SET else []


def left_over(product: Diagnosis) -> list[str]:
    """That more is left than the noise, where nothing was found that could be it."""
    chi_square, gap = product.compared.chi_square, product.gap
    if chi_square is None or chi_square <= MUCH:
        return []
    worst = max(gap.before, key=lambda channel: gap.before[channel] / gap.noise[channel])
    return [
        f"More is left than the noise, though: chi-square {chi_square:.1f} per observation, most of it in {worst}. "
        "Neither a listed effect nor a source that is steady, or comes and goes, explains it; an oscillation might."
    ]


def place_sentence(row: Place) -> str:
    """Where, from when to when and how much."""
    unit, value, std = _UNITS.get(row.source.unit, row.source.unit), row.source.value or 0.0, row.source.std or 0.0
    where = _BY_UNIT.get((row.equation, row.source.unit), EQUATIONS[row.equation])
    where += f" ({row.channel})" if row.channel else ""
    left = " Beside what is named, this is still open." if row.beside else ""
    if (kind := kind_of(row)) is not None:
        known = row.known_by(kind.known_by)
        assert known is not None
        return joined("", [kind.words(row, known, where, unit), left])
    start, end = row.t_start.value or 0.0, row.t_end.value or 0.0
    digits = 1 if end - start > BRIEF else 2
    low, _ = row.t_start.interval or (start, start)
    latest = " s (at the latest)" if start - low > GRADUAL * (row.t_start.std or 0.0) else ""
    span = f"From {start:.{digits}f}{latest} to {end:.{digits}f} s {where}"
    swing = row.rms.value or 0.0 if row.rms is not None else 0.0
    uneven = abs(value) < UNEVEN * swing
    size = said(swing, unit) if uneven else said(value, unit, ".3g", std)
    does = "goes up and down by {size} (rms; " if uneven else "differs by {size} on average ("
    return text(span + " " + does + "mostly in the {phase} phase).{left}", size=size, phase=row.phase, left=left)


def effect_sentence(row: NamedEffect) -> str:
    """What a named effect is, and whether it can be so large."""
    size = row.plausibility
    judged = "" if size.plausible is not False else " That is hard to believe: take the name with care."
    return text("{name}: {meaning}; {why}.{judged}", name=row.name, meaning=row.meaning, why=size.why, judged=judged)


def fade_sentence(compared: Compared) -> list[str]:
    """How long the fire took to go out, where that was longer than the chamber takes to empty."""
    if compared.fuel_fade is None or compared.abrupt_end is None:
        return []
    seconds, abrupt = (1e3 * (end.value or 0.0) for end in (compared.fuel_fade, compared.abrupt_end))
    if seconds < SLOW_FADE * abrupt:
        return []
    return [
        f"As the fuel ends chamber pressure and thrust fall within {seconds:.0f} ms; a chamber of this volume empties "
        f"within {abrupt:.0f} ms."
    ]


def gap_line(channel: str, gap: Gap) -> str:
    """Residual of a channel without and with the effects, and its noise."""
    unit = _UNITS.get(unit_of(channel), unit_of(channel))
    return text(
        "{channel}: rms {before} without, {after} with it; noise {noise}.",
        channel=channel,
        before=said(gap.before[channel], unit),
        after=said(gap.after[channel], unit),
        noise=said(gap.noise[channel], unit, ".2g"),
    )


def proof_sentences(product: Diagnosis) -> list[str]:
    """How much of the gap closes, and on which data; how an effect can be named though little of it does."""
    arms = {
        "same": "of the gap closes on the data that named it",
        "held_out": "on stretches that were held out",
        "other_test": "on another test, with the constants as found here",
        "placebo": "with the best wrong effect",
    }
    found = product.gap.closed_fraction
    closed = ((getattr(found, arm), text) for arm, text in arms.items())
    parts = [f"{100.0 * part:.0f} % {text}" for part, text in closed if part is not None]
    same, placebo = found.same, found.placebo
    if placebo is not None and placebo < 0.0:
        parts[-1] = f"the best wrong effect widens it by {-100.0 * placebo:.0f} %"
    said = [", ".join(parts) + "."] if parts else []
    if same is not None and placebo is not None and same >= LITTLE and same - placebo < BEYOND_PLACEBO:
        said.append("A wrong effect closes about as much: the gap that closes proves nothing here.")
    if product.effects and (same is None or same < LITTLE):
        where = "No channel is off by more than its noise" if same is None else "The gap that is left is another one"
        what = "smaller than the noise of single means, or in instants and the filling of the line"
        said.append(f"{where}: what names the effect is {what}, where no gap is measured.")
    return said
