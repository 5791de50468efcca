"""A test whose calibration has no a and n, though nothing forbids a model: a fit starts from an engine near enough."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

from hfanalysis.calibrate.facts import nothing_to_regress
from hfanalysis.errors import AbsentError
from hfanalysis.inference.half_known import near_enough
from hfanalysis.inference.subject import Subject

NOTE = (
    "the calibration has no a and n ({reason}): fits start from a tank as warm as its blowdown, with the exponent "
    "that fuels have"
)


def with_start(subject: Subject) -> Subject:
    """The subject with an engine to start from where it needs one and one can be had; else as it is.

    Where the log forbids a regression, for the chamber's pressure cannot be believed or nothing burns, it forbids the
    model, too.
    """
    base = subject.calibration
    if base is None or base.C_i.value is None or (base.a.value is not None and base.n.value is not None):
        return subject
    if subject.segments.kind != "hot_fire" or subject.segments.misfire:
        return subject
    if nothing_to_regress(subject.log, subject.segments, subject.definition, base) is not None:
        return subject
    with suppress(AbsentError):
        start = near_enough(subject.segments, base, subject.definition)
        note = NOTE.format(reason=base.a.reason or base.n.reason)
        return replace(subject, start=start, notes=(*subject.notes, note))
    return subject
