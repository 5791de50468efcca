"""Regression of the grain, and how well the chamber and the nozzle did."""

from __future__ import annotations

from collections.abc import Iterator

from markupsafe import Markup

from hfanalysis.charts.chart import Chart, Series
from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import Calibration, RegressionBasis
from hfanalysis.products.validation import Validation
from hfanalysis.report import html
from hfanalysis.report.material import Material, Table
from hfanalysis.report.sections import Block, Section
from hfanalysis.report.time_charts import broken, over_time
from hfanalysis.wording.scales import SLOW

_LAW = ("a", "n", "regression_rate_reference")


def render(material: Material) -> Iterator[Block]:
    """The rate over time, the law behind it, and the efficiencies."""
    drawn = [_rate(material), _law(material), _efficiencies(material), _velocity(material)]
    if not any(drawn):
        raise AbsentError(flows_absent(material) or "the products hold no regression rate and no efficiencies")
    yield from drawn


def flows_absent(material: Material) -> str:
    """Why the validation has no flows, in its own words."""
    validation = material.get(Validation)
    return validation.absent.get("flows", "") if validation is not None else ""


def _line(table: Table, name: str, label: str, style: str) -> list[Series]:
    return [Series(label, style, table["time"].values, table[name].values)] if name in table else []


def _drawn(
    material: Material,
    key: str,
    title: str,
    axis: tuple[str, str],
    lines: list[Series],
    caption: str,
    with_zero: bool = True,
) -> Chart | None:
    if not lines:
        return None
    broken_lines = [broken(material, line) for line in lines]
    return over_time(material, key, title, axis, broken_lines, caption, height=260.0, with_zero=with_zero)


def _rate(material: Material) -> Chart | None:
    lines = _line(material.table("performance"), "regression_rate", "regression rate", "p_run")
    axis, caption = ("regression rate", SLOW), "Of the grain's burning surface."
    return _drawn(material, "regression", "Regression rate", axis, lines, caption)


def _law(material: Material) -> Markup | None:
    calibration = material.get(Calibration)
    if calibration is None:
        return None
    law = ((name, calibration.quantities[name]) for name in _LAW)
    said = [
        Markup("{}: {} {}").format(
            html.symbol_and_words(name), html.value(quantity, name), html.verdict(quantity.verdict or "")
        )
        for name, quantity in law
    ]
    return html.bullets(said, "plain") + _fitted_with(calibration.regression)


def _fitted_with(regression: RegressionBasis) -> Markup:
    """The oxidizer flow and the effects behind a and n, which mean nothing without them."""
    words = Markup('<p class="note">{} fitted with:</p>{}')
    return Markup().join(
        words.format(test.test, html.bullets(map(html.switchable, test.fitted_with), "said"))
        for test in regression.tests
    )


def _efficiencies(material: Material) -> Chart | None:
    table = material.table("performance")
    lines = [
        *_line(table, "c_star_efficiency", "c* efficiency, shifting", "p_chamber"),
        *_line(table, "thrust_coefficient_efficiency", "C_F efficiency, shifting", "thrust"),
        *_line(table, "c_star_efficiency_frozen", "c* efficiency, frozen", "p_run"),
        *_line(table, "thrust_coefficient_efficiency_frozen", "C_F efficiency, frozen", "p_tank"),
    ]
    caption = (
        "Of shifting equilibrium, the field's reference and the most that the gas can give, and of frozen flow, the "
        "model's. C_F = F/(p_c A_t) judges the nozzle, while it flows full; it needs no flow. c* judges the combustion "
        "by its course. Its level of frozen flow is close to 1 while liquid flows: a and n were fitted to this chamber "
        "pressure with that gas. Once the liquid is gone it judges the calibrated tank's flow of vapor as much as the "
        f"combustion.{_until_nitrogen(material)}"
    )
    return _drawn(material, "efficiencies", "Efficiencies", ("efficiency", ""), lines, caption, with_zero=False)


def _velocity(material: Material) -> Chart | None:
    lines = _line(material.table("performance"), "c_star", "c*", "p_chamber")
    caption = (
        "c* = p_c A_t over the flow of oxidizer and fuel. Oxidizer: the injector's flow on the measured pressures "
        f"until the liquid is gone, then that of the calibrated tank. Fuel: by a and n.{_until_nitrogen(material)}"
    )
    return _drawn(material, "c-star", "Characteristic velocity", ("c*", "m/s"), lines, caption)


def _until_nitrogen(material: Material) -> str:
    """Why c* ends where it does."""
    if material.event("t_purge") is None:
        return ""
    return (
        " It ends where nitrogen enters, which neither flow counts: with it in the throat the ratio would rise above 1 "
        "whatever burns."
    )


SECTION = Section("Regression and efficiencies", 55, (), render, folded=True)
