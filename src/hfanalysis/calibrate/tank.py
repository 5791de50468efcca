"""The tank's calibration from log, phases and test.toml: assembles inputs, reduces, draws, and judges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.calibrate.beside_report import beside_report
from hfanalysis.calibrate.blowdown import Inputs, Reduction, Tables, VaporPhase, reduce
from hfanalysis.calibrate.budgets import budgets
from hfanalysis.calibrate.calibration import TankCalibration
from hfanalysis.calibrate.course import with_course
from hfanalysis.calibrate.diagnostics import coefficient_history, other_masses, rest_of, tank_history
from hfanalysis.calibrate.feed_loss import estimated_share
from hfanalysis.calibrate.head_pressure import before_injector
from hfanalysis.calibrate.loaded_mass import UNSTATED, LoadedMass, loaded_mass
from hfanalysis.calibrate.measured_pressures import MeasuredPressures, PressureReading, read_at
from hfanalysis.calibrate.stated import Held
from hfanalysis.calibrate.systematic import systematic_errors, with_systematic
from hfanalysis.calibrate.uncertainty import HELD, Draws, InputSpread, draw
from hfanalysis.calibrate.verdicts import judge_discharge, judge_exponent, judged, looked_up
from hfanalysis.calibrate.water_flow import calibrate_water, is_water
from hfanalysis.calibrate.with_effects import acting
from hfanalysis.engine.effect import Active
from hfanalysis.engine.injector import mass_flows
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.products.calibration import CoefficientHistory, Rest, TankConstants, TankHistory
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import CONDITIONAL, DERIVED, IDENTIFIED, NOT_IDENTIFIABLE, STATED, Quantity
from hfanalysis.record.accuracy import SPAN_SHARE, left_by_zero
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import live_signals
from hfanalysis.thermo.nitrous import saturation as saturation_of
from hfanalysis.thermo.saturation import Saturation
from hfanalysis.units import Value

VAPOR_PRESSURE_SHARE = 0.6
"""Without nitrogen the vapor phase is followed until the tank has this share of its pressure at t_v. Evidence:
test_deviations.py, test_refusals.py: the m of a tank that lost two fifths is found."""

FEWEST = 8
"""Samples on either side of an instant that a pressure there is read from. Evidence: a vapor phase of fewer was read
across its other end, and m came out by three deviations too high (test_refusals.py)."""

WEIGHING_SPAN = 0.25
"""Part of a sensor's accuracy, beside its zero, that weighs the fit of a and n; the span is off in every repetition
alike, and all of it widens their intervals. Evidence: with all of it in the weights, a misfit of 0.6 bar by another
course of the fire counted as the sensors', and n went to the end of its range."""

LONGEST_GAP = 0.1
"""Part of the liquid phase that one channel may miss in one piece; good samples around it are joined linearly."""

PEAK_OVER = 0.1
"""Seconds over which the peak flow is a mean."""

FULLEST = 1.05
"""Loaded mass over what the tank holds as liquid at the bulk's temperature, from which on the input is refused.
Evidence: test_rest.py: a mass that does not fit the tank at all is an error of the input."""

NAMES = ("C_i", "m", "Z", "K_loss", "p_loss_liquid", "p_loss_vapor", "oxidizer_flow_peak", "oxidizer_mass_liquid_phase",
         "vapor_mass_at_t_v", "mass_at_t_feed", "oxidizer_mass")  # fmt: skip

BY_RUN_LINE = ("C_i", "K_loss", "p_loss_liquid", "p_loss_vapor", "oxidizer_flow_peak", "mass_at_t_feed")
"""Of these, those that rest on the pressure before the injector."""

BY_MASS = ("C_i", "oxidizer_flow_peak", "oxidizer_mass_liquid_phase", "mass_at_t_feed", "oxidizer_mass")
"""Of these, those that are worth what the loaded mass is worth."""


def calibrate(
    log: TestLog, segments: Segments, definition: TestDefinition, samples: int, effects: Sequence[Active] = ()
) -> TankCalibration:
    """Calibrate the tank of one test, ``effects`` acting; ``samples`` repetitions give the intervals.

    Raises AbsentError where neither C_i nor anything else can be had because p_tank, p_run or t_v is missing.
    """
    if is_water(segments, definition):
        return TankCalibration(calibrate_water(log, segments, definition))
    t_v = segments.time("t_v")
    if t_v is None:
        raise AbsentError(
            f"test {definition.test.id}: no end of the liquid to calibrate with: {segments.events['t_v'].reason}"
        )
    read = before_injector(log, segments, definition)
    return _Work(read, segments, definition, t_v, effects).result(samples)


class _Work:
    """One calibration under way: the inputs with where they come from, and what has been noticed."""

    def __init__(
        self, log: TestLog, segments: Segments, definition: TestDefinition, t_v: float, effects: Sequence[Active]
    ) -> None:
        self.effects = [active for active in effects if active.effect.term is not None and not active.idle]
        self.log, self.segments, self.definition, self.t_v = log, segments, definition, t_v
        self.saturation: Saturation = saturation_of(definition.model.properties)
        self.notes: list[str] = []
        self.warnings: list[str] = []
        self.lost: Value | None = None
        if "p_run" not in live_signals(log) and "p_tank" in log:
            self.lost, self.estimated = estimated_share(log, segments, definition, self.saturation)
            self.warnings.append(self.estimated)
        lost = self.lost.value if self.lost is not None else None
        self.histories = MeasuredPressures.of(log, segments, definition, self._last(t_v), lost)
        self.notes.extend(self.histories.assumed)
        self.t_feed = segments.time("t_feed") or 0.0
        self.volume = definition.tank.volume if definition.tank else None
        self.area = definition.injector.area if definition.injector else None
        self.at_v = self._read(t_v, 0.3, 0.3, True, self._until_purge())
        self.t_end, self.t_end_std, self.end_reason = self._vapor_end()
        fed = segments.time("t_purge") is not None
        self.at_end = self._read(self.t_end, self.t_end - t_v, 0.3, fed) if np.isfinite(self.t_end) else None
        low, high = self.saturation.pressure_range
        at_end = float(self.saturation.temperature(np.clip(self.at_v.value, low, 0.999 * high)))
        self.held = Held.of(definition, self.saturation, at_end)

    def result(self, samples: int) -> TankCalibration:
        """Reduce, draw, judge."""
        losses_only = self._losses()
        blocked = self._blocked()
        mass = self._mass() if not blocked else None
        if blocked or mass is None or self.volume is None or self.area is None:
            reason = blocked or self._missing(mass)
            quantities = {n: Quantity.absent(reason, verdict=NOT_IDENTIFIABLE) for n in NAMES} | losses_only
            held = {name: self.held.quantity(name) for name in self.held.values}
            return TankCalibration(self._constants(quantities | held))
        return self._reduced(mass, samples)

    def _mass(self) -> LoadedMass | None:
        """What was loaded [kg]; where nobody weighed it, what the stated injector has let through and left."""
        found = loaded_mass(self.log, self.segments, self.definition, self.saturation, self.histories, self.at_v.value)
        if "C_i" not in self.held.values or self.volume is None or self.area is None or (found and found.weighed):
            return found
        inputs = self._inputs(1.0)
        nominal = reduce(Tables.of(self.histories, self.saturation), self.saturation, inputs)
        gone = float(np.interp(self.t_v, self.histories.time, self._mass_left(nominal, inputs)))
        std = gone * float(np.hypot(self.held.std("C_i") / self.held.value("C_i"), UNSTATED))
        mass = nominal.vapor_mass + gone
        return LoadedMass(
            mass, std, f"{mass:.2f} +/- {std:.2f} kg from the stated C_i; none was weighed", weighed=False
        )

    def _inputs(self, mass: float) -> Inputs:
        """Of a reduction with a loaded ``mass`` [kg]."""
        assert self.volume is not None
        assert self.area is not None
        p_end = self.at_end.value if self.at_end else float("nan")
        times = (self.t_feed, self.t_v, self.t_end)
        found = Inputs(mass, self.volume.value, self.area.value, *times, self.at_v.value, p_end)
        return replace(found, **{name: self.held.value(name) for name in HELD})

    def _reduced(self, mass: LoadedMass, samples: int) -> TankCalibration:
        inputs = self._inputs(mass.value)
        self._check_fit(inputs)
        tables = Tables.of(self.histories, self.saturation)
        plain = inputs
        inputs, vapor = self._acting(tables, plain)
        nominal = reduce(tables, self.saturation, inputs, phase=vapor)
        self.notes.append(f"loaded mass: {mass.source}")
        left = self._mass_left(nominal, inputs)
        rest, remarks = rest_of(self.log, self.segments, self.saturation, self.histories, inputs, nominal, left, mass)
        self.warnings.extend(remarks)
        mass = mass.against(other_masses(rest, mass))
        spread = self._spread(mass)
        draws = draw(tables, self.saturation, inputs, spread, samples, vapor)
        weigh = draw(tables, self.saturation, inputs, replace(spread, bias=self._biases(WEIGHING_SPAN)), samples, vapor)
        self.errors = systematic_errors(self.definition, self.histories, self.saturation, plain)
        whole = with_systematic(draws, self.errors)
        history = coefficient_history(self.saturation, self.histories, inputs, left)
        content = tank_history(self.saturation, self.histories, inputs, left)
        quantities = self._quantities(nominal, whole, inputs, left)
        steady = quantities["C_i"].std or 0.0
        quantities["C_i"] = self._over_time(quantities["C_i"], draws, history, left)
        course = max((quantities["C_i"].std or 0.0) ** 2 - steady**2, 0.0) ** 0.5
        if self.held.values:
            by_log = self._by_log(tables, inputs, mass, samples, vapor)
            quantities |= {name: self.held.quantity(name, by_log[name]) for name in by_log}
            self.warnings.extend(self.held.contradictions(by_log))
        verdict = IDENTIFIED if mass.weighed else DERIVED
        quantities["oxidizer_mass"] = Quantity(mass.value, "kg", mass.std, verdict=verdict, why=mass.source)
        for words in mass.doubts:
            quantities |= {name: quantities[name].doubted(words) for name in BY_MASS}
        alone = nominal if inputs is plain else reduce(tables, self.saturation, plain)
        beside = beside_report(
            self.histories, self.saturation, plain, alone, whole, spread, quantities, self.end_reason
        )
        constants = self._constants(quantities | beside, rest, history, content)
        return TankCalibration(constants.but(budget=budgets(whole, constants, course)), weigh, whole)

    def _over_time(
        self, discharge: Quantity, draws: Draws, history: CoefficientHistory | None, left: Array
    ) -> Quantity:
        """C_i with what its course over time is worth; one that is held is what it is."""
        if "C_i" in self.held.values:
            return discharge
        wet = self.histories.time < self.t_v
        time = self.histories.time[wet]
        return with_course(
            discharge, abs(discharge.value or 0.0) * draws.by_pressures, history, time, np.gradient(left[wet], time)
        )

    def _by_log(
        self, tables: Tables, inputs: Inputs, mass: LoadedMass, samples: int, vapor: VaporPhase | None
    ) -> dict[str, Quantity]:
        """What the log says of what is held."""
        loose = replace(inputs, **dict.fromkeys(HELD, np.nan))
        nominal = reduce(tables, self.saturation, loose, phase=vapor)
        record = draw(tables, self.saturation, loose, self._spread(mass), samples, vapor)
        draws = with_systematic(record, systematic_errors(self.definition, self.histories, self.saturation, loose))
        found = {"m": judge_exponent(nominal, draws, loose, self.end_reason, self.saturation)}
        found["K_loss"] = judged("K_loss", nominal.K_loss, "1/m^4", draws)
        found["C_i"] = judge_discharge(nominal, draws, self._excluded_share())
        if not mass.weighed and "C_i" in self.held.values:
            found["C_i"] = Quantity.absent("the load was not weighed, and follows from it")
        return {name: quantity for name, quantity in found.items() if name in self.held.values}

    def _constants(
        self,
        quantities: dict[str, Quantity],
        rest: Rest | None = None,
        history: CoefficientHistory | None = None,
        content: TankHistory | None = None,
    ) -> TankConstants:
        about = {"rest": rest, "C_i_history": history, "tank_history": content}
        said = {"notes": tuple(self.notes), "warnings": tuple(self.warnings)}
        return TankConstants.model_validate({**quantities, **about, **said})

    def _acting(self, tables: Tables, inputs: Inputs) -> tuple[Inputs, VaporPhase | None]:
        """The inputs and the vapor phase with the effects in; what they cannot be in is said."""
        if not self.effects:
            return inputs, None
        try:
            found = acting(self.histories, tables, self.saturation, self.definition, inputs, self.effects)
        except (ArithmeticError, ValueError) as error:
            self.warnings.append(f"C_i and m were found without the adopted effects: {error}")
            return inputs, None
        self.notes.append("C_i and m one by one: with the adopted effects acting on the tank, feed line and injector")
        return found

    def _check_fit(self, inputs: Inputs) -> None:
        """Raise InputError where the loaded mass cannot be in the tank, even as liquid as cold as its blowdown."""
        h = self.histories
        start = h.mean(h.tank, self.t_feed, self.t_feed + 0.2 * (self.t_v - self.t_feed))
        bulk = float(self.saturation.temperature(np.clip(start, *self.saturation.pressure_range)))
        most = inputs.volume * float(self.saturation.liquid_density(bulk))
        if inputs.mass > FULLEST * most:
            raise InputError(
                f"{self.definition.path}: [tank] oxidizer_mass and volume: found {inputs.mass:.2f} kg in "
                f"{inputs.volume * 1e3:.1f} L; expected no more than {most:.2f} kg, the tank full of liquid at the "
                f"{bulk - 273.15:.0f} degC of its blowdown"
            )

    def _quantities(self, r: Reduction, draws: Draws, inputs: Inputs, left: Array) -> dict[str, Quantity]:
        return self._conditional(self._judged(r, draws, inputs, left))

    def _conditional(self, found: dict[str, Quantity]) -> dict[str, Quantity]:
        """What rests on a pressure before the injector that was estimated holds on that condition."""
        if self.lost is None:
            return found
        resting = {n: q for n, q in found.items() if n in BY_RUN_LINE and q.verdict in (IDENTIFIED, NOT_IDENTIFIABLE)}
        told = {
            n: replace(q, verdict=CONDITIONAL, why=self.estimated) for n, q in resting.items() if q.value is not None
        }
        if "m" in found and "m" not in self.held.values:  # how fast the vapor leaves hangs on it
            told["m"] = Quantity.absent(self.estimated, verdict=NOT_IDENTIFIABLE)
        return found | told

    def _judged(self, r: Reduction, draws: Draws, inputs: Inputs, left: Array) -> dict[str, Quantity]:
        held = "C_i" in self.held.values
        discharge = self.held.quantity("C_i") if held else judge_discharge(r, draws, self._excluded_share())
        known = np.isfinite(draws.of_flow) and 0.0 < r.C_i < 10.0
        out = {"C_i": discharge, "m": judge_exponent(r, draws, inputs, self.end_reason, self.saturation)}
        out["Z"] = looked_up(judged("Z", r.Z, "", draws))
        out["K_loss"] = judged("K_loss", r.K_loss, "1/m^4", draws, unphysical_below=0.0)
        out["p_loss_liquid"] = judged("loss_liquid", r.loss_liquid, "Pa", draws, unphysical_below=0.0)
        out["p_loss_vapor"] = (
            judged("loss_vapor", r.loss_vapor, "Pa", draws, unphysical_below=0.0)
            if np.isfinite(r.loss_vapor)
            else Quantity.absent(self.end_reason or "the vapor phase holds no samples", verdict=NOT_IDENTIFIABLE)
        )
        out["vapor_mass_at_t_v"] = looked_up(judged("vapor_mass", r.vapor_mass, "kg", draws))
        flow = self._flow_peak(left) if known else None
        if flow is None:
            out["oxidizer_flow_peak"] = Quantity.absent("no C_i to take it from", verdict=NOT_IDENTIFIABLE)
        else:
            out["oxidizer_flow_peak"] = Quantity(flow, "kg/s", flow * draws.of_flow, verdict=_worth(discharge))
        at_feed = inputs.mass - float(np.interp(self.t_feed, self.histories.time, left))
        out["mass_at_t_feed"] = _mass(at_feed, self._mass_std, discharge)
        spread = float(np.hypot(draws.std("vapor_mass"), self._mass_std))
        out["oxidizer_mass_liquid_phase"] = _mass(inputs.mass - r.vapor_mass, spread, discharge)
        return out

    def _spread(self, mass: LoadedMass) -> InputSpread:
        assert self.volume is not None
        assert self.area is not None
        self._mass_std = mass.std
        return InputSpread(
            mass.std,
            self.volume.std or 0.0,
            self.area.std or 0.0,
            self.segments.std("t_feed"),
            self.segments.std("t_v"),
            self.t_end_std,
            self._reading_factor(),
            (self.at_v.slope, self.at_end.slope if self.at_end else 0.0),
            self._biases(SPAN_SHARE),
            (self.held.std("C_i"), self.held.std("K_loss"), self.held.std("m")),
        )

    def _reading_factor(self) -> Array:
        """Lower factor of the covariance of the pressures read at t_v and at the end of the vapor phase."""
        noise, first = self.histories.noises["p_tank"], self.at_v
        last = self.at_end or first
        common = noise.common(first.weights, first.time, last.weights, last.time) if self.at_end else 0.0
        covariance = np.diag([noise.std_of(r.weights, r.time) ** 2 for r in (first, last)])
        covariance[0, 1] = covariance[1, 0] = min(common, 0.99 * float(np.sqrt(np.prod(np.diag(covariance)))))
        return np.asarray(np.linalg.cholesky(covariance + 1e-9 * np.eye(2)), dtype=np.float64)

    def _biases(self, span: float) -> tuple[float, float, float]:
        """Of p_tank, p_run and p_chamber [Pa], with a ``span`` [-] of their accuracies beside what a zero leaves."""
        return self._bias("p_tank", span), self._bias("p_run", span), self._bias("p_chamber", span)

    def _bias(self, name: str, span: float) -> float:
        channel = self.log.get(name)
        if name == "p_run" and self.lost is not None:
            h = self.histories
            return (self.lost.std or 0.0) * h.mean(h.tank - h.chamber, self.t_feed, self.t_v)
        if channel is None:
            return self.definition.ambient_pressure.std or 0.0
        if channel.zero_std is None:
            return channel.accuracy
        still = self.histories.signals[name].between(-30.0, -0.02).time
        rest = (float(still[0]), -0.02) if still.size > 1 else (-1.0, -0.02)
        since = self.histories.noises[name].difference_std(rest, (0.0, self.t_v))
        return float(np.hypot(left_by_zero(channel.accuracy, channel.zero_std, span), since))

    def _mass_left(self, r: Reduction, inputs: Inputs) -> Array:
        """Mass that has left through the injector at the histories' times [kg]."""
        h = self.histories
        density = self.saturation.liquid_density(h.tank_temperature(self.saturation))
        flow = mass_flows(r.C_i * inputs.area, density, h.run - h.chamber)
        steps = 0.5 * (flow[1:] + flow[:-1]) * np.diff(h.time)
        return np.concatenate(([0.0], np.cumsum(steps)))

    def _flow_peak(self, left: Array) -> float | None:
        """Highest mean flow over PEAK_OVER of the liquid phase, from the opening on [kg/s]."""
        liquid = self.histories.time < self.t_v
        t, x = self.histories.time[liquid], left[liquid]
        if t.size < 2 or t[-1] <= PEAK_OVER:
            return None
        t, x = np.append(0.0, t), np.append(x[0] - (x[1] - x[0]) / (t[1] - t[0]) * t[0], x)
        starts = t[t <= t[-1] - PEAK_OVER]
        return float((np.interp(starts + PEAK_OVER, t, x) - np.interp(starts, t, x)).max()) / PEAK_OVER

    def _read(
        self, instant: float, before: float, after: float, breaks: bool, until: float = np.inf
    ) -> PressureReading:
        """The tank's pressure at an instant [s], from what lies up to ``before`` and ``after`` [s] of it, or as far as
        FEWEST samples, but not ``until`` [s] after it another event bends it."""
        tank = self.histories.signals["p_tank"]
        least = FEWEST * tank.step
        left, right = (min(max(span, least), 0.4 + least) for span in (before, after))
        return read_at(tank, instant, left, min(right, until), breaks)

    def _until_purge(self) -> float:
        t_purge = self.segments.time("t_purge")
        return np.inf if t_purge is None or t_purge <= self.t_v else t_purge - self.t_v

    def _last(self, t_v: float) -> float:
        t_purge = self.segments.time("t_purge")
        return max(t_v, t_purge if t_purge is not None else t_v + 10.0) + 0.5

    def _vapor_end(self) -> tuple[float, float, str | None]:
        """End of the pure vapor phase [s], its standard deviation, and the reason where there is none."""
        t_purge = self.segments.time("t_purge")
        if t_purge is not None and t_purge <= self.t_v:
            return (
                np.nan,
                0.0,
                f"nitrogen is in the tank from {t_purge:.2f} s on, before the liquid is gone ({self.t_v:.2f} s)",
            )
        name, gap = self.histories.gap(self.t_v, t_purge if t_purge is not None else self.t_v + 0.2)
        if gap > max(0.1, 4.0 * self.histories.signals["p_tank"].step):
            return np.nan, 0.0, f"{name} has no good samples for {gap:.2f} s of the vapor phase"
        if t_purge is not None:
            held = self.histories.signals["p_tank"].between(self.t_v, t_purge).time.size
            phase = f"the vapor phase lasts {t_purge - self.t_v:.3f} s and holds {held} samples of p_tank"
            few = f"{phase}: too little to tell m, the pressures at its two ends take {FEWEST}"
            return (t_purge, self.segments.std("t_purge"), None) if held >= FEWEST else (np.nan, 0.0, few)
        h = self.histories
        low = (h.time > self.t_v) & (h.tank < VAPOR_PRESSURE_SHARE * self.at_v.value)
        if not low.any():
            return np.nan, 0.0, "the log ends before the vapor phase has gone far enough"
        self.notes.append(
            "no nitrogen is seen: m is shot to the time at which the tank has lost 40 % of its pressure at t_v"
        )
        return float(h.time[low][0]), 0.0, None

    def _blocked(self) -> str | None:
        """Why the injector equation cannot be inverted at all, or None."""
        name, gap = self.histories.gap(0.0, self.t_v)
        if gap > LONGEST_GAP * self.t_v:
            return f"{name} has no good samples for {gap:.2f} s of the {self.t_v:.2f} s from the opening to t_v"
        share = self._excluded_share()
        if share > 0.1:
            return (
                f"p_run is not above p_chamber over {100.0 * share:.0f} % of the liquid phase: the injector equation "
                "has no flow there; one of the two sensors is off, or p_run is not measured before the injector"
            )
        return None

    def _missing(self, mass: LoadedMass | None) -> str:
        known = {
            "the tank's volume ([tank] volume)": self.volume,
            "the injector's area ([injector] holes and hole_area)": self.area,
            "the loaded mass ([tank] oxidizer_mass)": mass,
        }
        return "test.toml does not state " + " nor ".join(name for name, value in known.items() if value is None)

    def _excluded_share(self) -> float:
        h = self.histories
        liquid = (h.time >= self.t_feed) & (h.time < self.t_v)
        return float((h.run[liquid] <= h.chamber[liquid]).mean()) if liquid.any() else 1.0

    def _losses(self) -> dict[str, Quantity]:
        h = self.histories
        error = float(np.hypot(self._bias("p_tank", SPAN_SHARE), self._bias("p_run", SPAN_SHARE)))
        out = {}
        for name, start, end in (("p_loss_liquid", self.t_feed, self.t_v), ("p_loss_vapor", self.t_v, self.t_end)):
            value = h.mean(h.tank - h.run, start, end) if np.isfinite(end) else np.nan
            lacking, gap = h.gap(start, end) if np.isfinite(value) else ("", 0.0)
            if not np.isfinite(value):
                out[name] = Quantity.absent(self.end_reason or "no samples in this phase", verdict=NOT_IDENTIFIABLE)
            elif gap > LONGEST_GAP * (end - start):
                why = f"{lacking} has no good samples for {gap:.2f} s of the {end - start:.2f} s of this phase"
                out[name] = Quantity.absent(why, verdict=NOT_IDENTIFIABLE)
            else:
                out[name] = Quantity(value, "Pa", error, verdict=IDENTIFIED)
        return self._conditional(out)


def _mass(value: float, std: float, discharge: Quantity) -> Quantity:
    """A mass [kg] that is worth what C_i is worth."""
    if not (np.isfinite(value) and np.isfinite(std)):
        return Quantity.absent("the reduction has no answer", verdict=NOT_IDENTIFIABLE)
    return Quantity(value, "kg", std, verdict=_worth(discharge))


def _worth(discharge: Quantity) -> str | None:
    """The verdict on what follows from C_i."""
    return DERIVED if discharge.verdict == STATED else discharge.verdict
