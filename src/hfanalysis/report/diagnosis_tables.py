"""Tables of a diagnosis: probabilities, gaps, proof, constants and upper limits."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from markupsafe import Markup

from hfanalysis.products.diagnosis import Diagnosis, Gap, Plausibility
from hfanalysis.quantity import Quantity
from hfanalysis.record.channels import LONG_NAMES, unit_of
from hfanalysis.report import html
from hfanalysis.report.diagnosis_charts import READ, with_what
from hfanalysis.wording.numbers import MINUS, fixed, in_words, listed
from hfanalysis.wording.scales import scale

SHOWN = 0.005
"""Probability from which on a name has a row of its own."""

_ALWAYS = ("none", "unknown")
_MEANINGS = {
    "none": "nothing is missing that these channels can show",
    "unknown": "something that is not in the library",
}
_CONSTANTS = {
    "area": "effective area of the injector",
    "loss_factor": "feed loss coefficient",
    "oxidizer_mass": "oxidizer loaded",
    "temperature": "tank temperature at the start",
    "volume": "volume of the tank",
    "fuel_mass": "fuel loaded",
    "grain_length": "length of the grain",
    "outer_radius": "outer radius of the grain",
    "fuel_density": "density of the fuel",
    "dead_volume": "chamber's volume beside the port",
    "throat_area": "area of the throat",
    "exit_area": "area of the exit",
}
_ARMS = {
    "same": ("the same data", "there was no misfit beyond the noise"),
    "held_out": ("stretches that were held out", "no misfit there, or no fit of the rest came to an end"),
    "other_test": ("another test, constants frozen", "no other test of this stand that the model could be fitted to"),
    "placebo": ("placebo: the best wrong effect", "no other effect could be fitted"),
}


def probabilities(product: Diagnosis) -> Markup | None:
    """Every name that is likely, first or beside it: its probability, size, whether that can be, and what would
    decide; None where no names competed.
    """
    if "none" not in product.posterior:
        return partners(product)
    names = _likely(product)
    rows = [_candidate(name, product) for name in names]
    rest = sum(name not in names for name in product.posterior if name not in product.partners)
    others = f" {rest} other names are below {SHOWN:g} each." if rest else ""
    held = listed([product.plain(name) for name in product.set90])
    caption = f"What may be missing. 90 % of the probability of the first holds {held}.{others} {_trust(product)}"
    columns = ("name", ">probability", "", ">size", "can it be so large?", "what would decide")
    return html.table("Probabilities", caption, columns, rows)


def _likely(product: Diagnosis) -> list[str]:
    """What is named, then what may be, the most probable first; that nothing is, and what has no name, come last."""
    odds = {name: _odds(name, product) for name in {**product.posterior, **product.partners}}
    named = [row.name for row in product.effects]
    kept = [n for n in odds if n not in _ALWAYS and (odds[n] >= SHOWN or n in product.set90) and n not in named]
    last = sorted(_ALWAYS, key=lambda name: -odds.get(name, 0.0))
    return [*named, *sorted(kept, key=lambda name: (-odds[name], name)), *last]


def _odds(name: str, product: Diagnosis) -> float:
    """The probability of being there, first or beside the first."""
    return max(product.posterior.get(name, 0.0), product.partners.get(name, 0.0))


def _candidate(name: str, product: Diagnosis) -> tuple[Any, ...]:
    effect = next((row for row in product.effects if row.name == name), None)
    plausible = effect.plausibility if effect is not None else product.plausibility.get(name)
    size: Markup | str = ""
    if effect is not None and effect.parameters:
        first = next(iter(effect.parameters.values()))
        size = html.value(first) + Markup("<br>") + Markup('<span class="std">{}</span>').format(html.interval(first))
    judged = _plausible(plausible) if plausible is not None else _MEANINGS.get(name, "")
    return (
        Markup("<span>{}</span>{}").format(product.plain(name), _twins(name, product)),
        _probability(_odds(name, product)),
        _bar(_odds(name, product)),
        size,
        judged,
        _decisive(name, product),
    )


def _twins(name: str, product: Diagnosis) -> Markup:
    """What it is hardly told apart from, and how probable that is."""
    group = next((group for group in product.twins if name in group), ())
    twins = [f"{product.plain(other)} ({_probability(_odds(other, product))})" for other in group if other != name]
    if not twins:
        return Markup()
    return Markup('<span class="because">hardly told apart from {}</span>').format(listed(twins))


def _decisive(name: str, product: Diagnosis) -> str:
    lead = f"{product.plain(name)}: "
    return next((text.removeprefix(lead) for text in product.decisive_measurements if text.startswith(lead)), "")


def partners(product: Diagnosis) -> Markup | None:
    """Effects that may be there beside the first, with their probabilities; None where one effect is all."""
    found, added = product.partners, [row.name for row in product.effects]
    kept = sorted((n for n, p in found.items() if p >= SHOWN or n in added), key=lambda n: (-found[n], n))
    if not kept:
        return None
    rows = [(product.plain(n), _probability(found[n]), _bar(found[n]), "yes" if n in added else "") for n in kept]
    caption = f"Effects beside {product.plain((added or product.set90)[0])}."
    return html.table("Beside it", caption, ("name", ">probability", "", "added to the model"), rows)


def parameters(product: Diagnosis) -> Markup | None:
    """The effects' own constants, as they were added to the model; None where there is no model, or nothing was."""
    if product.constants is None:
        return None
    rows = [
        (
            Markup("<span>{}</span>").format(product.plain(effect.name)),
            LONG_NAMES.get(name, name.replace("_", " ")),
            html.value(found),
            html.interval(found),
        )
        for effect in product.effects
        for name, found in effect.parameters.items()
    ]
    caption = "Constants of what was added to the model, ± one standard deviation, and within which 95 % lie."
    columns = ("effect", "constant", ">value", ">95 %")
    return html.table("Constants of the effects", caption, columns, rows) if rows else None


def _probability(value: float) -> str:
    return "< 0.001" if value < 0.001 else fixed(value, 3 if value < 0.01 or value > 0.99 else 2)


def _bar(value: float) -> Markup:
    shape = '<svg class="share" viewBox="0 0 100 10" preserveAspectRatio="none" aria-hidden="true">'
    return Markup(shape + '<rect class="all" width="100" height="10"/><rect width="{}" height="10"/></svg>').format(
        f"{100.0 * value:.1f}"
    )


def _plausible(size: Plausibility) -> Markup:
    sign: dict[bool | None, tuple[str, str, str]] = {
        True: ("good", "✓", "plausible"),
        False: ("bad", "✕", "hard to believe"),
    }
    kind, mark, word = sign.get(size.plausible, ("open", "?", "not judged"))
    badge = Markup('<span class="verdict {}"><span aria-hidden="true">{}</span> {}</span> {}')
    return badge.format(kind, mark, word, html.switchable(size.why))


def _trust(product: Diagnosis) -> str:
    """What the probabilities rest on."""
    if product.probabilities_from == "raw evidences":
        return "Probabilities are raw evidences, not calibrated on simulated tests."
    return "Probabilities were calibrated on simulated tests." if product.probabilities_from else ""


def gaps(product: Diagnosis) -> Markup:
    """Misfit of every channel without and with what is missing, beside the noise."""
    gap = product.gap
    arms = [size for size in (gap.calibrated, gap.before, gap.after, gap.noise) if size is not None]
    rows = [(LONG_NAMES.get(name, name), *(_in_unit(name, size.get(name)) for size in arms)) for name in gap.before]
    caption = (
        "Root mean square of measured less model over the burn, beside the noise of the averages that are compared. "
        f"Fitted to all channels: refitted and with the effects.{_by_refitting(gap)}"
    )
    calibrated = (">calibrated",) if gap.calibrated is not None else ()
    columns = ("channel", *calibrated, ">refitted", ">with the effects", ">noise")
    return html.table("Misfit", caption, columns, rows)


def _by_refitting(gap: Gap) -> str:
    """That what refitting the base closes is no effect's."""
    part = gap.closed_by_refitting
    if part is None or part <= 0.0:
        return ""
    return f" Refitting alone takes away {_closed(part)} of the misfit as calibrated. That is no effect's merit."


def gaps_by_phase(product: Diagnosis) -> Markup | None:
    """What is beyond the noise, by phase."""
    found = product.gap.by_phase
    if found is None:
        return None
    rows = [
        (
            LONG_NAMES.get(name, name),
            in_words(phase),
            _in_unit(name, size),
            _in_unit(name, found.after.get(name, {}).get(phase)),
        )
        for name, phases in found.before.items()
        for phase, size in phases.items()
    ]
    caption = "What is beyond the noise: square root of max(0, rms² − noise²)."
    columns = ("channel", "phase", ">refitted", ">with the effects")
    return html.table("Gap by phase", caption, columns, rows) if rows else None


def _in_unit(channel: str, value: float | None) -> Markup:
    return html.amount(value, unit_of(channel), 3, True)


def proof(product: Diagnosis) -> Markup:
    """How much of the gap closes, and on which data; in words where it is not known."""
    found, other = product.gap.closed_fraction, product.gap.other_test
    rows: list[tuple[Any, ...]] = []
    for arm, (words, why) in _ARMS.items():
        named = f"{words} ({other.test})" if arm == "other_test" and other is not None else words
        part: float | None = getattr(found, arm)
        rows.append((named, _closed(part), "" if part is not None else why))
    free = product.gap.closed_by_free_form
    if free is not None:
        rows.append(("placebo: a free curve of equal freedom", _closed(free), ""))
    caption = (
        "Part of the misfit of all channels that goes. On its own data that proves no name. It should go on data that "
        "did not name it, and less of it with a wrong effect."
    )
    return html.table("Proof", caption, ("on", ">misfit gone", ""), rows)


def _closed(part: float | None) -> str:
    if part is None:
        return "–"
    return f"{100.0 * part:.0f} %".replace("-", MINUS) + (" (wider)" if part < 0.0 else "")


def constants(product: Diagnosis) -> Iterator[Markup]:
    """The calibrated constants without and with the effects, m first; nothing where no model was fitted."""
    if product.constants is None:
        return
    without, better = product.constants.without, product.constants.better
    arm = with_what(product)
    if "m" in without and without["m"].value is not None:
        values = [fixed(side["m"].value or 0.0, 2) for side in (without, better)]
        said = f"m {values[0]} refitted, {values[1]} with the effects." if arm else f"m {values[0]}."
        yield html.paragraph(Markup("Polytropic exponent of the vapor: <strong>{}</strong>").format(said), "told")
    names = sorted(without, key=lambda name: name != "m")
    arms = [
        (head, side)
        for head, side in (
            (">calibrated", product.constants.calibrated),
            (">refitted", without),
            (">with the effects", better),
        )
        if side and (arm or side is not better)
    ]
    rows = [
        (_head(name), *(html.value(side[name], name) if name in side else "–" for _, side in arms)) for name in names
    ]
    caption = (
        "By the fit that they are from. Calibrated: one after the other, without adopted effects. Refitted: the base "
        "model to all channels together. With the effects: the same with what was found. ± one standard deviation."
    )
    yield html.table("Constants", caption, ("constant", *(head for head, _ in arms)), rows)


def _head(name: str) -> Markup:
    words = _CONSTANTS.get(name)
    return html.symbol_and_words(name) if words is None else Markup('<span class="words">{}</span>').format(words)


def limits(product: Diagnosis) -> Markup | None:
    """The size below which every effect stays that is not in the model."""
    rows = [
        (Markup("<span>{}</span>").format(product.plain(name)), _limit(found))
        for name, found in product.upper_limits.items()
    ]
    caption = "Each of these, if it is there at all, is smaller than this with 95 % probability."
    return html.table("Upper limits", caption, ("effect", ">upper limit"), rows) if rows else None


def _limit(found: Quantity) -> Markup:
    if found.value is None:
        return Markup.escape(found.reason or "–")
    unit, factor = READ.get(found.unit, (found.unit, 1.0))
    value = factor * found.value
    return html.amount(value, unit, max(3, len(f"{abs(scale(unit)(value)):.0f}")), True)
