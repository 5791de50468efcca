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
from hfanalysis.wording.numbers import MINUS, fixed, in_words
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
}
_ARMS = {
    "same": ("the same data", "there was no gap beyond the noise to close"),
    "held_out": ("stretches that were held out", "no gap there, or no fit of the rest came to an end"),
    "other_test": ("another test, constants frozen", "no other test of this stand that the model could be fitted to"),
    "placebo": ("placebo: the best wrong effect", "no other effect could be fitted"),
}


def probabilities(product: Diagnosis) -> Markup | None:
    """Every likely name with its probability, and how plausible its size is; None where no names competed."""
    if "none" not in product.posterior:
        return None
    posterior, inside = product.posterior, product.set90
    sizes = {**product.plausibility, **{row.name: row.plausibility for row in product.effects}}
    ordered = sorted(posterior, key=lambda name: (-posterior[name], name))
    kept = [name for name in ordered if posterior[name] >= SHOWN or name in inside or name in _ALWAYS]
    rows = [
        (
            Markup("<span>{}</span>").format(name),
            _probability(posterior[name]),
            _bar(posterior[name]),
            Markup('<span class="verdict good"><span aria-hidden="true">✓</span> yes</span>') if name in inside else "",
            _plausible(sizes[name]) if name in sizes else _MEANINGS.get(name, ""),
        )
        for name in kept
    ]
    beside = {name for name, p in product.partners.items() if p >= SHOWN}
    rest = sum(name not in kept and name not in beside for name in ordered)
    others = f" {rest} other names are below {SHOWN:g} each." if rest else ""
    caption = f"Probability of each name.{others} {_trust(product)}"
    columns = ("name", ">probability", "", "in the 90 % set", "how plausible its size is")
    return html.table("Probabilities", caption, columns, rows)


def partners(product: Diagnosis) -> Markup | None:
    """Effects that may be there beside the first, with their probabilities; None where one effect is all."""
    found, added = product.partners, [row.name for row in product.effects]
    kept = sorted((n for n, p in found.items() if p >= SHOWN or n in added), key=lambda n: (-found[n], n))
    if not kept:
        return None
    rows = [(name, _probability(found[name]), _bar(found[name]), "yes" if name in added else "") for name in kept]
    tried = ", by all sets of effects that were tried" if "none" in product.posterior else ""
    caption = f"Effects beside {(added or product.set90)[0]}{tried}."
    return html.table("Beside it", caption, ("name", ">probability", "", "added to the model"), rows)


def parameters(product: Diagnosis) -> Markup | None:
    """The effects' own constants, as they were added to the model; None where there is no model, or nothing was."""
    if product.constants is None:
        return None
    rows = [
        (
            Markup("<span>{}</span>").format(effect.name),
            name.replace("_", " "),
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
        return "They are raw evidences, not calibrated on simulated tests."
    return "They were calibrated on simulated tests." if product.probabilities_from else ""


def gaps(product: Diagnosis) -> Markup:
    """Residual of every channel without and with what is missing, beside the noise."""
    gap = product.gap
    arms = [size for size in (gap.calibrated, gap.before, gap.after, gap.noise) if size is not None]
    rows = [(LONG_NAMES.get(name, name), *(_in_unit(name, size.get(name)) for size in arms)) for name in gap.before]
    caption = (
        "Root mean square of measured less model over the burn, beside the noise of the averages that are compared. "
        f"With it: {with_what(product).removeprefix('with ')}.{_by_refitting(gap)}"
    )
    calibrated = (">calibrated",) if gap.calibrated is not None else ()
    columns = ("channel", *calibrated, ">base refitted", ">with it", ">noise")
    return html.table("Gap", caption, columns, rows)


def _by_refitting(gap: Gap) -> str:
    """That what refitting the base closes is no effect's."""
    part = gap.closed_by_refitting
    if part is None or part <= 0.0:
        return ""
    return (
        f" Refitting the base model's constants alone closes {_closed(part)} of the calibrated gap: no effect's merit."
    )


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
    columns = ("channel", "phase", ">without", ">with it")
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
        "Part of the gap of all channels that closes. A gap that shrinks on its own data proves no name: it should "
        "shrink on data that did not name it, and less with a wrong effect."
    )
    return html.table("Proof", caption, ("on", ">gap closed", ""), rows)


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
        said = f"m {values[0]} of the base refitted, {values[1]} {arm}." if arm else f"m {values[0]}."
        yield html.paragraph(Markup("Polytropic exponent of the vapor: <strong>{}</strong>").format(said), "told")
    names = sorted(without, key=lambda name: name != "m")
    arms = [
        (head, side)
        for head, side in (
            (">calibrated", product.constants.calibrated),
            (">base refitted", without),
            (">with it", better),
        )
        if side and (arm or side is not better)
    ]
    rows = [
        (_head(name), *(html.value(side[name], name) if name in side else "–" for _, side in arms)) for name in names
    ]
    caption = (
        "By the fit that they are from: as calibration.json has them without adopted effects, one after the other; of "
        "the base model refitted to all channels together; and of that with what was found. ± one standard deviation."
    )
    yield html.table("Constants", caption, ("constant", *(head for head, _ in arms)), rows)


def _head(name: str) -> Markup:
    words = _CONSTANTS.get(name)
    return html.symbol_and_words(name) if words is None else Markup('<span class="words">{}</span>').format(words)


def limits(product: Diagnosis) -> Markup | None:
    """The size below which every effect stays that is not in the model."""
    rows = [(Markup("<span>{}</span>").format(name), _limit(found)) for name, found in product.upper_limits.items()]
    caption = "Each of these, if it is there at all, is smaller than this with 95 % probability."
    return html.table("Upper limits", caption, ("effect", ">upper limit"), rows) if rows else None


def _limit(found: Quantity) -> Markup:
    if found.value is None:
        return Markup.escape(found.reason or "–")
    unit, factor = READ.get(found.unit, (found.unit, 1.0))
    value = factor * found.value
    return html.amount(value, unit, max(3, len(f"{abs(scale(unit)(value)):.0f}")), True)
