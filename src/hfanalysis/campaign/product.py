"""What a campaign found: every test by itself, and what the tests of one stand say together."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TypeVar

from hfanalysis.campaign.common_law import common_law
from hfanalysis.campaign.family import left_the_family, natural_limits, odd_one
from hfanalysis.campaign.pooling import pooled
from hfanalysis.campaign.regression import law_in
from hfanalysis.campaign.sensors import readings_of, sensors_of
from hfanalysis.campaign.side_by_side import Ended
from hfanalysis.campaign.special import special
from hfanalysis.campaign.trends import CONSTANTS, trends
from hfanalysis.errors import AbsentError
from hfanalysis.interface.ending import ABSENT, DONE, INPUT_AT_FAULT
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.campaign import (
    Agreement,
    CommonLaw,
    Diagnosed,
    EffectRow,
    NoLaw,
    ParameterRow,
    StandRow,
    TestRow,
    Together,
)
from hfanalysis.products.diagnosis import Diagnosis, NamedEffect
from hfanalysis.products.disk import read_json
from hfanalysis.products.flight import Flight
from hfanalysis.products.ingest import Ingest
from hfanalysis.products.model import Product
from hfanalysis.products.validation import Validation
from hfanalysis.quantity import IDENTIFIED, Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.simulation.scatter import PRIOR_SCATTER

P = TypeVar("P", bound=Product)

CALIBRATED = (*CONSTANTS, "a", "n")
MEASURED = ("burn_time", "total_impulse", "specific_impulse", "peak_chamber_pressure", "peak_thrust")

STATUS = {DONE: "done", INPUT_AT_FAULT: "input at fault", ABSENT: "not in the log"}


def row_of(definition: TestDefinition | None, folder: Path, ended: Ended) -> TestRow:
    """A test in short; ``folder`` is where its products are, some of which there may not be.

    Where its run ended by a fault, theirs or ours, what still lies there is of an earlier one and counts for nothing.
    """
    counts = definition is not None and ended.status in (DONE, ABSENT)
    about = definition.test if definition is not None and counts else None
    where = folder if counts else None
    calibration, validation, ingest = _read(Calibration, where), _read(Validation, where), _read(Ingest, where)
    flight, diagnosis = _read(Flight, where), _read(Diagnosis, where)
    constants = calibration.quantities if calibration else {}
    measured = validation.performance.measured.quantities if validation else {}
    return TestRow(
        stand=stand_of(definition) if definition is not None and counts else None,
        injector_area=_injector(definition) if definition is not None and counts else None,
        kind=about.kind if about else None,
        source=about.source if about else None,
        date=str(about.date) if about and about.date else None,
        status=STATUS.get(ended.status, "defect"),
        reason=ended.said or None,
        calibration={name: constants[name] for name in CALIBRATED if name in constants},
        systematic={name: one.systematic for name, one in calibration.budget.items()} if calibration else {},
        performance={name: measured[name] for name in MEASURED if name in measured},
        apogee=flight.apogee if flight else None,
        diagnosis=_diagnosed(diagnosis) if diagnosis else None,
        page=f"{folder.name}/report.html" if counts and (folder / "report.html").exists() else None,
        sensors=readings_of(definition, ingest, calibration) if definition is not None else {},
        conditions=_conditions(calibration) if calibration is not None else {},
    )


def _conditions(calibration: Calibration) -> dict[str, Quantity]:
    """What a constant of the injector may go with."""
    inlet, rest = calibration.inlet, calibration.rest
    found = {
        "subcooling": inlet.subcooling if inlet else None,
        "back_pressure": inlet.back_pressure if inlet else None,
        "tank_temperature": rest.temperature if rest else None,
    }
    return {name: quantity for name, quantity in found.items() if quantity is not None and quantity.value is not None}


def stand_of(definition: TestDefinition) -> str | None:
    """The stand as it is stated; where it is not, its tank, by which tests of one stand are known.

    Replicas and simulated tests are a stand of their own: nothing is pooled of what was measured and what was not.
    """
    source = definition.test.source
    apart = "" if source == "measured" else f" ({source})"
    if definition.test.stand:
        return f"{definition.test.stand}{apart}"
    volume = definition.tank.volume if definition.tank else None
    return None if volume is None else f"not stated: the tank of {1e3 * volume.value:.4g} L{apart}"


def _injector(definition: TestDefinition) -> float | None:
    area = definition.injector.area if definition.injector else None
    return None if area is None else area.value


def _read(kind: type[P], folder: Path | None) -> P | None:
    if folder is None or not (folder / kind.file).exists():
        return None
    return kind.from_json(read_json(folder / kind.file))


def _diagnosed(product: Diagnosis) -> Diagnosed:
    kept = ("verdict", "effects", "posterior", "partners")
    return Diagnosed(**{name: getattr(product, name) for name in kept})


def stand_row(rows: Mapping[str, TestRow], folder: Path) -> StandRow:
    """What the tests of one stand, by name, say together; below ``folder`` are their products."""
    law = _regression(rows, folder)
    if isinstance(law, CommonLaw) and law.odd is not None:
        law = law.but(odd=law.odd.but(special=tuple(special(law.odd.test, rows))))
    return StandRow(
        tests=tuple(rows),
        constants={name: _constant(rows, name) for name in CONSTANTS},
        effects=_effects(rows),
        regression=law,
        sensors=sensors_of(rows),
        trends=trends(rows, {name: _calibrated(rows, name) for name in CONSTANTS}),
    )


def _constant(rows: Mapping[str, TestRow], name: str) -> Together:
    if name == "C_i" and len({row.injector_area for row in rows.values()}) > 1:
        return Together(mean=Quantity.absent("the tests have different injectors"))
    found = _calibrated(rows, name)
    shared = min((rows[test].systematic.get(name, 0.0) for test in found), default=0.0)
    together = _together(found, "identified", shared)
    odd = odd_one(found, PRIOR_SCATTER.get(name))
    in_order = sorted(found, key=lambda test: (rows[test].date or "", test))
    values = [found[test].value or 0.0 for test in in_order]
    return together.but(
        odd=None if odd is None else odd.but(special=tuple(special(odd.test, rows))),
        left=tuple(in_order[i] for i in left_the_family(values)),
        limits=natural_limits(values),
    )


def _calibrated(rows: Mapping[str, TestRow], name: str) -> dict[str, Quantity]:
    """The numbers of tests that identify it: what is unphysical or free is no property of the stand."""
    found = {test: row.calibration[name] for test, row in rows.items() if name in row.calibration}
    return {test: quantity for test, quantity in found.items() if quantity.verdict == IDENTIFIED}


def _together(found: Mapping[str, Quantity], what: str, shared: float = 0.0) -> Together:
    """The mean of the tests in which a number is ``what``, or the reason why there is none; ``shared``: as
    :func:`hfanalysis.campaign.pooling.pooled`."""
    mean = pooled(found, shared)
    if mean is None:
        known = [test for test, q in found.items() if q.std]
        where = f"{known[0]} only" if known else "no test"
        return Together(mean=Quantity.absent(f"{what} in {where}; two are needed"))
    verdict = "agree" if mean.agree else "disagree: they differ by more than their deviations allow"
    return Together(
        mean=mean.mean,
        between=mean.between,
        agreement=Agreement(verdict=verdict, probability=mean.probability),
        tests=mean.tests,
    )


def _effects(rows: Mapping[str, TestRow]) -> dict[str, EffectRow]:
    """Every effect that some test names: how probable it is in each, and its numbers where it is named."""
    diagnosed = {test: row.diagnosis for test, row in rows.items() if row.diagnosis}
    named = {test: {e.name: e for e in found.effects} for test, found in diagnosed.items()}
    return {
        name: EffectRow(
            named_in=tuple(test for test in named if name in named[test]),
            probability={test: probability_of(diagnosed[test], named[test].get(name), name) for test in diagnosed},
            parameters=_parameters({test: found[name].parameters for test, found in named.items() if name in found}),
        )
        for name in dict.fromkeys(name for found in named.values() for name in found)
    }


def probability_of(diagnosis: Diagnosed, named: NamedEffect | None, name: str) -> float | None:
    """Of being there [-, 0 to 1]: as stated where it is named, or else as the first effect or beside it, whichever is
    more.

    None where it was not tried.
    """
    if named:
        return named.probability
    tried = [found[name] for found in (diagnosis.posterior, diagnosis.partners) if name in found]
    return max(tried, default=None)


def _parameters(found: Mapping[str, Mapping[str, Quantity]]) -> dict[str, ParameterRow]:
    """Each parameter by test, and their mean where there are several."""
    names = dict.fromkeys(name for parameters in found.values() for name in parameters)
    rows = [{test: own[name] for test, own in found.items() if name in own} for name in names]
    together = (ParameterRow(by_test=row, together=_together(row, "known")) for row in rows)
    return dict(zip(names, together, strict=True))


def _regression(rows: Mapping[str, TestRow], folder: Path) -> CommonLaw | NoLaw:
    """a and n of one law for all tests that say something of them; else the reason."""
    able = [test for test, row in rows.items() if "a" in row.calibration and row.calibration["a"].value is not None]
    if len(able) < 2:
        return NoLaw(reason=f"two tests are needed, and a and n are known of {len(able) or 'none'}")
    found = {test: _read(Calibration, folder / test) for test in able}
    try:
        return common_law({test: law_in(calibration) for test, calibration in found.items() if calibration})
    except AbsentError as error:
        return NoLaw(reason=str(error))
