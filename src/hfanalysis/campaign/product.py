"""What a campaign found: every test by itself, and what the tests of one stand say together."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hfanalysis.campaign.pooling import pooled
from hfanalysis.campaign.regression import regression_of
from hfanalysis.campaign.side_by_side import ABSENT, DONE, INPUT_AT_FAULT, Ended
from hfanalysis.errors import AbsentError
from hfanalysis.progress import Progress
from hfanalysis.quantity import IDENTIFIED, Quantity
from hfanalysis.record.definition import TestDefinition

HARDWARE = ("C_i", "K_loss", "m")
"""Calibrated numbers that belong to the stand and not to the load of a test."""

CALIBRATED = (*HARDWARE, "a", "n")
MEASURED = ("burn_time", "total_impulse", "specific_impulse", "peak_chamber_pressure", "peak_thrust")

_NOTHING = ("stand", "injector_area", "kind", "source", "date", "apogee", "diagnosis", "page")
_EMPTY: dict[str, Any] = {"calibration": {}, "performance": {}}

STATUS = {DONE: "done", INPUT_AT_FAULT: "input at fault", ABSENT: "not in the log"}


def row_of(definition: TestDefinition | None, folder: Path, ended: Ended) -> dict[str, Any]:
    """A test in short; ``folder`` is where its products are, some of which there may not be.

    Where its run ended by a fault, theirs or ours, what still lies there is of an earlier one and counts for nothing.
    """
    status = {"status": STATUS.get(ended.status, "defect"), "reason": ended.said or None}
    if definition is None or ended.status not in (DONE, ABSENT):
        return {**dict.fromkeys(_NOTHING), **status, **_EMPTY}
    calibration, validation = _read(folder / "calibration.json"), _read(folder / "validation.json")
    performance = (validation.get("performance") or {}).get("measured") or {}
    about = definition.test
    return {
        "stand": stand_of(definition),
        "injector_area": _injector(definition),
        "kind": about.kind,
        "source": about.source,
        "date": str(about.date) if about.date else None,
        **status,
        "calibration": {name: calibration[name] for name in CALIBRATED if name in calibration},
        "performance": {name: performance[name] for name in MEASURED if name in performance},
        "apogee": _read(folder / "flight.json").get("apogee"),
        "diagnosis": _diagnosed(_read(folder / "diagnosis.json")),
        "page": f"{folder.name}/report.html" if (folder / "report.html").exists() else None,
    }


def stand_of(definition: TestDefinition) -> str | None:
    """The stand as it is stated; where it is not, its tank, by which tests of one stand are known."""
    if definition.test.stand:
        return definition.test.stand
    volume = definition.tank.volume if definition.tank else None
    return None if volume is None else f"not stated: the tank of {1e3 * volume.value:.4g} L"


def _injector(definition: TestDefinition) -> float | None:
    area = definition.injector.area if definition.injector else None
    return None if area is None else area.value


def _read(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    return found


def _diagnosed(product: Mapping[str, Any]) -> dict[str, Any] | None:
    kept = ("verdict", "effects", "posterior", "partners")
    return {name: product[name] for name in kept if name in product} if product else None


def stand_row(
    rows: Mapping[str, Mapping[str, Any]], root: Path, out: Path | None, progress: Progress
) -> dict[str, Any]:
    """What the tests of one stand, by name, say together."""
    return {
        "tests": list(rows),
        "constants": {name: _constant(rows, name) for name in HARDWARE},
        "effects": _effects(rows),
        "regression": _regression(rows, root, out, progress),
    }


def _constant(rows: Mapping[str, Mapping[str, Any]], name: str) -> dict[str, Any]:
    if name == "C_i" and len({row["injector_area"] for row in rows.values()}) > 1:
        return Quantity.absent("the tests have different injectors").to_json()
    return _together(_calibrated(rows, name), "identified")


def _calibrated(rows: Mapping[str, Mapping[str, Any]], name: str) -> dict[str, Quantity]:
    """The numbers of tests that identify it: what is unphysical or free is no property of the stand."""
    found = {test: row["calibration"].get(name) or {} for test, row in rows.items()}
    return {test: Quantity.from_json(q) for test, q in found.items() if q.get("verdict") == IDENTIFIED}


def _together(found: Mapping[str, Quantity], what: str) -> dict[str, Any]:
    """The mean of the tests in which a number is ``what``, or the reason why there is none."""
    mean = pooled(found)
    if mean is None:
        known = [test for test, q in found.items() if q.std]
        return Quantity.absent(f"{what} in {f'{known[0]} only' if known else 'no test'}; two are needed").to_json()
    verdict = "agree" if mean.agree else "disagree: they differ by more than their deviations allow"
    return {
        **mean.mean.to_json(),
        "between": mean.between,
        "agreement": {"verdict": verdict, "probability": mean.probability},
        "tests": list(mean.tests),
    }


def _effects(rows: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Every effect that some test names: how probable it is in each, and its numbers where it is named."""
    diagnosed = {test: row["diagnosis"] for test, row in rows.items() if row["diagnosis"]}
    named = {test: {e["name"]: e for e in found["effects"]} for test, found in diagnosed.items()}
    return {
        name: {
            "named_in": [test for test in named if name in named[test]],
            "probability": {test: _probability(diagnosed[test], named[test].get(name), name) for test in diagnosed},
            "parameters": _parameters(
                {test: found[name]["parameters"] for test, found in named.items() if name in found}
            ),
        }
        for name in dict.fromkeys(name for found in named.values() for name in found)
    }


def _probability(diagnosis: Mapping[str, Any], named: Mapping[str, Any] | None, name: str) -> float | None:
    """Of being there: as stated where it is named, or else as the first effect or beside it, whichever is more.

    None where it was not tried.
    """
    if named:
        return float(named["probability"])
    tried = [found[name] for found in (diagnosis["posterior"], diagnosis.get("partners") or {}) if name in found]
    return max(tried, default=None)


def _parameters(found: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Each parameter by test, and their mean where there are several."""
    names = dict.fromkeys(name for parameters in found.values() for name in parameters)
    return {
        name: {
            "by_test": {test: parameters[name] for test, parameters in found.items() if name in parameters},
            "together": _together(
                {test: Quantity.from_json(p[name]) for test, p in found.items() if name in p}, "known"
            ),
        }
        for name in names
    }


def _regression(
    rows: Mapping[str, Mapping[str, Any]], root: Path, out: Path | None, progress: Progress
) -> dict[str, Any]:
    """a and n of one law for all tests that say something of them; else the reason."""
    able = [test for test, row in rows.items() if (row["calibration"].get("a") or {}).get("value") is not None]
    if len(able) < 2:
        return {"reason": f"two tests are needed, and a and n are known of {len(able) or 'none'}"}
    try:
        return regression_of(able, root, out, progress)
    except AbsentError as error:
        return {"reason": str(error)}
