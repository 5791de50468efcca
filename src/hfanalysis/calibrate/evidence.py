"""What one test says about its fuel's regression: chamber pressure, burn time, fuel left, port; and the model of these.

The model is the unsteady engine without any measured input. Its tank starts from the pressure extrapolated from the
liquid phase, and what the tank's calibration leaves open (loaded mass, injector, feed loss, exponent, sensor biases) is
carried along as a covariance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.calibrated import Regression, starting_for
from hfanalysis.engine.equations import O_CHAMBER_PRESSURE, RADIUS
from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.errors import AbsentError

NUISANCES = ("oxidizer_mass", "area", "loss_factor", "exponent", "volume", "tank_pressure", "chamber_pressure",
             "fuel_mass", "throat_area", "port_radius")  # fmt: skip
"""What the model takes from elsewhere, in the order of the covariance."""


@dataclass(frozen=True)
class Scalar:
    """A single observation with its standard deviation, and in words where it comes from."""

    value: float
    std: float
    source: str


@dataclass(frozen=True)
class Ports:
    """Radii of the port [m] at times [s] of the burn, (k,) each, with the scatter [m] of one by its sensor alone."""

    time: Array
    radius: Array
    std: float


NO_PORTS = Ports(np.zeros(0), np.zeros(0), 1.0)


@dataclass(frozen=True)
class Evidence:
    """One test's evidence.

    ``time`` [s] and ``chamber`` [Pa]: block means of the chamber pressure; ``burn_time`` [s]: the fuel is gone;
    ``fuel_left`` [kg] at ``end`` [s]; ``ports``: radii of the port measured while it burnt; ``anchor``: instant [s] and
    tank pressure [Pa] from which the start is extrapolated; ``covariance`` of NUISANCES [SI], a square matrix;
    ``least`` [Pa]: scatter of a block mean by the sensor alone; ``wander`` [Pa^2]: covariance of the chamber pressures
    by the slow wander of their sensor. ``remarks`` say what the fit rests on.
    """

    test: str
    engine: Engine
    time: Array
    chamber: Array
    burn_time: Scalar | None
    fuel_left: Scalar | None
    end: float
    anchor: tuple[float, float]
    covariance: Array
    least: float
    wander: Array
    remarks: tuple[str, ...] = ()
    ports: Ports = NO_PORTS
    _known: dict[tuple[str, Regression], Any] = field(default_factory=dict, init=False, compare=False, repr=False)

    def _once(self, what: str, law: Regression, find: Callable[[], Array | None]) -> Array | None:
        """What has been found with these constants before, for searches come back to where they were."""
        if (what, law) not in self._known:
            found = self._known[what, law] = find()
            if found is not None:
                found.flags.writeable = False
        known: Array | None = self._known[what, law]
        return known

    @cached_property
    def observed(self) -> Array:
        """All observations in one vector (n,): chamber pressures [Pa], then burn time [s], fuel left [kg] and radii of
        the port [m], as far as there are.
        """
        return np.concatenate((self.chamber, [s.value for s in self.scalars], self.ports.radius))

    @property
    def scalars(self) -> tuple[Scalar, ...]:
        """Burn time and fuel left, as far as there are."""
        return tuple(s for s in (self.burn_time, self.fuel_left) if s is not None)

    @property
    def scales(self) -> Array:
        """Standard deviations of what follows the chamber's pressures: burn time [s], fuel left [kg], radii of the port
        [m], as far as there are."""
        return np.array([*(s.std for s in self.scalars), *[self.ports.std] * self.ports.time.size])

    def with_regression(self, law: Regression) -> Evidence:
        """The same evidence with the start extrapolated by an engine with this regression."""
        lit = replace(self.engine, a=law.a, n=law.n)
        return replace(self, engine=starting_for(lit, *self.anchor))

    def moved(self, off: Array) -> Evidence:
        """The same with observations that differ by ``off`` (n,) [Pa, s, kg, m]."""
        size, ports = self.time.size, off.size - self.ports.time.size
        scalars = iter(off[size:ports])
        times, left = (None if s is None else replace(s, value=s.value + float(next(scalars)))
                       for s in (self.burn_time, self.fuel_left))  # fmt: skip
        seen = replace(self.ports, radius=self.ports.radius + off[ports:])
        return replace(self, chamber=self.chamber + off[:size], burn_time=times, fuel_left=left, ports=seen)

    def predict(self, law: Regression) -> Array | None:
        """The model of ``observed`` (n,) [Pa, s, kg]; None where the engine cannot be run with these constants."""
        return self._once("predicted", law, lambda: predicted(self, replace(self.engine, a=law.a, n=law.n)))

    def burnt(self, law: Regression) -> Burn:
        """The whole burn with these constants."""
        return burn(replace(self.engine, a=law.a, n=law.n), longest=self.longest)

    @property
    def longest(self) -> float:
        """When a burn is given up [s]."""
        return 2.0 * max(self.end, float(self.time[-1])) + 5.0

    def sensitivities(self, law: Regression) -> Array:
        """Change of ``observed`` [Pa, s, kg] per standard deviation of each nuisance, (observations, nuisances)."""
        found = self._once("slopes", law, lambda: self._sensitivities(law))
        assert found is not None
        return found

    def _sensitivities(self, law: Regression) -> Array:
        center = self.predict(law)
        columns = np.zeros((self.observed.size, len(NUISANCES)))
        for j, (name, step) in enumerate(zip(NUISANCES, np.sqrt(np.diag(self.covariance)), strict=True)):
            moved = self._moved(law, name, float(step)) if step > 0.0 else None
            if moved is not None and center is not None:
                columns[:, j] = moved - center
        return columns

    def _moved(self, law: Regression, name: str, step: float) -> Array | None:
        """The prediction with one nuisance off by ``step``."""
        if name in ("chamber_pressure", "port_radius"):
            found, size = self.predict(law), self.observed.size
            first, last = (0, self.time.size) if name == "chamber_pressure" else (size - self.ports.time.size, size)
            return None if found is None else found + step * ((np.arange(size) >= first) & (np.arange(size) < last))
        engine, anchor = replace(self.engine, a=law.a, n=law.n), self.anchor
        if name == "tank_pressure":
            anchor = (anchor[0], anchor[1] + step)
        try:
            return predicted(self, starting_for(_shifted(engine, name, step), *anchor))
        except AbsentError:
            return None


def _shifted(engine: Engine, name: str, step: float) -> Engine:
    feed = engine.feed
    if name in ("area", "loss_factor", "volume"):
        return replace(engine, feed=replace(feed, **{name: getattr(feed, name) + step}))
    if name in ("oxidizer_mass", "fuel_mass", "throat_area"):
        return replace(engine, **{name: getattr(engine, name) + step})
    if name == "exponent":
        return replace(engine, polytropic_exponent=(engine.polytropic_exponent or 1.0) + step)
    return engine


def predicted(evidence: Evidence, engine: Engine) -> Array | None:
    """What an ``engine`` would have shown, as ``evidence.observed`` (n,) [Pa, s, kg, m]; None where it cannot run."""
    try:
        burnt = burn(engine, longest=evidence.longest)
    except (ValueError, ArithmeticError):
        return None
    timed = evidence.burn_time is not None
    return np.concatenate((chamber_at(engine, burnt, evidence.time, timed), _scalars(evidence, engine, burnt)))


def chamber_at(engine: Engine, burnt: Burn, time: Array, timed: bool = True) -> Array:
    """Modeled chamber pressure [Pa], (n,), at given times (n,) [s].

    After the burn it is that of its end where the end itself is ``timed``, so that a burn that is short by a moment is
    not held against the constants twice, and far too heavily; else ambient.
    """
    begin, end = np.searchsorted(burnt.time, (time[0], time[-1]))
    points = burnt.time[max(begin - 1, 0) : end + 1]
    pressure = burnt.steps.at(points)[1][:, O_CHAMBER_PRESSURE]
    later = burnt.last("chamber_pressure") if timed else engine.ambient
    return np.asarray(np.interp(time, points, pressure, right=later))


def _scalars(evidence: Evidence, engine: Engine, burnt: Burn) -> list[float]:
    out = []
    if evidence.burn_time is not None:
        out.append(burn_time_of(engine, burnt))
    if evidence.fuel_left is not None:
        radius = float(np.interp(evidence.end, burnt.time, burnt.state("port_radius")))
        out.append(engine.grain.fuel(radius))
    return [*out, *np.interp(evidence.ports.time, burnt.time, burnt.state("port_radius"))]


def burn_time_of(engine: Engine, burnt: Burn) -> float:
    """When the fuel is gone [s]; for a burn that was given up before, carried on at its last rate."""
    if burnt.fuel_out:
        return burnt.burn_time
    port = float(burnt.steps.end[-1, RADIUS])
    rate = float(burnt.last("fuel_flow") / engine.grain.ring(port))
    return burnt.burn_time + min((engine.outer_radius - port) / max(rate, 1e-9), 10.0 * burnt.burn_time)
