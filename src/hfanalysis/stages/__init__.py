"""The way through, one thin file per stage::

    raw_tests/TEST ──ingest──► segment ──► calibrate ──► validate ──► diagnose ──► flight ──► report

Each stage module names what it needs and what it writes (`STAGE`, see :mod:`hfanalysis.stages.base`); the runner
(:mod:`hfanalysis.stages.runner`) does what a stage needs first and redoes only what changed.
"""

ORDER = ("ingest", "segment", "calibrate", "validate", "diagnose", "flight", "report")
"""The stages in the order of the way through; each is a module of this package."""

ASIDE = ("diagnose",)
"""Stages that take longer than a page may: `hfa run` makes them and who asks for them by name; the page takes their
products as they are, if they are up to date, with the parameters that they were last asked for with."""


def way_to(name: str) -> tuple[str, ...]:
    """The stages in the order of the way through up to one ("run": all of them), itself included."""
    return ORDER if name == "run" else ORDER[: ORDER.index(name) + 1]
