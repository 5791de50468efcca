"""How uncertain the reduction is: it is repeated with every input drawn from what is known of it.

Drawn together, so that their common effect on C_i, m and the losses is kept: the biases of the sensors (stated
accuracy, or what a zero at ambient leaves), the slow wander of each sensor over a phase, the loaded mass and the
volume, the phase times and the pressures read at them.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass, field, fields

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.calibrate.blowdown import Inputs, Reduction, Tables, VaporPhase, reduce_all
from hfanalysis.thermo.saturation import Saturation

SEED = 20230101
"""Of the generator: every run of a test draws the same numbers, so that its intervals do not change."""

HELD = ("C_i", "K_loss", "m")
"""What may be held: as stated, and within what is stated of it."""

SYSTEMATIC, RANDOM = "systematic ", "random "
"""What begins the names of errors that are the same in a repeated test, and of those that are not."""

DRAWN = (
    *(f"{SYSTEMATIC}{name}" for name in ("mass", "volume", "area")),
    *(f"{RANDOM}{name}" for name in ("t_feed", "t_v", "t_end", "p_v", "p_end")),
    *(f"{SYSTEMATIC}{name}" for name in ("p_tank", "p_run", "p_chamber")),
)
"""The errors that are drawn, in the order of their numbers."""


@dataclass(frozen=True)
class InputSpread:
    """Standard deviations of the inputs: [kg], [m^3], [m^2], [s], [Pa].

    ``reading`` is the lower factor (2, 2) of the covariance of p_v and p_end, ``slopes`` [Pa/s] how they move with
    their times; ``bias`` that of p_tank, p_run, p_c over the run.
    """

    mass: float
    volume: float
    area: float
    t_feed: float
    t_v: float
    t_end: float
    reading: Array
    slopes: tuple[float, float]
    bias: tuple[float, float, float]
    held: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Draws:
    """The repeated reductions: one array per quantity, NaN where a draw has no answer.

    ``inputs`` holds what was drawn for them: loaded mass [kg], volume [m^3], area [m^2], biases of p_tank, p_run and
    p_c [Pa]; and, in standard deviations, every error by its name, "systematic ..." or "random ...".
    """

    values: dict[str, Array]
    inputs: dict[str, Array] = field(default_factory=dict)

    def std(self, name: str) -> float:
        """Standard deviation over the draws that have an answer, in the quantity's unit [SI]; NaN where fewer than ten
        do.
        """
        good = self.good(name)
        return float(good.std(ddof=1)) if good.size >= 10 else float("nan")

    @property
    def of_flow(self) -> float:
        """Relative standard deviation [-] of C_i N_i A_i, which an error of the area leaves as it is."""
        area = self.values["C_i"] * self.inputs["area"]
        good = area[np.isfinite(area)]
        return float(good.std(ddof=1) / abs(good.mean())) if good.size >= 10 else float("nan")

    @property
    def by_pressures(self) -> float:
        """Relative standard deviation [-] of C_i by pressures and times alone: of the flow's integral."""
        gone = self.inputs["mass"] - self.values["vapor_mass"]
        integral = gone / (self.values["C_i"] * self.inputs["area"])
        good = integral[np.isfinite(integral)]
        return float(good.std(ddof=1) / abs(good.mean())) if good.size >= 10 else float("nan")

    def interval(self, name: str, value: float) -> tuple[float, float]:
        """The 95 % interval [SI]: the draws' quantiles about their median, moved to the ``value`` itself."""
        good = self.good(name)
        low, middle, high = np.quantile(good, (0.025, 0.5, 0.975))
        return float(value + low - middle), float(value + high - middle)

    def answered(self, name: str) -> float:
        """Part of the draws [-] that have an answer."""
        return self.good(name).size / max(self.values[name].size, 1)

    def good(self, name: str) -> Array:
        """The draws (k,) that have an answer, in the quantity's unit [SI]."""
        values = self.values[name]
        return values[np.isfinite(values)]


def draw(
    tables: Tables, saturation: Saturation, inputs: Inputs, spread: InputSpread, samples: int,
    vapor_phase: VaporPhase | None = None,
) -> Draws:  # fmt: skip
    """Repeat the reduction ``samples`` times with inputs drawn from normal distributions (same seed each time)."""
    generator = np.random.default_rng(SEED)
    z = generator.standard_normal((samples, 11))
    own = generator.standard_normal((samples, len(HELD)))
    rows, shifts = _drawn(inputs, spread, z, own), np.asarray(z[:, 8:11] * spread.bias)
    found = reduce_all(tables, saturation, rows, shifts, vapor_phase or VaporPhase.plain(saturation, inputs))
    values = {f.name: column for f, column in zip(fields(Reduction), found.T, strict=True)}
    return Draws(values, _what_was_drawn(rows, shifts) | _deviates(spread, z, own))


def _held(inputs: Inputs, spread: InputSpread, z: Array) -> Array:
    """What is held, drawn (samples, 3); a factor stays positive, and what is not held is NaN."""
    stated = np.array([getattr(inputs, name) for name in HELD])
    return np.asarray(np.maximum(stated + z * spread.held, 1e-3 * stated))


def _what_was_drawn(rows: Array, shifts: Array) -> dict[str, Array]:
    found = dict(zip(("mass", "volume", "area"), rows[:, :3].T, strict=True))
    return found | {f"p_{n}": column for n, column in zip(("tank", "run", "chamber"), shifts.T, strict=True)}


def _deviates(spread: InputSpread, z: Array, own: Array) -> dict[str, Array]:
    """What was drawn in standard deviations, of what has one."""
    known = (spread.mass, spread.volume, spread.area, spread.t_feed, spread.t_v, spread.t_end, 1.0, 1.0, *spread.bias)
    columns = zip((*DRAWN, *(f"{SYSTEMATIC}{n}" for n in HELD)), (*known, *spread.held), (*z.T, *own.T), strict=True)
    return {name: column for name, std, column in columns if std > 0.0}


def _drawn(inputs: Inputs, spread: InputSpread, z: Array, own: Array) -> Array:
    """The inputs of every repetition, (samples, 11): rows as the fields of :class:`Inputs`."""
    stds = (spread.mass, spread.volume, spread.area, spread.t_feed, spread.t_v, spread.t_end)
    off = z[:, :6] * stds
    read = z[:, 6:8] @ spread.reading.T + off[:, 4:6] * spread.slopes
    return np.column_stack([np.array(astuple(inputs)[:8]) + np.hstack([off, read]), _held(inputs, spread, own)])
