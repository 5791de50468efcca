"""a and n of a test that has been calibrated; a test that tells nothing says why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import log

import numpy as np

from hfanalysis.calibrate.calibration import TankCalibration
from hfanalysis.calibrate.course import Course
from hfanalysis.calibrate.drifting import drift_std
from hfanalysis.calibrate.evidence import Evidence
from hfanalysis.calibrate.evidence_from_log import evidence_of, whole_covariance
from hfanalysis.calibrate.facts import nothing_to_regress
from hfanalysis.calibrate.law_errors import LawErrors
from hfanalysis.calibrate.narrow_port import reaching_the_head, with_stated_tap
from hfanalysis.calibrate.regression import Fitted, fit
from hfanalysis.calibrate.regression_verdict import result
from hfanalysis.calibrate.stated import apart, held_law, law_of
from hfanalysis.engine.effect import Active
from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import UNIT_OF_A, FuelLaw
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import CONDITIONAL, DOUBTED, IDENTIFIED, Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog


def evidence_for(
    log: TestLog,
    segments: Segments,
    definition: TestDefinition,
    calibration: TankCalibration,
    effects: Sequence[Active] = (),
) -> Evidence:
    """What a test says about a and n. Raises AbsentError where it says nothing, with the reason."""
    if segments.kind != "hot_fire" or segments.misfire:
        raise AbsentError("nothing burns in this test")
    if calibration.draws is None:
        reason = calibration.constants.C_i.reason
        raise AbsentError(f"no oxidizer flow to regress with: C_i is missing ({reason})")
    if reason := nothing_to_regress(log, segments, definition, calibration.constants):
        raise AbsentError(reason)
    return evidence_of(log, segments, definition, calibration.constants, calibration.draws, effects)


def regress(
    log: TestLog,
    segments: Segments,
    definition: TestDefinition,
    calibration: TankCalibration,
    effects: Sequence[Active] = (),
) -> FuelLaw:
    """a, n and the rate at the reference flux of one test, with their verdicts, ``effects`` acting; a and n are held
    where test.toml states them."""
    return held(definition, _fitted(log, segments, definition, calibration, effects))


def _fitted(
    log: TestLog,
    segments: Segments,
    definition: TestDefinition,
    calibration: TankCalibration,
    effects: Sequence[Active],
) -> FuelLaw:
    """As the log has it."""
    try:
        found = fit(evidence_for(log, segments, definition, calibration, with_stated_tap(definition, effects)))
        whole = _with_all_errors(result(found), found, definition, calibration)
        law = reaching_the_head(whole, found, definition)
    except AbsentError as error:
        return FuelLaw.absent(str(error))
    except (ArithmeticError, np.linalg.LinAlgError) as error:
        return FuelLaw.absent(f"the engine's model cannot be fitted with what test.toml states: {error}")
    return _conditional(law, calibration.constants.C_i)


def _with_all_errors(law: FuelLaw, found: Fitted, definition: TestDefinition, calibration: TankCalibration) -> FuelLaw:
    """The law with what systematic errors do to it; as it is where they cannot be carried through the engine."""
    if calibration.whole is None:
        return law
    try:
        errors = LawErrors(found, whole_covariance(calibration.whole, definition, calibration.constants))
        return errors.drifting(errors.told(law), *_drift(found, calibration))
    except (AbsentError, ArithmeticError):
        return law


def _drift(found: Fitted, calibration: TankCalibration) -> tuple[float, float]:
    """What C_i may drift by [-] while the liquid lasts, and how long it does [s]."""
    constants, burnt = calibration.constants, found.evidence.burnt(found.law)
    lasts = float(burnt.liquid_out or burnt.time[-1])
    return drift_std(Course.of(constants.C_i_history), constants.C_i.value or 0.0, lasts), lasts


def _conditional(law: FuelLaw, discharge: Quantity) -> FuelLaw:
    """a and n hold on the condition that C_i holds on, and are doubted where it is."""
    if discharge.verdict not in (CONDITIONAL, DOUBTED):
        return law
    found = {n: q for n, q in law.quantities.items() if q.verdict == IDENTIFIED}
    told = {n: replace(q, verdict=discharge.verdict, why=discharge.why) for n, q in found.items()}
    own = {n: q for n, q in law.quantities.items() if q.verdict == CONDITIONAL}
    return law.but(**told, **{n: _both(q, discharge) for n, q in own.items()})


def _both(own: Quantity, discharge: Quantity) -> Quantity:
    """On its own condition and on that of C_i, whose verdict is the worse one."""
    return replace(own, verdict=discharge.verdict, why=f"{discharge.why}; {own.why}")


def held(definition: TestDefinition, by_log: FuelLaw) -> FuelLaw:
    """The law with what test.toml states of it; of two constants of which one is stated the other follows."""
    stated = law_of(definition)
    if not stated:
        return by_log
    told = {name: held_law(name, value, getattr(by_log, name)) for name, value in stated.items()}
    rest = {name: _other(name, told, by_log) for name in ("a", "n") if name not in told}
    return by_log.but(**told, **rest)


def _other(name: str, told: Mapping[str, Quantity], by_log: FuelLaw) -> Quantity:
    """a or n by the other one as stated: the rate at the reference flux does not depend on which it is."""
    rate, flux = by_log.regression_rate_reference, by_log.regression.reference_flux
    if rate.value is None or not rate.interval or flux is None or flux.value is None or rate.interval[0] <= 0.0:
        return getattr(by_log, name)  # type: ignore[no-any-return]
    known, relative = next(iter(told.values())), (rate.std or 0.0) / rate.value
    assert known.value is not None
    scale = log(flux.value)
    if name == "a":
        value = rate.value / flux.value**known.value
        std = value * float(np.hypot(relative, scale * (known.std or 0.0)))
        return Quantity(value, UNIT_OF_A, std, verdict=CONDITIONAL, why="with n held as stated")
    value = log(rate.value / known.value) / scale
    std = float(np.hypot(relative, (known.std or 0.0) / known.value)) / scale
    return Quantity(value, "", std, verdict=CONDITIONAL, why="with a held as stated")


def contradiction(definition: TestDefinition, found: FuelLaw) -> str | None:
    """That the stated a and n have another rate than the log, by more than both may be off; None where they do not.

    Compared where the log tells the rate best: there a wrong n does not hide behind a wrong a.
    """
    stated = law_of(definition)
    rate, flux = found.regression_rate_reference, found.regression.reference_flux
    if set(stated) != {"a", "n"} or rate.value is None or flux is None or flux.value is None:
        return None
    a, n = stated["a"], stated["n"]
    value = a.value * flux.value**n.value
    relative = float(np.hypot((a.std or 0.0) / a.value, log(flux.value) * (n.std or 0.0)))
    by_law = Quantity(value, "m/s", value * relative)
    if not apart(by_law, rate):
        return None
    return (
        f"[grain] a and n state a rate of {value * 1e3:.3f} mm/s at {flux.value:.0f} kg/(m^2 s), but the log says "
        f"{rate.value * 1e3:.3f} +/- {(rate.std or 0.0) * 1e3:.3f} mm/s"
    )
