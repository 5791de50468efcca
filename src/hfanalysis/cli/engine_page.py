"""The page of a simulated engine: what the simulation found, put before the page that shows it."""

from __future__ import annotations

from pathlib import Path

from hfanalysis.charts.chart import Chart
from hfanalysis.errors import InputError
from hfanalysis.flight.histories import groups
from hfanalysis.products.engines import Designed
from hfanalysis.record.engine_file import EngineFile
from hfanalysis.record.published import TABLES, published
from hfanalysis.report.engine_page import EngineMaterial, Published, engine_page
from hfanalysis.simulation import plots, steady_run, study, write
from hfanalysis.simulation.unsteady_run import Simulation


def write_page(out: Path, file: EngineFile, found: Simulation) -> None:
    """Write ENGINE.html to ``out``; with the steady design and its study, where the file asks for one."""
    flown = found.flown
    design, charts = _design(file)
    days = found.on_other_days
    page = engine_page(
        EngineMaterial(
            found.product,
            file.engine.description,
            write.histories(found.evenly()),
            {} if isinstance(flown, str) else groups(flown, write.left(found, flown)),
            _published(file),
            design,
            charts,
            (plots.over_temperature(days), days.refused),
        )
    )
    write.write_text(out / f"{write.file_name(file)}.html", page)


def _published(file: EngineFile) -> Published:
    stated = published(file.path)
    if stated is None:
        return Published()
    numbers, texts = {key: stated.numbers(key) for key in TABLES}, {key: stated.texts(key) for key in TABLES}
    return Published(stated.source, numbers, texts)


def _design(file: EngineFile) -> tuple[Designed | str, list[Chart]]:
    if file.design.oxidizer_flow is None or file.design.chamber_pressure is None:
        return "[design] oxidizer_flow and chamber_pressure are not both given", []
    try:
        found = steady_run.design(file)
    except InputError as error:
        return str(error), []
    flows = study.over_flow_and_length(found.task)
    return found.product, list(plots.study_charts(flows, list(study.over_mixture(found.task.requirement))))
