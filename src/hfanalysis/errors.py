"""The two ways in which an analysis ends early, each with its exit status.

Everything else that escapes is a defect of the package itself (exit status 1).
"""


class AnalysisError(Exception):
    """An end that the person at the stand can act on; its text is shown as it is, without a traceback."""

    exit_status = 1


class InputError(AnalysisError):
    """The input is at fault: the message names the file, line or key, what was found and what was expected."""

    exit_status = 2


class AbsentError(AnalysisError):
    """The log does not hold what was asked for: the message says which channel, phase or event is missing."""

    exit_status = 3
