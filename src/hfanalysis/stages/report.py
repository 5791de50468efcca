"""report: one self-contained page per test, for the people at the stand.

Reads whatever the stages before it have made; a stage that found nothing to do is named with its reason. Writes
``report.html``.
"""

from __future__ import annotations

from typing import Any

from hfanalysis.stages.base import Context, Stage


def run(context: Context) -> None:
    """Write the page of the test."""
    from hfanalysis.report.material import Material, read_residuals
    from hfanalysis.report.page import page
    from hfanalysis.testdata.log import read_log

    material = Material(
        context.definition,
        read_log(context.product("ingest.h5")),
        context.read_json("ingest.json"),
        _product(context, "segment", "segments.json"),
        _product(context, "calibrate", "calibration.json"),
        None if "validate" in context.absent else read_residuals(context.product("residuals.h5")),
        context.absent,
    )
    context.scratch("report.html").write_text(page(material), encoding="utf-8")


def _product(context: Context, stage: str, name: str) -> dict[str, Any] | None:
    return None if stage in context.absent else context.read_json(name)


STAGE = Stage(
    name="report",
    needs=("ingest",),
    wants=("segment", "calibrate", "validate", "flight"),
    products=("report.html",),
    run=run,
)
