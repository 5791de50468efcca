"""a and n where the chamber's gauge may sit at the head of a port that is hardly wider than the throat.

With the gauge at the head, as stated, the model reads the head, too. Where nobody says where it sits, a and n are those
of a gauge that reads the nozzle's pressure, and their intervals reach to those of one at the head: by the model's
slopes, to first order.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import exp, log

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.calibrate.regression import Fitted, law_at, slopes
from hfanalysis.calibrate.regression_verdict import WIDEST_N
from hfanalysis.effects.head_end_pressure import EFFECT
from hfanalysis.engine.effect import Active
from hfanalysis.engine.unsteady import Engine
from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import FuelLaw
from hfanalysis.quantity import CONDITIONAL, IDENTIFIED, NORMAL_95, Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.schema import changed

RECOVERIES = (0.0, 1.0)
"""How the flow widens behind the grain, between its limits [-]."""

SEEN = 1e-3
"""Relative change of a constant [-] that is worth a word. Source: a tenth of what they are known to at best."""


def with_stated_tap(definition: TestDefinition, effects: Sequence[Active]) -> tuple[Active, ...]:
    """The ``effects``, and that of the head where test.toml says that the gauge sits there."""
    channel = definition.channels.get("p_chamber")
    there = any(active.effect.name == EFFECT.name for active in effects)
    if channel is None or channel.tap != "head" or there:
        return tuple(effects)
    return *effects, EFFECT.at(weight=1.0)


def as_read(definition: TestDefinition) -> TestDefinition:
    """test.toml without the place of the chamber's gauge: its reading is taken as it is; the same where none is stated.

    So the base model is calibrated that a diagnosis starts from: it knows no pressure along the port.
    """
    channel = definition.channels.get("p_chamber")
    if channel is None or channel.tap is None:
        return definition
    return changed(definition, channels={**definition.channels, channel.name: changed(channel, tap=None)})


def reaching_the_head(law: FuelLaw, found: Fitted, definition: TestDefinition) -> FuelLaw:
    """The law with intervals that hold what a and n are by a gauge at the head; as it is with one behind the grain."""
    channel = definition.channels.get("p_chamber")
    if channel is None or channel.tap == "aft" or law.a.value is None:
        return law
    try:
        moved = [law_at(found.best + step, found.flux) for r in RECOVERIES if (step := _step(found, r)) is not None]
    except (AbsentError, np.linalg.LinAlgError):  # about the best the model does not run: nothing is known of a side
        return law
    flux = found.reference_flux
    reach = {
        "a": [other.a for other in moved],
        "n": [other.n for other in moved],
        "regression_rate_reference": [exp(log(other.a) + other.n * log(flux)) for other in moved],
    }
    side = "how the flow widens behind the grain" if channel.tap == "head" else "a gauge at the head of the port"
    apart = max((abs(other.n - found.law.n) for other in moved), default=0.0) > NORMAL_95 * WIDEST_N
    hangs = {"a", "n"} if apart else set()
    return law.but(**{name: _wider(getattr(law, name), values, side, name in hangs) for name, values in reach.items()})


def _wider(quantity: Quantity, values: Sequence[float], side: str, hangs: bool) -> Quantity:
    """With the reach; where it is so wide that a and n ``hang`` on where the gauge sits, on that condition."""
    value = quantity.value
    if value is None or not values:
        return quantity
    if hangs and quantity.verdict == IDENTIFIED:
        quantity = replace(quantity, verdict=CONDITIONAL)
    wider = quantity.reaching(*values)
    far = _farthest(values, value)
    if abs(far - value) < SEEN * abs(value):
        return wider
    said = f"the interval has {far:.3g} by {side}"
    return replace(wider, why=f"{quantity.why}; {said}" if quantity.why else said)


def _farthest(values: Sequence[float], value: float) -> float:
    return max(values, key=lambda other: abs(other - value))


def _step(found: Fitted, recovery: float) -> Array | None:
    """By how much (ln r, n) move if the gauge reads the head, the flow widening with this ``recovery`` [-]."""
    law, evidence = found.law, found.evidence
    at_head = replace(evidence, engine=_reading_head(evidence.engine, recovery)).predict(law)
    plain = evidence.predict(law)
    if at_head is None or plain is None:
        return None
    along = slopes(evidence, found.flux, found.best)
    weighted = along.T @ found.weights.precision
    return np.asarray(np.linalg.solve(weighted @ along, weighted @ (plain - at_head)))


def _reading_head(engine: Engine, recovery: float) -> Engine:
    others = tuple(active for active in engine.effects if active.effect.name != EFFECT.name)
    return replace(engine, effects=(*others, EFFECT.at(weight=1.0, recovery=recovery)))
