"""A diagnosis in words an engineer can act on."""

from __future__ import annotations

from hfanalysis.diagnose.answer.posterior import SET, poor_fit
from hfanalysis.diagnose.answer.tried_on import tried_sentences
from hfanalysis.diagnose.answer.verdict import LIKELIER
from hfanalysis.effects.learnt import STATES
from hfanalysis.inference.unknowns import kind_of
from hfanalysis.products.diagnosis import Compared, Diagnosis, Gap, NamedEffect, Place
from hfanalysis.record.channels import LONG_NAMES, unit_of
from hfanalysis.sentences import Text, capitalised, joined, said, text
from hfanalysis.wording.numbers import decimals_for, listed

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

_LACKING: dict[tuple[str, str], tuple[str, str]] = {
    ("tank_energy", "W"): (
        "{size} of heat enters the tank that the model does not have",
        "{size} of heat leaves the tank that the model keeps in it",
    ),
    ("tank_volume", "kg/s"): (
        "{size} of gas enters the tank that the model does not have",
        "{size} leaves the tank that the model keeps in it",
    ),
    ("tank_energy", "Pa"): (
        "the tank's pressure is {size} above the model's",
        "the tank's pressure is {size} below the model's",
    ),
    ("tank_volume", "Pa"): (
        "the tank's pressure is {size} above the model's at its temperature",
        "the tank's pressure is {size} below the model's at its temperature",
    ),
    ("injector", "kg/s"): ("{size} more flows through the injector", "{size} less flows through the injector"),
    ("injector", "1"): ("{size} more flows through the injector", "{size} less flows through the injector"),
    ("feed", "Pa"): ("the feed line loses {size} more pressure", "the feed line loses {size} less pressure"),
    ("grain", "kg/s"): ("the grain gives {size} more fuel", "the grain gives {size} less fuel"),
    ("grain", "1"): ("the grain gives {size} more fuel", "the grain gives {size} less fuel"),
    ("chamber_mass", "kg/s"): ("{size} more gas enters the chamber", "{size} less gas enters the chamber"),
    ("chamber_energy", "W"): ("{size} more heat stays in the burnt gas", "{size} less heat stays in the burnt gas"),
    ("nozzle", "N"): ("the nozzle gives {size} more thrust", "the nozzle gives {size} less thrust"),
}
"""What a source says by its equation and unit, where it is above zero and below it. A size takes ``{size}``."""

_NAMED_PLACES: dict[str, tuple[str, str]] = {
    "tank_leak": ("{size} leaves the tank that the model keeps in it", "{size} of gas enters the tank"),
    "throat_factor": ("the throat is {size} wider than the model's", "the throat is {size} narrower"),
    "thrust_factor": ("the nozzle gives {size} more thrust", "the nozzle gives {size} less thrust"),
    "temperature_factor": ("the burnt gas is {size} hotter", "the burnt gas is {size} colder"),
}
"""The same of places whose unit does not tell what they are."""

SIZE = "{size}"
"""Where a size comes in what a source says."""

LASTING = 0.05
"""Part of what was compared, from its end, within which what ends there is said to go on."""

LIKELY = 0.1
"""Probability from which on an effect that may be beside the first is mentioned."""

MUCH = 1.3
"""Chi-square per observation from which on more is left than noise that was estimated a little too small."""

PAIR = 2
"""Names with their probabilities in a sentence."""

AT_A_TIME = 3
"""Names in a sentence of what it is not."""

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
    out = [
        *headlines(product),
        *tried_sentences(product),
        *doubts_sentences(product),
        *poor_fit_sentence(product),
        *equation_sentence(product),
    ]
    out += [place_sentence(row, product.compared.end) for row in product.localisation]
    out += [line for row in product.effects for line in effect_sentences(row, product)]
    out += fade_sentence(product.compared)
    if product.verdict == "none":
        out += left_over(product)
    else:
        out += [line for channel in product.gap.before if (line := gap_line(channel, product.gap))]
        out += proof_sentences(product)
    out += learnt_sentences(product)
    if product.verdict == "unknown" and product.not_it:
        out += [f"It is not {name}." for name in not_it(product)]
    out += [f"What would decide: {text}." for text in product.decisive_measurements]
    return out


def learnt_sentences(product: Diagnosis) -> list[str]:
    """What of an unknown can be adopted as it was found, or why it cannot."""
    found = product.learnt
    if product.not_learnt:
        return [f"It cannot be adopted as it was found: {product.not_learnt}."]
    if found is None:
        return []
    alike = f", and nearly as well {listed([STATES[name][2] for name in found.alike])}" if found.alike else ""
    out = [f"Of the engine's states it follows best the {STATES[found.state][2]}{alike}."]
    if found.hint is not None:
        out.append(text("A hint at its form, not a name: {words}.", words=found.hint.words))
    part = f"{100.0 * found.closed_fraction:.0f} %"
    return [
        *out,
        f"As a table over that state it takes away {part} of the misfit.",
        "To adopt it: hfa diagnose TEST --apply --unknown.",
    ]


def not_it(product: Diagnosis) -> list[str]:
    """Effects that it is not, a few at a time, in the words of people."""
    names = [product.plain(name) for name in product.not_it]
    return [" nor ".join(names[i : i + AT_A_TIME]) for i in range(0, len(names), AT_A_TIME)]


def headline(product: Diagnosis) -> str:
    """What it is, with its probability, in one or a few sentences."""
    return " ".join(headlines(product))


def headlines(product: Diagnosis) -> list[str]:
    """What it is, with its probability; what cannot be excluded; and what may be beside it."""
    posterior = product.posterior
    label = product.effects[0].name if product.effects else product.verdict
    others = [f"{product.plain(n)} ({posterior[n]:.2f})" for n in product.set90 if n != label]
    doubt = [f"{capitalised(listed(others))} cannot be excluded."] if others else []
    if product.verdict == "none":
        return _small(product) or _nothing(product)
    if product.unknown_beside:
        known = listed([product.plain(name) for name in product.unknown_beside])
        what = f"Something is missing that has no name in the library, beside {known}"
        return [f"{what} (probability {posterior['unknown']:.2f}).", *doubt]
    if product.verdict == "unknown":
        return [
            f"Something is missing that has no name in the library (probability {posterior['unknown']:.2f}).",
            *doubt,
        ]
    named = [row.name for row in product.effects]
    names = [f"{product.plain(row.name)} ({row.probability:.2f})" for row in product.effects]
    further = [f"Beside that: {listed(names[i : i + PAIR])}." for i in range(PAIR, len(names), PAIR)]
    beside = [f"{product.plain(n)} ({p:.2f})" for n, p in product.partners.items() if n not in named and p >= LIKELY]
    either = [f"In place of what stands beside it may be {' or '.join(beside)}."] if beside else []
    return [f"Missing from the model, with probability: {listed(names[:PAIR])}.", *further, *doubt, *either]


def _nothing(product: Diagnosis) -> list[str]:
    posterior = product.posterior
    likeliest = max(posterior, key=lambda name: (posterior[name], name))
    if likeliest == "none" or posterior[likeliest] < LIKELIER * posterior["none"]:
        probability = f"probability that nothing is: {posterior['none']:.2f}"
        return [f"Nothing is missing from the model that these channels can show ({probability})."]
    name = capitalised(product.plain(likeliest))
    return [
        "Nothing is claimed to be missing, for too little in the data speaks for it.",
        f"{name} ({posterior[likeliest]:.2f}) is more probable, though, than nothing ({posterior['none']:.2f}).",
    ]


def _small(product: Diagnosis) -> list[str]:
    """What is there, but too small to matter."""
    return [
        f"{capitalised(product.plain(name))}{_probability(name, product)} is there, but too small to matter: "
        f"{100.0 * part:.2g} % of what it is part of."
        for name, part in product.too_small.items()
    ]


def _probability(name: str, product: Diagnosis) -> str:
    return f" ({product.posterior[name]:.2f})" if name in product.posterior else ""


def doubts_sentences(product: Diagnosis) -> list[str]:
    """Why a name does not stand by itself, that the verdict is at a limit, and what beside it is too small."""
    out: list[str] = []
    if product.doubts:
        names = listed([product.plain(name) for name in product.unknown_beside])
        out.append(joined("", [f"With {names} alone the story is not whole: ", joined("; ", product.doubts), "."]))
    if product.at_limit:
        out.append(f"This verdict is at a limit, where the last digits decide: {_plainly(product, product.at_limit)}.")
    if product.verdict != "none":
        out += _small(product)
    return out


def _plainly(product: Diagnosis, words: str) -> str:
    """Words with effects called what people call them."""
    for name in sorted(product.posterior, key=len, reverse=True):
        words = words.replace(name, product.plain(name))
    return words


def poor_fit_sentence(product: Diagnosis) -> list[str]:
    """That even the best model is far from the test, and what explains most of it all the same."""
    left = product.leftover
    if left is None or not poor_fit(left):
        return []
    named = [row for row in product.tried if not row.unknown]
    best = max(named, key=lambda row: row.log_evidence, default=None)
    known = best is not None and best.log_evidence > 0.0
    closest = f" ({listed(list(map(product.plain, best.names)))})" if best is not None and known else ""
    return [
        "No model comes near this test.",
        f"The best with names{closest} leaves a chi-square of {left:.1f} per observation.",
        "That is more than any simulated test left by which probabilities were fitted.",
        "A stated value or a channel may be wrong, or more may be missing than the library has.",
        "Names have no more than the part that is described, and none is excluded.",
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
        f"More is left than the noise, though: chi-square {chi_square:.1f} per observation, "
        f"most of it in {called(worst)}.",
        "Neither a listed effect nor a source that is steady, or comes and goes, explains it; an oscillation might.",
    ]


def called(channel: str) -> str:
    """A channel in words."""
    return LONG_NAMES.get(channel, channel.replace("_", " "))


def place_sentence(row: Place, last: float | None = None) -> str:
    """Where, from when to when and how much; ``last``: when what was compared ends [s after the opening]."""
    unit, value = _UNITS.get(row.source.unit, row.source.unit), row.source.value or 0.0
    left = " Beside what is named, this is still open." if row.beside else ""
    if (kind := kind_of(row)) is not None:
        known = row.known_by(kind.known_by)
        assert known is not None
        where = EQUATIONS[row.equation] + (f" ({called(row.channel)})" if row.channel else "")
        return joined("", [kind.words(row, known, where, unit), left])
    swing = row.rms.value or 0.0 if row.rms is not None else 0.0
    uneven = abs(value) < UNEVEN * swing
    size = said(swing, unit) if uneven else _sized(abs(value), row.source.std or 0.0, unit)
    mostly = "" if row.phase in ("", "purge") and not uneven else f" Most of it is in the {row.phase} phase."
    what = f"{_where(row)} goes up and down by {SIZE} (rms)" if uneven else _lacking(row)
    before, _, after = what.partition(SIZE)
    return joined("", [f"{_span(row, last)} {before}", size, f"{after}.{mostly}{_share(row)}{left}"])


def _part_of(part: float) -> str:
    """How large a part [-] is, in words that go before its whole; a whole and more in times it."""
    if 0.995 <= part < 1.05:
        return "all of"
    if part >= 1.05:
        return f"{part:.2g} times" if part < 99.5 else f"{part:.0f} times"
    return f"{100.0 * part:.2g} % of"


def _share(row: Place) -> str:
    """How large it is beside what it is a part of."""
    if row.part is None:
        return ""
    part = _part_of(row.part)
    if row.equation == "grain":
        return f" In all it is {part} the fuel, burnt at another time."
    whole = WHOLES.get(f"{row.equation} {row.source.unit}", WHOLES.get(row.equation, "the oxidizer's flow"))
    return f" At its largest it is {part} {'the largest reading' if row.channel else whole}."


WHOLES = {
    "feed": "the line's loss",
    "nozzle": "the thrust",
    "chamber_energy": "the heat that the gas carries",
    "tank_energy W": "the work of what flows out",
    "tank_energy Pa": "the tank's pressure",
    "tank_volume Pa": "the tank's pressure",
}
"""What a source is a part of, by its equation, or by equation and unit; of the others the oxidizer's flow."""


def _sized(value: float, std: float, unit: str) -> Text:
    """A size [SI] with its deviation, in a ``unit``, to two digits of the deviation."""
    of_one = float(said(1.0, unit, ".17g").split()[0])
    form = f".{min(8, decimals_for(of_one * value, of_one * std))}f"
    return said(value, unit, form, std, form)


def _where(row: Place) -> str:
    return called(row.channel) if row.channel else EQUATIONS.get(row.equation, row.equation)


def _lacking(row: Place) -> str:
    """What a source says, with a place for its size."""
    below = (row.source.value or 0.0) < 0.0
    if row.channel:
        return f"{called(row.channel)} reads {SIZE} too {'little' if below else 'much'}"
    known = _NAMED_PLACES.get(row.site) or _LACKING.get((row.equation, row.source.unit))
    if known:
        return known[below]
    return f"{EQUATIONS.get(row.equation, row.equation)} is {SIZE} {'below' if below else 'above'} the model's"


def _span(row: Place, last: float | None) -> str:
    """From when to when; that it goes on where nothing is compared after it."""
    start, end = row.t_start.value or 0.0, row.t_end.value or 0.0
    digits = 1 if end - start > BRIEF else 2
    low, _ = row.t_start.interval or (start, start)
    latest = " (at the latest)" if start - low > GRADUAL * (row.t_start.std or 0.0) else ""
    if last is not None and end >= (1.0 - LASTING) * last:
        return f"From {start:.{digits}f} s{latest} on"
    return f"From {start:.{digits}f} s{latest} to {end:.{digits}f} s"


def effect_sentences(row: NamedEffect, product: Diagnosis) -> list[str]:
    """What a named effect is, and whether it can be so large."""
    size, name = row.plausibility, capitalised(product.plain(row.name))
    if size.plausible is None:
        return [f"{name}: {row.meaning}.", joined("", [capitalised(size.why), "."])]
    judged = "plausible" if size.plausible else "hard to believe, so take the name with care"
    return [f"{name}: {row.meaning}.", text("Its size is {judged}: {why}.", judged=judged, why=size.why)]


def fade_sentence(compared: Compared) -> list[str]:
    """How long the fire took to go out, where that was longer than the chamber takes to empty."""
    if compared.fuel_fade is None or compared.abrupt_end is None:
        return []
    seconds, abrupt = (1e3 * (end.value or 0.0) for end in (compared.fuel_fade, compared.abrupt_end))
    if seconds < SLOW_FADE * abrupt:
        return []
    return [
        f"As the fuel ends chamber pressure and thrust fall within {seconds:.0f} ms.",
        f"A chamber of this volume empties within {abrupt:.0f} ms.",
    ]


def gap_line(channel: str, gap: Gap) -> str:
    """Misfit of a channel without and with the effects, and its noise."""
    unit = _UNITS.get(unit_of(channel), unit_of(channel))
    return text(
        "{channel} misfit: {before} refitted, {after} with the effects; noise {noise}.",
        channel=capitalised(called(channel)),
        before=said(gap.before[channel], unit, ".2g"),
        after=said(gap.after[channel], unit, ".2g"),
        noise=said(gap.noise[channel], unit, ".2g"),
    )


_ARMS = {
    "same": "{part} of the misfit goes on the data that named it.",
    "held_out": "{part} goes on stretches that were held out.",
    "other_test": "{part} goes on another test, with the constants as found here.",
    "placebo": "The best wrong effect takes away {part}.",
}


def proof_sentences(product: Diagnosis) -> list[str]:
    """How much of the misfit goes, and on which data; how an effect can be named though little of it does."""
    found = product.gap.closed_fraction
    closed = ((getattr(found, arm), words) for arm, words in _ARMS.items())
    said = [words.format(part=f"{100.0 * part:.0f} %") for part, words in closed if part is not None]
    same, placebo = found.same, found.placebo
    if placebo is not None and placebo < 0.0:
        said[-1] = f"The best wrong effect adds {-100.0 * placebo:.0f} % to it."
    if same is not None and placebo is not None and same >= LITTLE and same - placebo < BEYOND_PLACEBO:
        said.append("A wrong effect takes away about as much: that the misfit goes proves nothing here.")
    if product.effects and (same is None or same < LITTLE):
        where = "No channel is off by more than its noise" if same is None else "The misfit that is left is another one"
        said += [
            f"{where}.",
            "What names the effect is smaller than the noise of single means, or in instants and the line's filling.",
        ]
    return said
