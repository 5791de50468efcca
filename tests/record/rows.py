"""A small log whose numbers are known, for the tests of readers to write in their own ways."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from tests.record import make

from hfanalysis.record.log import TestLog

NAMES = ("time", "PT", "PR", "LC")
COUNT = 120
T = 0.02 * np.arange(COUNT)
_RNG = np.random.default_rng(7)
VALUES = np.round(
    np.column_stack(
        [
            T - 1.0,
            6535.0 + _RNG.normal(scale=40.0, size=COUNT),
            118.0 + 2400.0 * (T > 1.0),
            _RNG.normal(3.0, 9.0, COUNT),
        ]
    ),
    3,
)
TOML = make.LOG + "".join(
    f'[channels.{name}]\ncolumn = "{column}"\nunit = "{unit}"\n'
    for name, column, unit in (("p_tank", "PT", "kPa"), ("p_run", "PR", "kPa"), ("thrust", "LC", "N"))
)


def text(form: str = "{:.3f}", mark: str = ",", names: tuple[str, ...] = NAMES) -> str:
    """The log as CSV."""
    return mark.join(names) + "\n" + "".join(mark.join(map(form.format, row)) + "\n" for row in VALUES)


def read(folder: Path, content: str | bytes, toml: str = TOML) -> TestLog:
    """The log in a file of this content."""
    return make.read(folder, toml, {"log.csv": content})


def assert_unspoilt(log: TestLog, decimals: int = 3, lost: int = 0) -> None:
    """All numbers and instants are those of the log, but for its last ``lost`` rows."""
    kept = COUNT - lost
    np.testing.assert_allclose(np.diff(log["p_tank"].time), np.diff(T[:kept]), atol=1e-6)
    for name, column, unit in (("p_tank", 1, 1e3), ("p_run", 2, 1e3), ("thrust", 3, 1.0)):
        raw = log[name].raw if log[name].raw is not None else log[name].values
        written = [float(f"{value:.{decimals}f}") for value in VALUES[:kept, column]]
        np.testing.assert_allclose(raw / unit, written, atol=1e-6)
