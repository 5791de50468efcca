"""What test.toml states of a sensor's accuracy, and what of it a zero leaves.

``"2 psi"`` is one standard deviation, ``"2 psi, k=2"`` two of them, ``"2 psi, limit"`` what is never exceeded: all
between is as likely, so that a standard deviation is the limit over the root of 3 (GUM, JCGM 100:2008, 4.3.7).
``"0.25 % of 500 psi, limit"`` is how data sheets put it.
"""

from __future__ import annotations

import datetime
import re
from math import sqrt
from typing import Any

from hfanalysis.record.schema import NOT_NEGATIVE, POSITIVE, Refused, read_quantity
from hfanalysis.units import Value

SPAN_SHARE = 0.7071
"""Part of a stated accuracy that is the span's error, which no zero takes away; as much is the zero's. Source:
1/sqrt(2): data sheets state both with the same limit, and squares add up to the whole."""

VALID = 366
"""[days] from the test within which an in-place calibration says what the sensor was then. Source: ASTM E74 has force
transducers calibrated anew after a year."""

LIMIT = sqrt(3.0)
"""A limit over its standard deviation [-]. Source: uniform distribution; GUM, 4.3.7."""

_SHARE = re.compile(r"\s*([0-9.eE+-]+)\s*%\s*of\s+(.+)")
_EXPECTED = "expected a size and what it is: '2 psi' (one standard deviation), '2 psi, k=2', '0.25 % of 500 psi, limit'"


def read_accuracy(found: Any, dimension: str) -> Value:
    """One standard deviation [SI] of a sensor's bias; ``dimension`` is that of a difference of its readings.

    Raises :class:`Refused` where it is none of the forms.
    """
    if not isinstance(found, str):
        return read_quantity(found, dimension, NOT_NEGATIVE, "accuracy")
    size, _, meaning = found.partition(",")
    over = _deviations(meaning.strip(), found)
    share = _SHARE.fullmatch(size)
    if share is None:
        return Value(read_quantity(size.strip(), dimension, NOT_NEGATIVE, "accuracy").value / over)
    part = read_quantity(f"{share[1]} %", "dimensionless", NOT_NEGATIVE, "accuracy").value
    return Value(part * read_quantity(share[2].strip(), dimension, POSITIVE, "accuracy").value / over)


def _deviations(meaning: str, found: str) -> float:
    """How many standard deviations are stated."""
    if not meaning and "," not in found:
        return 1.0
    if meaning == "limit":
        return LIMIT
    factor = re.fullmatch(r"k\s*=\s*([0-9.]+)", meaning)
    try:
        number = float(factor[1]) if factor else 0.0
    except ValueError:
        number = 0.0
    if not 0.0 < number <= 10.0:
        raise Refused(f"found {found!r}; {_EXPECTED}", "accuracy")
    return number


def left_by_zero(accuracy: float, zero_std: float | None, span: float = SPAN_SHARE) -> float:
    """Standard deviation [SI] of what a sensor is off by under load.

    Args:
        accuracy: of the sensor [SI].
        zero_std: of the zero that was taken [SI]; None where none was, so that all of the accuracy is left.
        span: part of the accuracy that is no zero's [-].
    """
    return accuracy if zero_std is None else sqrt(zero_std**2 + (span * accuracy) ** 2)


def in_place(calibrated: datetime.date | None, test: datetime.date | None) -> bool:
    """Whether a sensor was calibrated where it is, near enough to the date of the ``test``."""
    return calibrated is not None and (test is None or abs((test - calibrated).days) <= VALID)
