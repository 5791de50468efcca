"""What ``hfa run ID --quick`` and ``hfa watch`` say: the content of their ``--json``. It is never a file."""

from __future__ import annotations

from typing import Annotated, ClassVar

from hfanalysis.products.health import Verdict
from hfanalysis.products.model import Is, Part, Warnings, Words
from hfanalysis.quantity import Quantity


class QuickLook(Part):
    """A firing minutes after it: no model is run, a and n are not fitted, and nothing is diagnosed."""

    file: ClassVar[str] = "quick.json"

    test: Annotated[str, Is("name of the test")]
    source: Annotated[str, Is("measured, or generated: replica, synthetic")]
    facts: Annotated[Words, Is("whose test.toml was taken")]
    health: Annotated[dict[str, Verdict], Is("of the channels, by canonical name")]
    findings: Annotated[tuple[Words, ...], Is("what was found of those that are not healthy, and what cures it")]
    kind: Annotated[str | None, Is("of test, as recognized; null where nothing happened")]
    phases: Annotated[dict[str, Quantity], Is("t_open in log time, the other events after it", "s")]
    performance: Annotated[dict[str, Quantity], Is("burn time, impulse, peaks and means, as validation.json has them")]
    C_i: Annotated[Quantity, Is("injector coefficient, as calibration.json has it", "")]
    warnings: Warnings
