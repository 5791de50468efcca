"""How an analysis ends: an exit status for each kind of end, and what is said of it."""

from __future__ import annotations

from hfanalysis.errors import AbsentError, AnalysisError, InputError
from hfanalysis.products.disk import REFUSED

DONE, INPUT_AT_FAULT, ABSENT, DEFECT = 0, InputError.exit_status, AbsentError.exit_status, 1
"""Exit statuses: done; the two in which an analysis ends early; a fault of ours."""


def plainly(error: BaseException) -> tuple[int, str] | None:
    """The exit status and the message of what is no fault of ours; None of what is."""
    if isinstance(error, AnalysisError):
        return error.exit_status, str(error)
    if isinstance(error, OSError) and error.errno in REFUSED:
        return INPUT_AT_FAULT, ": ".join(filter(None, (str(error.filename or ""), str(error.strerror))))
    if isinstance(error, MemoryError):
        return INPUT_AT_FAULT, "the memory is not enough for this log; close what else runs, or lower its rate"
    return None
