"""What flows: oxidizer through the injector, fuel from the grain, and their ratio."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.charts.chart import Chart, Series
from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import Calibration
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.report.sections.regression import flows_absent
from hfanalysis.report.time_charts import broken, over_time
from hfanalysis.thermo.constants import OXIDIZER_MOLAR_MASS

MOLES_TO_KG = 1e-3 * OXIDIZER_MOLAR_MASS
"""Mass of a mole of nitrous oxide [kg/mol]. Source: its molar mass, in g/mol."""


def render(material: Material) -> Iterator[Block]:
    """Flows, mixture ratio, and what is left in the tank."""
    drawn = [_flows(material), _ratio(material), _content(material)]
    if not any(drawn):
        raise AbsentError(flows_absent(material) or "neither the calibration nor the validation holds flows")
    yield from drawn


def _history(material: Material, *names: str) -> list[Array] | None:
    """Columns of the calibrated tank's history: time first."""
    calibration = material.get(Calibration)
    history = calibration.tank_history if calibration is not None else None
    if history is None or len(history.time) < 2:
        return None
    return [np.asarray(getattr(history, name), dtype=float) for name in ("time", *names)]


def lines(material: Material) -> Iterator[Series]:
    """Flows of the performance history, and the oxidizer's through the calibrated injector."""
    table = material.table("performance")
    for name, label, style in (("oxidizer_flow", "oxidizer", "p_tank"), ("fuel_flow", "fuel", "p_run")):
        if name in table:
            yield broken(material, Series(label, style, table["time"].values, table[name].values))
    found = _history(material, "flow")
    if found is not None and "oxidizer_flow" not in table:
        yield broken(material, Series("oxidizer", "p_tank", found[0], found[1]))


def _flows(material: Material) -> Chart | None:
    found = list(lines(material))
    caption = "Oxidizer through the calibrated injector, from the measured pressure drop"
    caption += "; fuel from the regression of the grain." if any(one.label == "fuel" for one in found) else "."
    return over_time(material, "flow", "Flow", ("mass flow", "kg/s"), found, caption, height=280.0)


def _ratio(material: Material) -> Chart | None:
    table = material.table("performance")
    if "of_ratio" not in table:
        return None
    line = broken(material, Series("O/F", "thrust", table["time"].values, table["of_ratio"].values))
    caption = "Mass of oxidizer per mass of fuel, instant by instant."
    return over_time(material, "of-ratio", "Mixture ratio", ("O/F by mass", ""), [line], caption, height=240.0)


def _content(material: Material) -> Chart | None:
    found = _history(material, "liquid", "vapor")
    if found is None:
        return None
    time, liquid, vapor = found
    series = [
        Series("liquid", "p_tank", time, liquid * MOLES_TO_KG),
        Series("vapor", "m_tank", time, vapor * MOLES_TO_KG),
    ]
    caption = "From the loaded mass, less what the calibrated injector passed, at the measured pressure."
    return over_time(material, "tank-content", "Oxidizer in the tank", ("mass", "kg"), series, caption, height=240.0)


SECTION = Section("Flow", 50, (), render, folded=True)
