"""What the fuel did, by the measurement alone: O/F, regression, flux and throat with their bands."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from markupsafe import Markup

from hfanalysis.arrays import Array
from hfanalysis.charts.chart import Chart, Series
from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.diagnosis import Diagnosis
from hfanalysis.products.reconstruction import AXIS, Reconstruction
from hfanalysis.products.validation import Validation
from hfanalysis.quantity import Quantity
from hfanalysis.report import html
from hfanalysis.report.beside_names import sentences
from hfanalysis.report.material import Material, Table
from hfanalysis.report.sections import Block, Section
from hfanalysis.report.time_charts import broken, over_time
from hfanalysis.wording.numbers import tidy
from hfanalysis.wording.scales import SLOW

_CHARTS = (
    ("of_ratio", "Oxidizer to fuel ratio", ("O/F by mass", ""), "p_chamber"),
    ("regression_rate", "Regression rate", ("regression rate", SLOW), "p_run"),
    ("c_star_efficiency", "c* efficiency", ("c* efficiency", ""), "thrust"),
    ("throat_radius", "Throat radius", ("throat radius", "m"), "p_tank"),
)
"""History, title, axis, color."""


def render(material: Material) -> Iterator[Block]:
    """What it rests on, the four histories, and a and n beside those that were fitted."""
    found = material.need(Validation).reconstruction
    if found is None or found.variant is None:
        raise AbsentError((found.reason if found is not None else None) or "nothing burns in this test")
    yield html.paragraph(Markup("Without a regression law, from chamber pressure and oxidizer flow: {}.").format(
        html.switchable(str(found.assumption))))  # fmt: skip
    if found.other:
        yield html.paragraph(f"It is not the only course: {found.other}.")
    if found.told is not None and found.told < 1.0:
        yield html.paragraph(
            f"In {tidy(100.0 * (1.0 - found.told), 2)} % of the window O/F is not told, and not drawn. There a per "
            "cent of chamber pressure is ten per cent of O/F or more, or two courses fit. Or the band is wider than "
            "1.5 times."
        )
    table = material.table("performance", "reconstructed")
    # an efficiency that was assumed, and a throat that nobody measured, are no findings to draw
    for name, title, axis, style in _CHARTS if found.variant != "a" else _CHARTS[:2]:
        yield _chart(material, table, name, title, axis, style)
    yield _law(found, material.get(Calibration))
    diagnosis = material.get(Diagnosis)
    if diagnosis is not None:
        for said in sentences(found, _beside(material, table), diagnosis):
            yield html.paragraph(said[0].upper() + said[1:])


def _beside(material: Material, table: Table) -> dict[str, Array]:
    """Histories of the reconstruction, and the chamber's pressure at their times."""
    whole = material.table("performance")
    found = {name: table[name].values for name in table}
    pressure = np.interp(found[AXIS], whole["time"].values, whole["p_chamber"].values)
    return found | {"p_chamber": pressure}


def _chart(material: Material, table: Table, name: str, title: str, axis: tuple[str, str], style: str) -> Chart | None:
    if name not in table:
        return None
    time = table[AXIS].values
    told = table["told"].values > 0.5 if name in ("of_ratio", "regression_rate") else np.ones(time.size, dtype=bool)

    def where(values: Array) -> Array:
        return np.where(told, values, np.nan)

    low, high = (where(table[f"{name}_{end}95"].values) for end in ("low", "high"))
    lines = [
        Series("95 % band", style, time, low, kind="band", upper=high),
        Series(title.lower(), style, time, where(table[name].values)),
    ]
    if not lines[1].finite:
        return None
    key = f"reconstructed-{name.replace('_', '-')}"
    drawn = [broken(material, line) for line in lines]
    return over_time(material, key, title, axis, drawn, "", height=240.0, with_zero=False)


def _law(found: Reconstruction, calibration: Calibration | None) -> Markup | None:
    """a and n along the path, and those that were fitted to burn time and chamber pressure."""
    n = found.n
    if n is None or n.value is None:
        return html.paragraph(f"No a and n along the path: {n.reason}.") if n is not None else None
    fitted = calibration.n if calibration is not None else None
    said = f"Along the path n is {_said(n)}, from this firing's mixture alone"
    if fitted is None or fitted.value is None:
        return html.paragraph(f"{said}.")
    agree = _overlap(n, fitted)
    words = "agrees with" if agree else "does not agree with"
    rests = "" if agree else ": one rests on the fuel and one c* efficiency that drifts, the other on ideal combustion"
    return html.paragraph(f"{said}; that {words} {_said(fitted)}, fitted to burn time and chamber pressure{rests}.")


def _said(quantity: Quantity) -> str:
    low, high = quantity.interval or (np.nan, np.nan)
    return f"{tidy(quantity.value or 0.0, 2)} ({tidy(low, 2)} to {tidy(high, 2)})"


def _overlap(one: Quantity, other: Quantity) -> bool:
    if one.interval is None or other.interval is None:
        return True
    return one.interval[0] <= other.interval[1] and other.interval[0] <= one.interval[1]


SECTION = Section("Reconstruction", 32, ("validation", "performance"), render, folded=True)
