"""What may be stated of a sensor's accuracy, against deviations computed by hand."""

from __future__ import annotations

import datetime
from math import sqrt

import pytest

from hfanalysis.record.accuracy import in_place, left_by_zero, read_accuracy
from hfanalysis.record.schema import Refused

PSI = 6894.757293168361


@pytest.mark.parametrize(
    ("stated", "std"),
    [
        ("2 psi", 2.0),
        ("2 psi, k=2", 1.0),
        ("3 psi, k = 3", 1.0),
        ("2 psi, limit", 2.0 / sqrt(3.0)),
        ("0.25 % of 500 psi", 1.25),
        ("0.25 % of 500 psi, limit", 1.25 / sqrt(3.0)),
        ("0.25% of 500 psi, k=2", 0.625),
    ],
)
def test_an_accuracy_is_one_standard_deviation_however_it_is_stated(stated: str, std: float) -> None:
    assert read_accuracy(stated, "pressure_difference").value == pytest.approx(std * PSI, rel=1e-12)


@pytest.mark.parametrize(
    "stated", ["2 psi, k=0", "2 psi, k=two", "2 psi, max", "2 psi,", "0.25 % of", "1 % of -5 psi", "-2 psi", "k=2", "2"]
)
def test_what_is_none_is_refused(stated: str) -> None:
    with pytest.raises(Refused):
        read_accuracy(stated, "pressure_difference")


def test_a_zero_takes_away_the_zeros_half_of_the_variance() -> None:
    assert left_by_zero(2.0, None) == 2.0
    assert left_by_zero(2.0, 0.0) == pytest.approx(sqrt(2.0), rel=1e-4)
    assert left_by_zero(0.0, 0.5) == 0.5


def test_a_calibration_in_place_counts_for_a_year() -> None:
    test = datetime.date(2022, 4, 3)
    assert in_place(datetime.date(2021, 4, 4), test)
    assert in_place(datetime.date(2022, 5, 1), test)
    assert not in_place(datetime.date(2021, 3, 1), test)
    assert not in_place(None, test)
