"""What can be said of a firing within seconds: phases, peaks, impulse, C_i, and which sensors to believe."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from hfanalysis.calibrate.tank import calibrate
from hfanalysis.engine.effect import Active
from hfanalysis.errors import AbsentError
from hfanalysis.health.doubts import WORSE, asked
from hfanalysis.inference.adopted.corrected_log import corrected
from hfanalysis.performance.measured import measured
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.health import HEALTHY, Health
from hfanalysis.products.model import Product
from hfanalysis.products.quick import QuickLook
from hfanalysis.products.segments import Segments
from hfanalysis.products.validation import Validation
from hfanalysis.quantity import DOUBTED, Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.sentences import joined

SHOWN = ("burn_time", "total_impulse", "average_thrust", "peak_thrust", "peak_chamber_pressure",
         "mean_chamber_pressure", "oxidizer_mass", "fuel_mass", "specific_impulse_loaded")  # fmt: skip
"""Of the table of performance, in order."""

BY_LOAD = ("C_i", "oxidizer_mass", "fuel_mass", "specific_impulse_loaded")
"""What rests on the masses that test.toml states."""


@dataclass(frozen=True)
class Facts:
    """Whose test.toml was taken, in ``words``; ``lender``: the test whose it is, where that is another one."""

    words: str
    lender: str | None = None


OWN = Facts("its own")


def quick_look(
    log: TestLog,
    segments: Segments,
    definition: TestDefinition,
    health: Health,
    effects: Sequence[Active],
    samples: int,
    facts: Facts = OWN,
) -> QuickLook:
    """From a log without what is unusable; C_i with ``effects`` acting, by ``samples`` drawn inputs.

    Its numbers are those that calibrate and validate find; what rests on a load that is another test's is doubted.
    """
    found = measured(log, segments, definition, None)
    discharge, warnings = _discharge(corrected(log, segments.t_open.value or 0.0, effects), segments, definition,
                                     effects, samples)  # fmt: skip
    return QuickLook(
        test=definition.test.id,
        source=definition.test.source,
        facts=facts.words,
        **judged(health),
        kind=segments.kind,
        phases={"t_open": segments.t_open, **segments.events},
        performance={
            name: _with_doubt(Validation, name, found[name], health, facts) for name in SHOWN if name in found
        },
        C_i=_with_doubt(Calibration, "C_i", discharge, health, facts),
        warnings=tuple(dict.fromkeys((*definition.warnings, *segments.warnings, *warnings))),
    )


def nothing_happened(definition: TestDefinition, health: Health, why: str, facts: Facts = OWN) -> QuickLook:
    """That of a log without a firing: its sensors, and ``why`` there is no more."""
    return QuickLook(
        test=definition.test.id, source=definition.test.source, facts=facts.words, **judged(health), kind=None,
        phases={}, performance={}, C_i=Quantity.absent(why), warnings=tuple(definition.warnings),
    )  # fmt: skip


def judged(health: Health) -> dict[str, Any]:
    """Verdicts by channel, and what was found of those that are not healthy."""
    return {
        "health": {name: channel.verdict for name, channel in health.channels.items()},
        "findings": tuple(_findings(health)),
    }


def _findings(health: Health) -> Iterator[str]:
    for name, channel in health.channels.items():
        for finding in channel.findings:
            if finding.verdict != HEALTHY and not finding.overruled:
                cure = f"; in test.toml: {finding.cure}" if finding.cure else ""
                yield f"{name} {channel.verdict}: {finding.evidence}; {finding.means}{cure}"


def _discharge(
    log: TestLog, segments: Segments, definition: TestDefinition, effects: Sequence[Active], samples: int
) -> tuple[Quantity, tuple[str, ...]]:
    try:
        found = calibrate(log, segments, definition, samples, effects)
    except AbsentError as missing:
        return Quantity.absent(str(missing)), ()
    return found.constants.C_i, tuple(found.constants.warnings)


def _with_doubt(product: type[Product], name: str, quantity: Quantity, health: Health, facts: Facts) -> Quantity:
    """As the product itself has it, with the doubts of the channels that it rests on."""
    found = asked(quantity, product.file, name, health)
    if not facts.lender or name not in BY_LOAD or found.value is None:
        return found
    told = joined("; ", [f"with the load that {facts.lender} had", *([found.why] if found.why else [])])
    return replace(found, verdict=found.verdict if found.verdict in WORSE else DOUBTED, why=told)
