"""What each governing equation lacks, from measured channels alone: its weak-form residual.

The equation is multiplied by a smooth test function half a second to a second long and integrated; where it holds the
derivative of something measured, integration by parts moves that derivative onto the test function, so that noise is
never differentiated (as in weak-form identification: Messenger and Bortz, J. Comput. Phys. 443 (2021) 110525).
No run of the model and no fit is needed: nothing but the constants of the engine is taken from elsewhere.

The bands hold the noise of the channels (their offsets too) and the uncertainty of the constants, to first order.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.weak_form.cells import (
    Cells,
    Piece,
    Reading,
    Readings,
    Sampled,
    cells_of,
    columns,
    sample,
    within,
)
from hfanalysis.diagnose.weak_form.cells import windows as windows_of
from hfanalysis.diagnose.weak_form.chamber_balance import ChamberBalance
from hfanalysis.diagnose.weak_form.linear import LinearHistory
from hfanalysis.diagnose.weak_form.spread import Spread
from hfanalysis.diagnose.weak_form.tank_balance import TankBalance
from hfanalysis.engine.equations import O_ENTHALPY, O_OXIDIZER_FLOW
from hfanalysis.engine.observe import observe
from hfanalysis.engine.unsteady import Burn, Engine, burn

WINDOW = 0.8
"""Length of a test function [s]."""

UNITS = {
    "tank_energy": "W",
    "tank_volume": "L",
    "injector": "kg/s",
    "feed": "bar",
    "chamber_mass": "kg/s",
    "nozzle": "N",
}
"""Governing equations and the units of their residuals."""

NEEDED = {
    "tank_energy": ("p_tank", "p_chamber"),
    "tank_volume": ("p_tank", "p_chamber"),
    "injector": ("p_tank", "p_chamber"),
    "feed": ("p_tank", "p_run", "p_chamber"),
    "chamber_mass": ("p_tank", "p_chamber"),
    "nozzle": ("p_chamber", "thrust"),
}
"""Channels without which an equation says nothing."""

USED = ("p_tank", "p_run", "p_chamber", "thrust")

OUT_OF_RANGE = "the tank's pressure leaves the range of saturated nitrous oxide"


@dataclass(frozen=True)
class WeakResidual:
    """What an equation lacks over time, or the ``reason`` why that cannot be said.

    ``time`` [s after the opening]: middles of the test functions; ``value`` and ``std`` [``unit``]; ``covariance`` of
    the values; ``phases``: the phase of each; ``explained``: what the engine's own effects leave in the same residual
    (zero for an engine without any). ``closing`` [kg]: for tank_volume, what the injector's flow leaves in the tank at
    the end of the liquid less the vapor that fits it, with its standard deviation.
    """

    equation: str
    unit: str
    time: Array
    value: Array
    std: Array
    covariance: Array
    phases: tuple[str, ...]
    explained: Array
    closing: tuple[float, float] | None = None
    reason: str | None = None

    @classmethod
    def absent(cls, equation: str, reason: str) -> WeakResidual:
        """A residual that cannot be had."""
        none = np.zeros(0)
        return cls(equation, UNITS[equation], none, none, none, np.zeros((0, 0)), (), none, reason=reason)

    @property
    def left(self) -> Array:
        """What the engine with its effects does not explain (n,) [``unit``]."""
        return self.value - self.explained


def weak_residuals(
    readings: Readings, engine: Engine, spread: Spread | None = None, window: float = WINDOW
) -> tuple[WeakResidual, ...]:
    """The residual of every equation of UNITS, in that order, each in its unit there.

    ``readings``: an ``Observed``; ``engine``: that of the test, or of a fitted hypothesis; ``spread``: how well its
    constants are known (default: exactly); ``window``: length of the test functions [s]. A residual that cannot be had
    says why.
    """
    measured = _Measured.of(readings, window)
    balances = _balances(measured, engine, spread or Spread.none())
    found = [_residual(name, measured, balances, window) for name in UNITS]
    if engine.effects:
        found = _with_explained(found, measured, readings, engine, window)
    return tuple(found)


@dataclass(frozen=True)
class _Measured:
    """Channels on cells."""

    cells: Cells
    readings: Mapping[str, Reading]
    sampled: Mapping[str, Sampled]
    phases: Mapping[str, float]

    @classmethod
    def of(cls, readings: Readings, window: float) -> _Measured:
        cells, used, sampled = cells_of(readings, window), {}, {}
        alike: dict[bytes, Sampled | None] = {}
        for channel in readings.channels:
            if channel.name not in USED:
                continue
            time = channel.time[within(channel, cells.end)]
            found = alike[key] if (key := time.tobytes()) in alike else sample(time, cells)
            alike[key] = found
            if found is not None:
                used[channel.name], sampled[channel.name] = channel, found
        return cls(cells, used, sampled, readings.phases)

    def values(self, name: str) -> Array:
        """A channel on cells and at the end of the liquid."""
        reading = self.readings[name]
        return np.asarray(self.sampled[name].weights @ reading.value[within(reading, self.cells.end)])

    def covariance(self, name: str) -> Array:
        """Of :meth:`values`."""
        reading = self.readings[name]
        return self.sampled[name].covariance(reading, within(reading, self.cells.end))


@dataclass(frozen=True)
class _Balances:
    """What the equations are made of, where the channels allow it."""

    tank: TankBalance | None
    chamber: ChamberBalance | None

    def pieces(self, equation: str) -> list[Piece]:
        """An equation, phase by phase."""
        owner = self.chamber if equation in ("chamber_mass", "nozzle") else self.tank
        pieces: list[Piece] = getattr(owner, equation)()
        return pieces


def _balances(measured: _Measured, engine: Engine, spread: Spread) -> _Balances:
    names = list(measured.readings)
    slopes = columns([*(measured.covariance(n) for n in names), spread.matrix()])
    whole = {n: LinearHistory(measured.values(n), s) for n, s in zip(names, slopes, strict=False)}
    return _joined(measured, engine, whole, spread.constants(engine, slopes[-1]))


def _joined(
    measured: _Measured, engine: Engine, whole: Mapping[str, LinearHistory], constants: Mapping[str, LinearHistory]
) -> _Balances:
    """The balances between channels that are given on cells and at the end of the liquid."""
    cells = measured.cells
    channels = {name: h[0:-1] for name, h in whole.items()}
    if "p_chamber" not in channels:
        return _Balances(None, None)
    if "p_tank" in channels and _saturated(engine, channels["p_tank"].value[cells.phases[0]]):
        edge = None if cells.liquid_out is None else whole["p_tank"][cells.time.size : cells.time.size + 1]
        tank = TankBalance(engine, cells, channels, constants, edge)
        return _Balances(tank, ChamberBalance(engine, cells, channels, constants, tank.flow, tank.enthalpy))
    flow, enthalpy = _assumed(engine, cells)
    known = LinearHistory(flow, np.zeros_like(channels["p_chamber"].slopes))
    return _Balances(None, ChamberBalance(engine, cells, channels, constants, known, enthalpy))


def _saturated(engine: Engine, pressure: Array) -> bool:
    low, high = engine.saturation.pressure_range
    return bool(low < pressure.min() and pressure.max() < high)


def _assumed(engine: Engine, cells: Cells) -> tuple[Array, Array]:
    """Oxidizer flow [kg/s] and its enthalpy [J/kg] by the model's own run, for a tank that was not recorded: the thrust
    at a given chamber pressure hardly depends on them."""
    done = burn(replace(engine, effects=()), float(cells.time[-1]) + 1.0, run_on=True)
    _, outputs = done.steps.at(cells.time)
    return outputs[:, O_OXIDIZER_FLOW].copy(), outputs[:, O_ENTHALPY].copy()


def _residual(equation: str, measured: _Measured, balances: _Balances, window: float) -> WeakResidual:
    missing = [name for name in NEEDED[equation] if name not in measured.readings]
    if missing:
        return WeakResidual.absent(equation, f"{' and '.join(missing)} {'is' if len(missing) == 1 else 'are'} missing")
    if balances.tank is None and "p_tank" in NEEDED[equation]:
        return WeakResidual.absent(equation, OUT_OF_RANGE)
    needed = set(NEEDED[equation])
    if "p_run" in measured.readings and equation != "nozzle":
        needed.add("p_run")
    covered = np.all([measured.sampled[name].covered for name in needed], axis=0)
    time, values, slopes = [], [], []
    for piece in balances.pieces(equation):
        found = windows_of(measured.cells, piece.part, covered, window)
        if not found.time.size:
            continue
        history = found.of(piece.rate, piece.stored)
        scale = np.ones(found.time.size) if piece.scale is None else found.mean @ piece.scale
        time.append(found.time)
        values.append(history.value * scale)
        slopes.append(history.slopes * scale[:, None])
    if not time:
        return WeakResidual.absent(equation, f"no stretch of {window:.1f} s without a gap was recorded")
    return _made(equation, measured, np.concatenate(time), np.concatenate(values), np.concatenate(slopes), balances)


def _made(
    equation: str, measured: _Measured, time: Array, value: Array, slopes: Array, balances: _Balances
) -> WeakResidual:
    if not (np.isfinite(value).all() and np.isfinite(slopes).all()):
        return WeakResidual.absent(equation, "what was measured is outside the range of the equations")
    covariance = np.asarray(slopes @ slopes.T)
    closing = None
    if equation == "tank_volume" and balances.tank is not None and (mass := balances.tank.closing_mass()) is not None:
        closing = (float(mass.value[0]), float(np.sqrt(mass.covariance[0, 0])))
    return WeakResidual(
        equation, UNITS[equation], time, value, np.sqrt(covariance.diagonal()), covariance,
        _phases(measured.phases, time), np.zeros_like(value), closing,
    )  # fmt: skip


def _phases(phases: Mapping[str, float], time: Array) -> tuple[str, ...]:
    """The phase in which each instant lies."""
    names = sorted((n for n in phases if n != "end"), key=lambda n: phases[n])
    if not names:
        return ("",) * time.size
    number = np.searchsorted([phases[n] for n in names], time, side="right") - 1
    return tuple(names[max(int(i), 0)] for i in number)


def _with_explained(
    found: Sequence[WeakResidual], measured: _Measured, readings: Readings, engine: Engine, window: float
) -> list[WeakResidual]:
    """The residuals with what the engine's effects leave in them: those of its own run's channels."""
    base = replace(engine, effects=())
    done = burn(engine, readings.end + 1.0, run_on=True)
    whole = {}
    for name, sampled in measured.sampled.items():
        reading = measured.readings[name]
        times = _aligned(done, readings, reading.time[within(reading, measured.cells.end)])
        value = sampled.weights @ observe(done, times)[name]
        whole[name] = LinearHistory(value, np.zeros((value.size, 0)))
    balances = _joined(measured, base, whole, Spread.none().constants(base, np.zeros((0, 0))))
    out = []
    for residual in found:
        if residual.reason is None:
            same = _residual(residual.equation, measured, balances, window)
            explained = same.value if same.reason is None else np.zeros_like(residual.value)
            residual = replace(residual, explained=explained)
        out.append(residual)
    return out


def _aligned(done: Burn, readings: Readings, times: Array) -> Array:
    """Instants of a run that correspond to measured ones: its liquid ends when the measured does, and it burns on."""
    seen, gone = readings.phases.get("vapor"), done.liquid_out
    if seen is not None and gone is not None:
        times = np.where(times < seen, times * gone / seen, times + gone - seen)
    last = done.burn_time if done.fuel_out else float(done.steps.times[-1, 1])
    return np.minimum(times, last)
