"""The way through, one thin file per stage::

    raw_tests/TEST ──ingest──► health ──► segment ──► calibrate ──► validate ──► diagnose ──► flight ──► report

Each stage module names what it needs and what it writes (`STAGE`, see :mod:`hfanalysis.stages.base`); the runner
(:mod:`hfanalysis.stages.runner`) does what a stage needs first and redoes only what changed.
"""

STAGES = {
    "ingest": "Read the raw log onto canonical channels in SI, with quality flags per sample.",
    "health": "Judge every channel before it is believed: what cannot be used, what is doubted, and what cures it.",
    "segment": "Find the phases of the test: valve opening, full feed line, end of the liquid, nitrogen, end.",
    "calibrate": "Injector coefficient, feed losses, polytropic exponent and regression, with intervals.",
    "validate": "Measure the performance and run the model against the measurement.",
    "diagnose": "Which effect the model lacks, with probabilities and proof.",
    "flight": "Fly the rocket on the measured thrust: apogee, rail departure, stability; engine files.",
    "report": "Write report.html, one page to read offline; on request as PDF, and its plots as PNG and CSV.",
}
"""The registry: the stages in the order of the way through, each a module of this package, and what it does. The
command line takes its commands from here, and make its rules (`make readme` writes pipeline/dag.mk anew)."""

ORDER = tuple(STAGES)

ASIDE = ("diagnose",)
"""Stages that take longer than a page may: `hfa run` makes them and who asks for them by name; the page takes their
products as they are, if they are up to date, with the parameters that they were last asked for with."""

RUN = "run"
"""Not a stage: all of them."""


def way_to(name: str) -> tuple[str, ...]:
    """The stages in the order of the way through up to one (RUN: all of them), itself included."""
    return ORDER if name == RUN else ORDER[: ORDER.index(name) + 1]
