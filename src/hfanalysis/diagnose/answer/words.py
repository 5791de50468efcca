"""A diagnosis in words an engineer can act on."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hfanalysis.diagnose.answer.posterior import SET, poor_fit
from hfanalysis.diagnose.answer.verdict import LIKELIER
from hfanalysis.inference.observations.observed import FADE
from hfanalysis.inference.unknown import Amount
from hfanalysis.inference.unknowns import kind_of
from hfanalysis.record.channels import unit_of
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

_UNITS = {"Pa": ("bar", 1e-5), "W": ("kW", 1e-3), "kg/s": ("g/s", 1e3), "1": ("%", 100.0)}
_CHANNELS = {"Pa": ("bar", 1e-5), "N": ("N", 1.0), "kg": ("kg", 1.0)}


def story(product: Mapping[str, Any]) -> list[str]:
    """The whole verdict, sentence by sentence."""
    out = [headline(product), *poor_fit_sentence(product), *equation_sentence(product)]
    out += [place_sentence(row) for row in product["localisation"]]
    out += [effect_sentence(row) for row in product["effects"]]
    out += fade_sentence(product["compared"])
    if product["verdict"] == "none":
        out += left_over(product)
    else:
        out += [line for channel in product["gap"]["before"] if (line := gap_line(channel, product["gap"]))]
        out += proof_sentences(product)
    if product["verdict"] == "unknown" and product["not_it"]:
        out.append(f"It is none of these: {', '.join(product['not_it'])}.")
    if product["decisive_measurements"]:
        out.append("What would decide: " + "; ".join(product["decisive_measurements"]) + ".")
    return out


def headline(product: Mapping[str, Any]) -> str:
    """What it is, with its probability."""
    posterior = product["posterior"]
    label = product["effects"][0]["name"] if product["effects"] else product["verdict"]
    others = [f"{n} ({posterior[n]:.2f})" for n in product["set90"] if n != label]
    if product["verdict"] == "none":
        likeliest = max(posterior, key=lambda name: (posterior[name], name))
        if likeliest == "none" or posterior[likeliest] < LIKELIER * posterior["none"]:
            return f"Nothing is missing from the model that these channels can show (none {posterior['none']:.2f})."
        return (
            f"Nothing is claimed to be missing: {likeliest} ({posterior[likeliest]:.2f}) is more probable than none "
            f"({posterior['none']:.2f}), but too little in the data speaks for it."
        )
    doubt = f"; {listed(others)} cannot be excluded" if others else ""
    if product["verdict"] == "unknown":
        return f"Something is missing that is not in the library (unknown {posterior['unknown']:.2f}){doubt}."
    named = [row["name"] for row in product["effects"]]
    names = listed([f"{row['name']} ({row['probability']:.2f})" for row in product["effects"]])
    beside = [f"{n} ({p:.2f})" for n, p in product["partners"].items() if n not in named and p >= LIKELY]
    either = f"; in place of what is beside it: {', '.join(beside)}" if beside else ""
    return f"The model lacks {names}{doubt}{either}."


def poor_fit_sentence(product: Mapping[str, Any]) -> list[str]:
    """That even the best model is far from the test, and what explains most of it all the same."""
    left = product["leftover"]
    if not poor_fit(left):
        return []
    named = [row for row in product["tried"] if not row["unknown"]]
    best = max(named, key=lambda row: row["log_evidence"], default=None)
    closest = f" ({listed(best['names'])})" if best is not None and best["log_evidence"] > 0.0 else ""
    return [
        f"No model comes near this test: the best with names{closest} leaves a chi-square of {left:.1f} per "
        "observation, more than any simulated test by which probabilities were fitted. A stated value or a channel may "
        "be wrong, or more may be missing than the library has; names have no more than the part that is described, "
        "and none is excluded."
    ]


def equation_sentence(product: Mapping[str, Any]) -> list[str]:
    """Where names leave a choice, that all the likely ones are in one equation."""
    if product["verdict"] != "ambiguous" or max(product["posterior"].values()) >= SET:
        return []
    equation, probability = next(iter(product["by_equation"].items()))
    return [f"Whatever its name, it is in {EQUATIONS[equation]} ({probability:.2f})."] if probability >= SET else []


def left_over(product: Mapping[str, Any]) -> list[str]:
    """That more is left than the noise, where nothing was found that could be it."""
    chi_square, gap = product["compared"]["chi_square"], product["gap"]
    if chi_square <= MUCH:
        return []
    worst = max(gap["before"], key=lambda channel: gap["before"][channel] / gap["noise"][channel])
    return [
        f"More is left than the noise, though: chi-square {chi_square:.1f} per observation, most of it in {worst}. "
        "Neither a listed effect nor a source that is steady, or comes and goes, explains it; an oscillation might."
    ]


def place_sentence(row: Mapping[str, Any]) -> str:
    """Where, from when to when and how much."""
    unit, factor = _UNITS.get(row["source"].unit, (row["source"].unit, 1.0))
    value, std = factor * (row["source"].value or 0.0), factor * (row["source"].std or 0.0)
    where = _BY_UNIT.get((row["equation"], row["source"].unit), EQUATIONS[row["equation"]])
    where += f" ({row['channel']})" if row.get("channel") else ""
    left = " Beside what is named, this is still open." if row.get("beside") else ""
    if (kind := kind_of(row)) is not None:
        return kind.words(row, where, Amount(value, std, unit)) + left
    start, end = row["t_start"], row["t_end"]
    digits = 1 if end.value - start.value > BRIEF else 2
    latest = " s (at the latest)" if start.value - start.interval[0] > GRADUAL * start.std else ""
    span = f"From {start.value:.{digits}f}{latest} to {end.value:.{digits}f} s {where}"
    if "rms" in row and abs(value) < UNEVEN * factor * row["rms"].value:
        swing = factor * row["rms"].value
        return f"{span} goes up and down by {swing:.3g} {unit} (rms; mostly in the {row['phase']} phase).{left}"
    return f"{span} differs by {value:.3g} ± {std:.2g} {unit} on average (mostly in the {row['phase']} phase).{left}"


def effect_sentence(row: Mapping[str, Any]) -> str:
    """What a named effect is, and whether it can be so large."""
    size = row["plausibility"]
    judged = "" if size["plausible"] is not False else " That is hard to believe: take the name with care."
    return f"{row['name']}: {row['meaning']}; {size['why']}.{judged}"


def fade_sentence(compared: Mapping[str, Any]) -> list[str]:
    """How long the fire took to go out, where that was longer than the chamber takes to empty."""
    if FADE not in compared:
        return []
    seconds, abrupt = (1e3 * compared[name].value for name in (FADE, "abrupt_end"))
    if seconds < SLOW_FADE * abrupt:
        return []
    return [
        f"As the fuel ends chamber pressure and thrust fall within {seconds:.0f} ms; a chamber of this volume empties "
        f"within {abrupt:.0f} ms."
    ]


def gap_line(channel: str, gap: Mapping[str, Any]) -> str:
    """Residual of a channel without and with the effects, and its noise."""
    unit, factor = _CHANNELS[unit_of(channel)]
    before, after, noise = (factor * gap[key][channel] for key in ("before", "after", "noise"))
    return f"{channel}: rms {before:.3g} {unit} without, {after:.3g} {unit} with it; noise {noise:.2g} {unit}."


def proof_sentences(product: Mapping[str, Any]) -> list[str]:
    """How much of the gap closes, and on which data; how an effect can be named though little of it does."""
    arms = {
        "same": "of the gap closes on the data that named it",
        "held_out": "on stretches that were held out",
        "other_test": "on another test, with the constants as found here",
        "placebo": "with the best wrong effect",
    }
    found = product["gap"]["closed_fraction"]
    parts = [f"{100.0 * found[arm]:.0f} % {text}" for arm, text in arms.items() if found.get(arm) is not None]
    same, placebo = found.get("same"), found.get("placebo")
    if placebo is not None and placebo < 0.0:
        parts[-1] = f"the best wrong effect widens it by {-100.0 * placebo:.0f} %"
    said = [", ".join(parts) + "."] if parts else []
    if same is not None and placebo is not None and same >= LITTLE and same - placebo < BEYOND_PLACEBO:
        said.append("A wrong effect closes about as much: the gap that closes proves nothing here.")
    if product.get("effects") and (same is None or same < LITTLE):
        where = "No channel is off by more than its noise" if same is None else "The gap that is left is another one"
        what = "smaller than the noise of single means, or in instants and the filling of the line"
        said.append(f"{where}: what names the effect is {what}, where no gap is measured.")
    return said
