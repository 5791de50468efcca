"""The way through, one thin file per stage::

    raw_tests/TEST ──ingest──► segment ──► calibrate ──► validate ──► flight ──► report
                                               └───────► diagnose

Each stage module names what it needs and what it writes (`STAGE`, see :mod:`hfanalysis.stages.base`); the runner
(:mod:`hfanalysis.stages.runner`) does what a stage needs first and redoes only what changed.
"""

ORDER = ("ingest", "segment", "calibrate", "validate", "diagnose", "flight", "report")
"""The stages in the order of the way through; each is a module of this package."""

ASIDE = ("diagnose",)
"""Stages that take longer than a page may: they run only when they are asked for by name."""


def way_to(name: str) -> tuple[str, ...]:
    """The stages whose products lead to one ("run": all that do not stand aside), itself included."""
    until = len(ORDER) if name == "run" else ORDER.index(name) + 1
    return tuple(stage for stage in ORDER[:until] if stage == name or stage not in ASIDE)
