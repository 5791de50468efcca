"""What a stage found, as people read it at a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table
from rich.text import Text

from hfanalysis.cli.paper import doubted, marks, new_table, paper, print_quantities, print_values, soft
from hfanalysis.health.reasons import Doubt, reasons
from hfanalysis.products.health import Finding
from hfanalysis.products.model import AdoptedEffect, Part
from hfanalysis.quantity import Quantity
from hfanalysis.stages import way_to
from hfanalysis.stages.base import Context, load_stage
from hfanalysis.wording import numbers as wording
from hfanalysis.wording.numbers import in_words, ordered, shown

if TYPE_CHECKING:  # each stage reads its own: so a command starts in no time
    from hfanalysis.products.calibration import RegressionBasis
    from hfanalysis.products.campaign import CommonLaw
    from hfanalysis.products.effects import EffectEntry, EffectLibrary
    from hfanalysis.products.engines import Designed, NextTests, Simulated, Spread
    from hfanalysis.products.quick import QuickLook
    from hfanalysis.products.reconstruction import Reconstruction
    from hfanalysis.products.validation import Validation


MOST_SHARES, LEAST_SHARE = 4, 0.01
"""Inputs that are named of those whose spread costs, and the share of the variance from which on [-]. Source: by
choice."""


def show(name: str, context: Context) -> None:
    """Print what a stage ("run": all of them) found, on standard output."""
    console = paper()
    console.print(_headline(context))
    for stage in way_to(name) if name == "run" else (name,):
        if stage not in context.absent:
            _SHOWN.get(stage, partial(_written, stage))(context, console)
    if adopted := _adopted(name, context):
        console.print(Text(adopted), soft_wrap=soft(console))


def show_run(context: Context) -> None:
    """Print on one screen what all stages found: four sentences, six numbers, and where the rest is."""
    from hfanalysis.report.glance import four, key_numbers, motor_class
    from hfanalysis.stages.material import load

    console, material = paper(), load(context)
    console.print(_headline(context))
    for told in four(material):
        console.print(_told(told.head, told.words))
    numbers = key_numbers(material)
    table = new_table("", "value", "± std", "unit", "", title="")
    for name, quantity in numbers.items():
        text = shown(quantity, "si", name)
        letter = motor_class(material) if name == "total_impulse" else ""
        unit = f"{text.unit}, class {letter}" if letter else text.unit
        table.add_row(in_words(name), text.value, text.std, unit, doubted(quantity, material.reasons))
    if numbers:
        console.print(table)
    console.print(Text(f"page: {context.product('report.html')}"), soft_wrap=soft(console))
    console.print(Text(f"everything that was found: hfa run {context.id} --verbose"), soft_wrap=soft(console))


def _told(head: str, words: str) -> Table:
    """A sentence beside the question that it answers, wrapped at words."""
    table = Table.grid(padding=(0, 2))
    table.add_column(width=11, style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    table.add_row(head, Text(words))
    return table


def _adopted(name: str, context: Context) -> str:
    """The effects with which a stage's product was made, in words."""
    product = _MADE_WITH_EFFECTS.get(name)
    if product is None or not context.product(product).is_file():
        return ""
    found = [AdoptedEffect.from_json(e) for e in context.read_json(product)["effects"]]
    if not found:
        return ""
    from hfanalysis.report.names import called

    return wording.adopted_in_words(found, called)


_MADE_WITH_EFFECTS = {
    "calibrate": "calibration.json",
    "validate": "validation.json",
    "flight": "flight.json",
    "run": "validation.json",
}


def _headline(context: Context) -> Text:
    test = context.definition.test
    words = [test.id, wording.KINDS.get(test.kind, test.kind), str(test.date or "")]
    source = wording.SOURCES.get(test.source, test.source)
    style = "" if test.source == "measured" else "bold yellow"
    return Text("  ").join([Text("  ".join(filter(None, words)), style="bold"), Text(source, style=style)])


def _reasons(context: Context) -> list[Doubt]:
    """Why channels of a test are doubted, in the order of their numbers."""
    from hfanalysis.products.health import Health

    return reasons(context.read(Health).channels)


def _ingest(context: Context, console: Console) -> None:
    from hfanalysis.products.ingest import Ingest

    table = new_table("channel", "column", "unit", "samples", "rate", "least", "largest", "flags", title="channels")
    for name, row in context.read(Ingest).channels.items():
        factor, unit = wording.people_unit(row.unit)
        ends = [Text("–" if end is None else f"{factor * end:.4g}") for end in (row.least, row.largest)]
        flags = ", ".join(f"{count} {flag}" for flag, count in row.flags.items())
        rate = "" if row.rate is None else f"{row.rate:.4g} Hz"
        table.add_row(name, Text(row.label), unit, str(row.samples), rate, *ends, flags)
    console.print(table)


def _health(context: Context, console: Console) -> None:
    from hfanalysis.products.health import HEALTHY, SUSPECT, Health

    product = context.read(Health)
    known = reasons(product.channels)
    styles = {HEALTHY: "green", SUSPECT: "yellow"}
    table = new_table("channel", "verdict", "", title="health of the channels")
    for name, channel in product.channels.items():
        numbered = {f: n for n, doubt in enumerate(known, 1) for f in channel.findings if _is(doubt, name, f)}
        what = dict.fromkeys(
            f"{f.kind.replace('_', ' ')} {marks([numbered[f]] if f in numbered else [])}".strip()
            for f in channel.findings
        )
        trust = f"trusted: {channel.trust}; against: " if channel.trust and what else ""
        verdict = Text(channel.verdict, style=styles.get(channel.verdict, "red"))
        table.add_row(name, verdict, Text(f"{trust}{', '.join(what)}"))
    console.print(table)
    if product.compared:
        console.print(Text(f"  compared with other tests of the stand: {', '.join(product.compared)}"))
    if any(f.cure and not f.overruled for channel in product.channels.values() for f in channel.findings):
        console.print(Text(f"  hfa health {context.id} --apply writes the cures into test.toml, after asking"))


def _is(doubt: Doubt, name: str, finding: Finding) -> bool:
    """Whether a numbered reason is this finding of a channel."""
    alike = (doubt.finding.kind, doubt.finding.evidence, doubt.finding.span)
    return name in doubt.channels and alike == (finding.kind, finding.evidence, finding.span)


def _segment(context: Context, console: Console) -> None:
    from hfanalysis.products.segments import Segments

    product = context.read(Segments)
    kind = wording.KINDS.get(product.kind, product.kind)
    print_quantities(console, product.quantities, f"phases (seconds after the valve opens): recognized as {kind}",
           _reasons(context))  # fmt: skip
    if product.engineer:
        console.print(Text(f"  set by the engineer in test.toml: {', '.join(product.engineer)}"))


def _calibrate(context: Context, console: Console) -> None:
    from hfanalysis.products.calibration import Calibration
    from hfanalysis.products.segments import Segments

    product, events = context.read(Calibration), context.read(Segments).events
    times = {name: events[name] for name in ("t_feed", "t_v", "t_purge")}
    print_quantities(console, ordered(product.quantities) | times, "calibration", _reasons(context))
    if product.inlet is not None:
        reaching = product.inlet.quantities | dict(product.C_d)
        print_quantities(console, reaching, "what reaches the injector, and its C_d by law", _reasons(context))
    _regression(product.regression, console)


def _regression(regression: RegressionBasis, console: Console) -> None:
    """What a and n were fitted with, and how well."""
    from hfanalysis.report.names import plain

    for test in regression.tests:
        console.print(Text(plain(f"  a, n: {'; '.join(test.fitted_with)}")), soft_wrap=soft(console))
        burn = test.burn_time_measured
        seen = "" if burn is None else f" (measured {burn:.2f} s)"
        console.print(
            Text(
                f"  a, n leave {test.p_chamber_rms / 1e5:.3f} bar rms in chamber pressure over the window, "
                f"{test.independent_samples:.0f} independent values; burn time {test.burn_time_model:.2f} s{seen}"
            ),
            soft_wrap=soft(console),
        )


def show_quick(product: QuickLook) -> None:
    """Print what can be said at the stand: sensors, phases, performance and C_i."""
    console = paper()
    head = [product.test, wording.KINDS.get(product.kind or "", product.kind or "no firing"), "quick look"]
    source = wording.SOURCES.get(product.source, product.source)
    console.print(Text.assemble(("  ".join(head), "bold"), "  ", (source, "bold yellow")))
    console.print(Text(f"test.toml: {product.facts}"), soft_wrap=soft(console))
    verdicts = ", ".join(f"{name} {verdict}" for name, verdict in product.health.items())
    console.print(Text(f"sensors: {verdicts}"), soft_wrap=soft(console))
    for finding in product.findings:
        console.print(Text(f"  {finding}", style="yellow"), soft_wrap=soft(console))
    if product.phases:
        print_quantities(console, product.phases, "phases (seconds after the valve opens)")
    print_quantities(console, {"C_i": product.C_i} | product.performance, "performance, as measured")
    console.print(Text("not fitted, not compared with the model, not diagnosed: hfa run without --quick does"))


def show_regression(product: CommonLaw) -> None:
    """Print a and n of several tests, together and each alone."""
    console = paper()
    print_quantities(console, ordered(product.quantities), f"regression common to {', '.join(product.tests)}")
    _regression(product.regression, console)
    agreement = product.agreement
    console.print(Text(f"  the tests {agreement.verdict} (probability {agreement.probability:.2g})"))
    for name, found in product.alone.items():
        print_quantities(console, ordered(found.quantities), f"{name} alone")


def _performance(product: Validation, known: Sequence[Doubt], console: Console) -> None:
    performance = product.performance
    table = new_table("", "measured", "± std", "model", "± std ", "unit", "", title="performance")
    for column in table.columns[1:5]:
        column.justify = "right"
    for name, measured in performance.measured.quantities.items():
        model = shown(performance.model.quantities.get(name) or Quantity.absent("not modeled"))
        found = shown(measured)
        if measured.value is not None or model.value != "–":
            unit = found.unit or model.unit
            table.add_row(
                in_words(name), found.value, found.std, model.value, model.std, unit, doubted(measured, known)
            )
    console.print(table)
    if performance.motor_class:
        console.print(Text(f"  motor class {performance.motor_class}"), soft_wrap=soft(console))
    if product.reconstruction is not None:
        console.print(Text(f"  reconstruction: {_reconstructed(product.reconstruction)}"), soft_wrap=soft(console))
    if product.stability is not None:
        console.print(
            Text(f"  stability: {product.stability.verdict}: {product.stability.why}"),
            soft_wrap=soft(console),
        )
    for name, reason in product.absent.items():
        console.print(Text(f"  without {in_words(name)}: {reason}"), soft_wrap=soft(console))


def _reconstructed(found: Reconstruction) -> str:
    """Mean O/F, c* efficiency and what the throat did; or why there is none."""
    if found.variant is None:
        return f"none: {found.reason}"
    named = (("O/F", found.of_ratio_mean), ("c* efficiency", found.c_star_efficiency))
    parts = [f"{name} {q.value:.3g} ({q.interval[0]:.3g} to {q.interval[1]:.3g})" for name, q in named
             if q is not None and q.value is not None and q.interval is not None]  # fmt: skip
    change = found.throat_radius_change
    if change is not None and change.value is not None:
        parts.append(f"throat wider by {1e3 * change.value:.2f} mm")
    return f"{', '.join(parts)}; {found.assumption}"


def _validate(context: Context, console: Console) -> None:
    from hfanalysis.products.validation import Validation

    product = context.read(Validation)
    _performance(product, _reasons(context), console)
    table = new_table("run", "channel", "phase", "rms", "bias", "noise", "unit", title="measured minus model")
    for run, channels in product.gap.items():
        for channel, phases in channels.items():
            for phase, gap in phases.items():
                factor, unit = wording.people_unit(gap.unit)
                numbers = (wording.tidy(factor * size, 3) for size in (gap.rms, gap.bias, gap.noise))
                table.add_row(run, channel, phase, *numbers, unit)
    console.print(table)


def _flight(context: Context, console: Console) -> None:
    from hfanalysis.products.flight import Flight

    product = context.read(Flight)
    title = f"flight, thrust {product.thrust_basis}, {product.thrust}"
    print_values(console, ordered(product.flown), title, _reasons(context))
    console.print(Text(f"  the intervals hold {product.band_covers}"), soft_wrap=soft(console))
    print_values(console, ordered(product.stability.quantities), "stability")
    for name, check in product.checks.items():
        style = {"passed": "green", "failed": "red"}.get(check.result, "yellow")
        line = Text.assemble(f"  {in_words(name)}: ", (check.result, style), f": {check.why}")
        console.print(line, soft_wrap=soft(console))


def _diagnose(context: Context, console: Console) -> None:
    from hfanalysis.products.diagnosis import Diagnosis

    product = context.read(Diagnosis)
    for i, sentence in enumerate(product.sentences):
        console.print(Text(sentence, style="bold" if i == 0 else ""), soft_wrap=soft(console))
    likely = sorted(((p, n) for n, p in product.posterior.items() if p >= SHOWN), reverse=True)
    odds = ", ".join(f"{product.plain(name)} {p:.2f}" for p, name in likely)
    console.print(Text(f"  probabilities: {odds}"), soft_wrap=soft(console))
    if partners := {product.plain(name): p for name, p in product.partners.items() if p >= SHOWN}:
        beside = ", ".join(f"{n} {p:.2f}" for n, p in partners.items())
        console.print(Text(f"  beside it: {beside}"), soft_wrap=soft(console))
    for warning in (*product.notes, *product.warnings):
        console.print(Text(f"  {warning}", style="yellow"), soft_wrap=soft(console))


SHOWN = 0.005
"""Probability from which on a name is shown."""


def _written(stage: str, context: Context, console: Console) -> None:
    """What a stage wrote, where nothing else is said of it here."""
    for name in load_stage(stage).products:
        console.print(Text(f"{stage}: {context.product(name)}"), soft_wrap=soft(console))


def show_engine(product: Simulated | Designed) -> None:
    """Print what an engine file comes to: every quantity of the product, and of the parts in it."""
    console = paper()
    words = (product.engine, product.command, f"conventions: {product.conventions}")
    console.print(Text("  ".join(words), style="bold"))
    console.print(Text(f"oxidizer enthalpy: {product.oxidizer_enthalpy.of}"))
    print_values(console, ordered(product.quantities), "engine")
    for name, part in product.content.items():
        if isinstance(part, Part) and part.shown:
            print_values(console, ordered(part.shown), in_words(name))
            for inner, of in part.content.items():
                if isinstance(of, Part) and of.shown:
                    print_values(console, ordered(of.shown), in_words(inner))
        if name == "spread" and part is not None:
            _show_spread(console, part)


def _show_spread(console: Console, found: Spread) -> None:
    """Chances, and whose spread costs most."""
    refused = f", {found.refused} of which cannot be run" if found.refused else ""
    console.print(Text(f"bands: {found.draws} engines drawn over what is stated with +/-{refused}"))
    for one in found.chances:
        console.print(Text(f"  {100.0 * one.probability:.0f} % that {one.text}"), soft_wrap=soft(console))
    for name, budget in found.budget.items():
        first = [(key, share) for key, share in budget.shares.items() if share >= LEAST_SHARE][:MOST_SHARES]
        shares = [f"{key} {100.0 * share:.0f} %" for key, share in first]
        console.print(Text(f"  {in_words(name)} is spread by {', '.join(shares)}"), soft_wrap=soft(console))


def show_next(found: NextTests) -> None:
    """Print what to test next."""
    console = paper()
    unit = f" {found.unit}" if found.unit else ""
    value = "" if found.value is None else f" of {found.value:.4g}{unit}"
    head = f"{in_words(found.target)}{value}: ± {found.std:.3g}{unit} by what is not known of the constants"
    console.print(Text(head), soft_wrap=soft(console))
    table = new_table("a further test", "then ±", "less by", "", title="what to test next")
    for row in found.tests:
        told = ("–", "", row.reason or "") if row.std is None else (f"{row.std:.3g}", f"{row.narrowed:.3g}", "")
        table.add_row(row.name, *told)
    console.print(table)
    worth = [f"{one.name} {max(one.worth, 0.0):.2g}{unit}" for one in found.sensors]
    console.print(Text(f"worth of each sensor to the same test again: {', '.join(worth)}"), soft_wrap=soft(console))


def show_effects(product: EffectLibrary) -> None:
    """Print the library of effects: where each acts, when, and how strong it typically is."""
    console = paper()
    from hfanalysis.report.names import called

    table = new_table("effect", "name in files", "acts in", "phases", "typical size", "what it is", title="effects")
    for name, found in product.effects.items():
        words = (
            found.plain_name or called(name),
            name,
            found.equation.replace("_", " "),
            _phases(found.phases),
            _strength(found),
        )
        table.add_row(*words, Text(found.meaning))
    console.print(table)
    console.print(
        Text("docs/effects.md has their equations, priors and sources; --json all of it"),
        soft_wrap=soft(console),
    )


def _phases(phases: tuple[str, ...]) -> str:
    return "all" if {"liquid", "vapor", "nitrogen"} <= set(phases) else " ".join(phases)


def _strength(effect: EffectEntry) -> str:
    """Of the first strength: what is typical of it, in the unit of people at a stand."""
    name, first = next((name, p) for name, p in effect.parameters.items() if p.strength)
    factor, unit = wording.people_unit(first.unit)
    return f"{name} {wording.tidy(factor * first.typical, 6)} {unit.strip('-')}".strip()


_SHOWN = {
    "ingest": _ingest,
    "health": _health,
    "segment": _segment,
    "calibrate": _calibrate,
    "validate": _validate,
    "diagnose": _diagnose,
    "flight": _flight,
}
