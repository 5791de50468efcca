"""The page of an engine that is no test: what ``hfa simulate`` found, in the style of a test's page."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from markupsafe import Markup

from hfanalysis.arrays import Array
from hfanalysis.charts.chart import Chart, Series, around
from hfanalysis.charts.svg import Event
from hfanalysis.flight.motor import motor_class
from hfanalysis.products.engines import Designed, Simulated
from hfanalysis.quantity import Quantity
from hfanalysis.report import html
from hfanalysis.report.flight_charts import CURVES, FlightCurves, without_margin
from hfanalysis.report.page import body, render
from hfanalysis.report.payload import payload
from hfanalysis.report.sections import Block, Laid
from hfanalysis.sentences import capitalised
from hfanalysis.wording.numbers import MINUS, fixed, in_words, listed, ordered

KEY_NUMBERS = ("total_impulse", "burn_time", "peak_thrust", "peak_chamber_pressure", "specific_impulse")
"""What is asked for first; the apogee comes after them."""

LEAST_SHARE = 0.005
"""Share of a variance from which on an input is listed [-]. Source: by choice: it reads 1 %."""

_HEIGHT = 250.0
"""Of a chart of the first screen [px]."""


@dataclass(frozen=True)
class Published:
    """Numbers that somebody else has of the engine: whose, and by product ("simulate", "flight", "design") and name
    [SI]; the same as they were printed."""

    source: str = ""
    numbers: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    texts: Mapping[str, Mapping[str, str]] = field(default_factory=dict)


@dataclass(frozen=True)
class EngineMaterial:
    """All that the page is made of.

    ``burn``: histories over the burn, (n,) each, by name and SI unit ("time [s]"); ``flight``: groups of flight.h5;
    ``design`` and ``study``: of the steady-state design, where the file asks for one, else why there is none.
    ``days``: the same engine on colder and warmer ones, with the temperatures [degC] at which there is none, and why.
    """

    product: Simulated
    description: str
    burn: Mapping[str, Array]
    flight: Mapping[str, Mapping[str, Array]]
    published: Published
    design: Designed | str
    study: Sequence[Chart] = ()
    days: tuple[Chart | None, Mapping[float, str]] = (None, {})


@dataclass(frozen=True)
class Line:
    """A line of a chart over the burn: column, what people read, and its color."""

    column: str
    label: str
    style: str


OVER_BURN: tuple[tuple[str, str, tuple[str, str], tuple[Line, ...]], ...] = (
    ("pressures", "Pressures", ("pressure", "Pa"), (
        Line("tank_pressure [Pa]", "tank", "p_tank"), Line("run_pressure [Pa]", "before the injector", "p_run"),
        Line("chamber_pressure [Pa]", "chamber", "p_chamber"),
    )),
    ("thrust", "Thrust", ("thrust", "N"), (Line("thrust [N]", "thrust", "thrust"),)),
    ("mixture", "O/F", ("O/F", ""), (Line("of_ratio [1]", "O/F of the gas in the chamber", "p_tank"),)),
    ("flows", "Mass flows", ("mass flow", "kg/s"), (
        Line("oxidizer_flow [kg/s]", "oxidizer", "p_tank"), Line("fuel_flow [kg/s]", "fuel", "p_fill"),
        Line("nozzle_flow [kg/s]", "nozzle", "p_chamber"),
    )),
    ("temperatures", "Temperature in the tank", ("temperature", "K"), (
        Line("tank_temperature [K]", "tank", "p_tank"),
    )),
    ("gas", "Temperature in the chamber", ("temperature", "K"), (
        Line("chamber_temperature [K]", "chamber", "p_chamber"),
    )),
    ("regression", "Regression rate", ("regression rate", "m/s"), (
        Line("regression_rate [m/s]", "regression rate", "p_fill"),
    )),
    ("port", "Port radius", ("radius", "m"), (Line("port_radius [m]", "port", "p_fill"),)),
    ("flux", "Oxidizer flux in the port", ("flux", "kg/(m^2 s)"), (
        Line("oxidizer_flux [kg/m^2/s]", "oxidizer flux", "p_tank"),
    )),
    ("tank-mass", "Oxidizer in the tank", ("mass", "kg"), (Line("tank_mass [kg]", "oxidizer", "m_tank"),)),
    ("balance", "Center of gravity from the nose tip", ("position", "m"), (
        Line("center_of_gravity [m]", "rocket", "p_chamber"),
    )),
)  # fmt: skip
"""Charts over the burn: key, title, (quantity, SI unit), lines; what the histories do not have is not drawn."""

_FROM_ZERO = frozenset({"pressures", "thrust", "flows", "tank-mass", "flux", "regression"})
"""Charts on whose value axis zero belongs."""

_FIRST = ("thrust", "pressures")
"""Charts of the first screen."""


def engine_page(material: EngineMaterial) -> str:
    """The HTML of an engine's page."""
    laid = [one for one in _sections(material) if one.blocks]
    charts = [chart for section in laid for chart in section.charts]
    product = material.product
    return render(
        "engine.html.j2",
        product=product,
        description=material.description,
        sections=[(section, body(section)) for section in laid],
        absent=[],
        data=payload(charts),
    )


def _sections(material: EngineMaterial) -> Iterator[Laid]:
    for key, title, blocks, folded in (
        ("glance", "At a glance", _glance, False),
        ("beyond", "What an engineer would warn of", _warnings, False),
        ("numbers", "Numbers", _numbers, False),
        ("spread", "How sure they are", _spread, False),
        ("burn", "The burn over time", _burn, False),
        ("flight", "The flight", _flight, False),
        ("days", "On colder and warmer days", _days, False),
        ("design", "The steady-state design", _design, True),
        ("made", "What this was made from", _made, True),
    ):
        yield Laid(key, title, tuple(block for block in blocks(material) if block is not None), folded=folded)


def _glance(material: EngineMaterial) -> Iterator[Block]:
    product = material.product
    found = {name: product.quantities[name] for name in KEY_NUMBERS} | {"apogee": product.flight.apogee}
    item = Markup("<div><dt>{}</dt><dd>{}</dd></div>")
    items = (item.format(in_words(name), _key(name, of)) for name, of in found.items() if of.value is not None)
    yield Markup('<dl class="key-numbers">{}</dl>').format(Markup().join(items))
    yield html.paragraph("Simulated: nothing on this page was measured.")
    yield Markup('<div class="beside">')
    for key in _FIRST:
        yield _over_burn(material, key, _HEIGHT)
    yield Markup("</div>")


def _key(name: str, quantity: Quantity) -> Markup:
    number = html.value(quantity, name, True)
    if name != "total_impulse" or quantity.value is None:
        return number
    return number + Markup(' <span class="class">class {}</span>').format(motor_class(quantity.value).split()[0])


def _warnings(material: EngineMaterial) -> Iterator[Block]:
    said = [*(one.text for one in material.product.beyond), *material.product.warnings]
    if said:
        yield html.bullets((html.switchable(capitalised(text)) for text in said), "plain")
    else:
        yield html.paragraph("Nothing that its rules know of; docs/engines.md lists them.")


def _numbers(material: EngineMaterial) -> Iterator[Block]:
    product = material.product
    yield _table("Engine", product.quantities, material.published, "simulate")
    yield _table("Flight", product.flight.quantities, material.published, "flight")
    load = product.propellant_for_target_apogee
    if load is not None:
        yield _table("Propellant for the target apogee", load.shown, material.published, "")
    if material.published.source:
        yield html.paragraph(f"Published: {material.published.source}.")


def _table(title: str, found: Mapping[str, Quantity], published: Published, key: str) -> Markup:
    """The quantities, beside what was published of them."""
    known, texts = published.numbers.get(key, {}), published.texts.get(key, {})
    banded = any(of.std for of in found.values())
    heads = [*([">95 % interval"] if banded else []), *([">published", ">difference"] if known else [])]
    rows = []
    for name, of in ordered(found).items():
        band = (html.interval(of, name),) if banded else ()
        printed = (texts.get(name, ""), _difference(of.value, known.get(name))) if known else ()
        rows.append((in_words(name), html.value(of, name), *band, *printed, html.remark(of, ())))
    return html.table(title, title, ("quantity", ">value", *heads, "remark"), rows)


def _spread(material: EngineMaterial) -> Iterator[Block]:
    """Chances that limits are kept, and whose spread costs most; nothing where nothing is stated with a +/-."""
    found = material.product.spread
    if found is None:
        return
    refused = f" {found.refused} of them cannot be run." if found.refused else ""
    yield html.paragraph(f"From {found.draws} engines drawn over what the file states with a +/-.{refused}")
    yield html.bullets((f"{100.0 * one.probability:.0f} % that {one.text}" for one in found.chances), "plain")
    names = list(dict.fromkeys(key for budget in found.budget.values() for key in budget.shares))
    rows = [
        (key, *(f"{100.0 * budget.shares.get(key, 0.0):.0f} %" for budget in found.budget.values()))
        for key in names
        if max(budget.shares.get(key, 0.0) for budget in found.budget.values()) >= LEAST_SHARE
    ]
    rows.append(("beyond straight lines", *(f"{100.0 * budget.non_linear:.0f} %" for budget in found.budget.values())))
    columns = ("input", *(f">{in_words(name)}" for name in found.budget))
    if found.budget:
        caption = "Share of the variance that each input makes."
        yield html.table("How sure they are", caption, columns, rows)


def _difference(found: float | None, known: float | None) -> str:
    """Of a number from the published one, in percent of that."""
    if found is None or not known:
        return ""
    text = fixed(100.0 * (found / known - 1.0), 1)
    return f"{text if text.startswith(MINUS) else f'+{text}'} %"


def _burn(material: EngineMaterial) -> Iterator[Block]:
    for key, *_ in OVER_BURN:
        if key not in _FIRST:
            yield _over_burn(material, key, 240.0)


def _over_burn(material: EngineMaterial, key: str, height: float) -> Chart | None:
    title, (quantity, unit), lines = next((title, about, of) for name, title, about, of in OVER_BURN if name == key)
    time = material.burn["time [s]"]
    known = [line for line in lines if line.column in material.burn]
    series = [Series(line.label, line.style, time, _unlit(line, material.burn[line.column])) for line in known]
    if not series:
        return None
    return Chart(
        key, title, quantity, unit, tuple(series), around([time]),
        events=tuple(_events(material.product)), x_label="time after ignition [s]", height=height,
        with_zero=key in _FROM_ZERO, clock="burn",
    )  # fmt: skip


def _unlit(line: Line, values: Array) -> Array:
    """Without what has no number (an O/F without fuel)."""
    return np.where(np.isfinite(values), values, np.nan)


def _events(product: Simulated) -> Iterator[Event]:
    for quantity, words in ((product.liquid_depletion_time, "liquid out"), (product.burn_time, "fuel out")):
        if quantity.value is not None:
            yield Event(quantity.value, 0.0, words)


def _flight(material: EngineMaterial) -> Iterator[Block]:
    flight = material.product.flight
    if not material.flight:
        yield html.paragraph(html.switchable(f"No flight: {flight.apogee.reason}."))
        return
    burn = material.product.burn_time.value
    curves = FlightCurves(material.flight, flight.rail_departure_velocity.value, burn)
    for name in CURVES:
        yield curves.curve(name)
    yield curves.line("mach", "Mach number", "Mach number", "")
    yield curves.line("drag", "Drag on the way up", "drag", "N")
    if flight.stability is not None:
        yield curves.margin(flight.stability) or without_margin(flight.stability, "the engine file")


def _days(material: EngineMaterial) -> Iterator[Block]:
    chart, refused = material.days
    if chart is None:
        return
    yield chart
    yield html.paragraph("The tank as built and loaded, at other temperatures: its pressure drives all else.")
    if refused:
        where = listed([f"{t:g}" for t in refused])
        why = next(iter(refused.values())).partition(", tank.")[2] or next(iter(refused.values()))
        yield html.paragraph(html.switchable(f"Not at {where} degC: {why}."))


def _design(material: EngineMaterial) -> Iterator[Block]:
    if isinstance(material.design, str):
        yield html.paragraph(html.switchable(f"No steady-state design: {material.design}."))
        return
    yield html.paragraph("Constant oxidizer flow, constant thrust, by the same file: where the engine started from.")
    yield _table("Design", material.design.quantities, material.published, "design")
    said = [one.text for one in material.design.beyond]
    if said:
        yield html.bullets((html.switchable(capitalised(text)) for text in said), "plain")
    yield from material.study


def _made(material: EngineMaterial) -> Iterator[Block]:
    product = material.product
    rows = [
        ("conventions", product.conventions),
        ("properties of nitrous oxide", product.properties),
        ("fuel", product.fuel),
    ]
    rows.append(("enthalpy of the oxidizer", product.oxidizer_enthalpy.of))
    rows += [(name.replace("_", " "), str(said)) for name, said in product.provenance.items() if isinstance(said, str)]
    yield html.table("What this was made from", "hfa simulate", ("what", "which"), rows)
