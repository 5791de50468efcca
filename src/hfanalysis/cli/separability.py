"""``hfa effects TEST``: what the channels of a test can tell apart, before its residuals are looked at."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from rich.text import Text

from hfanalysis.cli import effects as listing
from hfanalysis.cli.exit_status import put
from hfanalysis.cli.paper import new_table, paper
from hfanalysis.cli.perform import bring
from hfanalysis.cli.request import Request
from hfanalysis.diagnose.added_sensors import Sensor
from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.diagnose.separability import NOMINAL, SEEN, TWINS, Outlook, look_ahead
from hfanalysis.effects import FOLDER, library
from hfanalysis.errors import AbsentError
from hfanalysis.products.disk import to_json
from hfanalysis.products.effects import AddedSensor, EffectLibrary, Pair, Rival, Separability, TwinPair, Visibility
from hfanalysis.report.names import called
from hfanalysis.stages.diagnose import subject_of
from hfanalysis.wording import numbers as wording

RIVALS = 3
"""How many of its closest rivals are listed for every effect."""


def separability(test: str, root: Path, out: Path | None, as_json: bool) -> None:
    """Show it; calibrates first what has not been calibrated. Raises AbsentError where there is no engine to run."""
    context = bring("calibrate", Request(test, root, out, as_json, force=False, quiet=False))
    subject, found = subject_of(context), library(root / FOLDER)
    try:
        outlook = look_ahead(*subject.compared(), Catalogue(found, subject.stated()))
    except (ValueError, ArithmeticError) as error:
        raise AbsentError(f"{test}: the calibrated engine cannot be run: {error}") from error
    product = product_of(test, outlook)
    if as_json:
        put(to_json(EffectLibrary(effects=listing.product(found).effects, test=product).to_json()))
        return
    show(product)


def product_of(test: str, outlook: Outlook) -> Separability:
    """What can be told apart, as data in SI."""
    twins = outlook.twins
    return Separability(
        id=test,
        channels=tuple(outlook.channels),
        seen_from=SEEN,
        nominal=NOMINAL,
        twins_below=TWINS,
        effects={name: _visibility(name, outlook) for name in outlook.effects},
        twins=tuple(TwinPair(effects=p, apart=d, declared=_declared(p, outlook)) for p, d in twins.items()),
        declared_twins_apart=tuple(
            Pair(effects=p, apart=outlook.now.apart(*p)) for p in _declarations(outlook) if p not in twins
        ),
        sensors={sensor.name: _added(sensor, outlook) for sensor in outlook.extra},
        called={name: effect.plain_name for name, effect in outlook.effects.items() if effect.plain_name},
    )


def _added(sensor: Sensor, outlook: Outlook) -> AddedSensor:
    return AddedSensor(
        words=sensor.words,
        accuracy=sensor.accuracy,
        unit=sensor.unit,
        twins=tuple(Pair(effects=p, apart=d) for p, d in outlook.twins_with(sensor).items()),
        shows=tuple(outlook.shown(sensor)),
    )


def _visibility(name: str, outlook: Outlook) -> Visibility:
    effect, strength = outlook.effects[name], outlook.strength_at(name, SEEN)
    rivals = [n for n in outlook.visible if n != name] if name in outlook.visible else []
    closest = sorted((outlook.now.at_nominal(name, rival), rival) for rival in rivals)[:RIVALS]
    return Visibility(
        strength=effect.strength.name,
        unit=effect.strength.unit,
        typical=effect.strength.typical,
        detectability=outlook.now.detectability(name),
        seen_at=strength if outlook.in_reach(name) else None,
        in_reach=outlook.in_reach(name),
        decisive=effect.decisive,
        rivals=tuple(Rival(name=n, apart=d, correlation=outlook.now.correlation(name, n)) for d, n in closest),
    )


def _declared(pair: tuple[str, str], outlook: Outlook) -> bool:
    one, other = pair
    return other in outlook.effects[one].twins or one in outlook.effects[other].twins


def _declarations(outlook: Outlook) -> list[tuple[str, str]]:
    """Pairs of visible effects that the library declares twins."""
    seen = outlook.visible
    return [(a, b) for i, a in enumerate(seen) for b in seen[i + 1 :] if _declared((a, b), outlook)]


def show(product: Separability) -> None:
    """Print it for people."""
    console = paper()
    title = f"{product.id}: what {', '.join(map(called, product.channels))} can show"
    table = new_table("effect", "typical size", "stands out by", "seen from", "closest rivals", title=title)
    for name, row in product.effects.items():
        rivals = ", ".join(f"{_plain(product, r.name)} {r.apart:.1f}" for r in row.rivals[:2])
        table.add_row(_plain(product, name), _size(row.typical, row), f"{row.detectability:.1f}", _seen(row), rivals)
    console.print(table)
    for sentence in sentences(product):
        console.print(Text(sentence), soft_wrap=not console.is_terminal)


def _plain(product: Separability, effect: str) -> str:
    """What people call an effect, a team's own among them."""
    return product.called.get(effect) or called(effect)


def _size(strength: float, row: Visibility) -> str:
    """Two digits, in the unit of people at a stand."""
    factor, unit = wording.people_unit(row.unit)
    return f"{wording.tidy(float(f'{factor * strength:.2g}'), 6)} {unit.strip('-')}".strip()


def _seen(row: Visibility) -> str:
    return "never" if row.seen_at is None else _size(row.seen_at, row)


def sentences(product: Separability) -> list[str]:
    """Twins, what would separate them, and what the numbers mean."""
    out, plain = [], partial(_plain, product)
    for pair in product.twins:
        one, other = pair.effects
        out += [
            f"twins: {plain(one)} and {plain(other)}: {pair.apart:.1f} of {NOMINAL:g}",
            f"  {_advice(one, other, product)}",
        ]
    if not out:
        out = ["twins: none"]
    declared = [f"{' and '.join(map(plain, pair.effects))} {pair.apart:.1f}" for pair in product.declared_twins_apart]
    if declared:
        out.append(f"called twins in the library, but told apart here: {', '.join(declared)}")
    for name, sensor in product.sensors.items():
        if sensor.shows:
            out.append(
                f"{name} ({sensor.words}) would show {', '.join(map(plain, sensor.shows))} of typical strength as well"
            )
    return [
        *out,
        "Stands out by: standard deviations of the noise, at the typical size.",
        f"Seen from: the size that stands out by {SEEN:g}.",
        f"Closest rivals: what they leave of an effect that stands out by {NOMINAL:g}; twins less than {TWINS:g}.",
        "Only noise, times and constants of the test are used.",
    ]


def _advice(one: str, other: str, product: Separability) -> str:
    """What would tell two twins apart."""
    tried = {
        f"{name} ({sensor.words})": pair.apart
        for name, sensor in product.sensors.items()
        for pair in sensor.twins
        if set(pair.effects) == {one, other}
    }
    good = [words for words, d in tried.items() if d >= product.twins_below]
    if good:
        return f"told apart by: {', '.join(good)}"
    best = max(tried, key=lambda words: tried[words], default="none")
    decisive = dict.fromkeys(product.effects[n].decisive for n in (one, other))
    known = "; or ".join(filter(None, decisive)) or "nothing that is known"
    return (
        f"told apart by none of the sensors that were tried; best is {best}: {tried.get(best, 0.0):.1f}. "
        f"The library asks for: {known}"
    )
