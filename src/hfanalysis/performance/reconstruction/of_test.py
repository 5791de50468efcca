"""From a test to its reconstruction."""

from __future__ import annotations

from collections.abc import Mapping

from hfanalysis.arrays import Array
from hfanalysis.engine.unsteady import Engine
from hfanalysis.errors import AbsentError
from hfanalysis.performance.flows import Oxidizer
from hfanalysis.performance.measured import Fire
from hfanalysis.performance.reconstruction.inputs import Firing, Shape
from hfanalysis.performance.reconstruction.reconstruct import Reconstructed, reconstruct
from hfanalysis.products.calibration import TankConstants
from hfanalysis.products.reconstruction import Reconstruction
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal, line_at

NAMES = "p_chamber", "thrust_corrected"
"""Histories that it starts from."""


def reconstructed(
    log: TestLog, segments: Segments, definition: TestDefinition, calibration: TankConstants, fire: Fire,
    oxidizer: Oxidizer, histories: Mapping[str, Array], engine: Engine | None,
) -> Reconstructed:  # fmt: skip
    """With the ``engine`` that was run, or as test.toml states it where there is no regression law to run one with."""
    try:
        shape = Shape.of(engine) if engine is not None else _shape(log, segments, definition, calibration)
    except (AbsentError, ArithmeticError, ValueError) as missing:
        return Reconstructed(Reconstruction(variant=None, reason=str(missing)))
    measured = {name: histories[name] for name in NAMES if name in histories}
    given = log, segments, definition, calibration, fire, shape, oxidizer.time, oxidizer.oxidizer
    return reconstruct(Firing(*given, measured))


def _shape(log: TestLog, segments: Segments, definition: TestDefinition, calibration: TankConstants) -> Shape:
    tank = Signal.of(log["p_tank"]).shifted(segments.t_open.value or 0.0)
    return Shape.of_test(definition, calibration, line_at(tank, segments.time("t_feed") or 0.1))
