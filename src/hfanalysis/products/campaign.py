"""The content of campaign.json: several tests side by side, and what those of one stand say together."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import GetJsonSchemaHandler, SerializerFunctionWrapHandler, model_serializer, model_validator
from pydantic_core import CoreSchema

from hfanalysis.products.calibration import FuelLaw
from hfanalysis.products.diagnosis import NamedEffect, Sizes
from hfanalysis.products.model import Is, Part
from hfanalysis.quantity import Quantity


class Diagnosed(Part):
    """What the diagnosis of a test says, in short."""

    verdict: Annotated[str, Is("none, named, ambiguous or unknown")]
    effects: Annotated[tuple[NamedEffect, ...], Is("what was added to the model")]
    posterior: Annotated[Sizes, Is("probability of every name as the first of what is missing", "")]
    partners: Annotated[Sizes, Is("probability of each further effect if the first is there", "")]


class Reading(Part):
    """What a test says of a sensor."""

    sensor: Annotated[str | None, Is("its serial number, as stated")]
    zero: Annotated[Quantity | None, Is("what was taken off as its zero", "of the channel")] = None
    gain: Annotated[Quantity | None, Is("of the tank's cell: load that it showed over the one stated", "")] = None


class Course(Part):
    """A number from test to test, in the order of their dates."""

    by_test: Annotated[dict[str, Quantity], Is("the number", "of the number")]
    drifts: Annotated[float | None, Is("probability of so steady a change by chance, of five at least", "")]
    left: Annotated[tuple[str, ...], Is("tests beyond the natural limits of all in order, of eight at least")]


class SensorRow(Part):
    """A sensor in the tests of a stand."""

    channel: Annotated[str, Is("that it is of, in the last of them")]
    zero: Annotated[Course | None, Is("what was taken off as its zero")] = None
    gain: Annotated[Course | None, Is("of the tank's cell: load that it showed over the one stated")] = None


class Trend(Part):
    """Whether a constant goes with a condition of the tests."""

    of: Annotated[str, Is("the constant")]
    over: Annotated[str, Is("the condition: subcooling, back_pressure, tank_temperature")]
    tests: Annotated[tuple[str, ...], Is("in which both are known, of one injector where the constant is C_i")]
    slope: Annotated[Quantity, Is("median of the slopes between two tests", "of both")]
    probability: Annotated[float, Is("of so steady a trend by chance, as many as were looked for", "")]


class TestRow(Part):
    """A test in short."""

    stand: Annotated[str | None, Is("as [test] states it, or else known by the volume of its tank")]
    injector_area: Annotated[float | None, Is("as stated", "m^2")]
    kind: Annotated[str | None, Is("as stated")]
    source: Annotated[str | None, Is("measured, or generated")]
    date: Annotated[str | None, Is("as stated")]
    status: Annotated[str, Is("done, input at fault, not in the log, or defect")]
    reason: Annotated[str | None, Is("what was said where it is not done")]
    calibration: Annotated[dict[str, Quantity], Is("constants: C_i, K_loss, m, a, n")]
    systematic: Annotated[
        Mapping[str, float], Is("their deviations by what would be the same in a repeated test", "of the constant")
    ] = {}
    performance: Annotated[dict[str, Quantity], Is("what was measured, as far as it is known")]
    apogee: Annotated[Quantity | None, Is("predicted, above ground", "m")]
    diagnosis: Annotated[Diagnosed | None, Is("in short")]
    page: Annotated[str | None, Is("where its page is")]
    sensors: Annotated[Mapping[str, Reading], Is("by channel, where the test says something of its sensor")] = {}
    conditions: Annotated[
        Mapping[str, Quantity], Is("in the liquid phase: subcooling, back_pressure, tank_temperature")
    ] = {}


class Agreement(Part):
    """Whether tests agree on a number."""

    verdict: Annotated[str, Is("agree or disagree")]
    probability: Annotated[float, Is("of so large a scatter by chance", "")]


class Odd(Part):
    """The test whose number does not fit that of the rest."""

    test: Annotated[str, Is("its name")]
    apart: Annotated[Quantity, Is("its number less that of the rest", "of the number")]
    of: Annotated[Quantity, Is("the number of the rest", "of the number")]
    probability: Annotated[float, Is("that one of them is so far by chance", "")]
    special: Annotated[tuple[str, ...], Is("what else sets it apart, in words")] = ()


class Together(Part):
    """A number as several tests have it together, or the reason why there is none."""

    mean: Annotated[Quantity, Is("with random effects")]
    between: Annotated[float | None, Is("how far the tests differ beyond what each states", "of the mean")] = None
    agreement: Annotated[Agreement | None, Is("of the tests")] = None
    tests: Annotated[tuple[str, ...], Is("in it: those that identify the number")] = ()
    odd: Annotated[Odd | None, Is("the one that does not fit the rest, of four at least")] = None
    left: Annotated[tuple[str, ...], Is("those beyond the natural limits of all in order, of eight at least")] = ()
    limits: Annotated[tuple[float, float] | None, Is("natural limits of all in order", "of the mean")] = None

    @model_validator(mode="before")
    @classmethod
    def _from_flat(cls, given: Any) -> Any:
        """The inverse of how it is written."""
        if not isinstance(given, Mapping) or "mean" in given:
            return given
        own = {name: part for name, part in given.items() if name in cls.model_fields}
        return own | {"mean": {name: part for name, part in given.items() if name not in own}}

    @model_serializer(mode="wrap")
    def _flat(self, as_usual: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """The quantity's entries, and the others beside them."""
        rest: dict[str, Any] = as_usual(self)
        mean: dict[str, Any] = rest.pop("mean")
        return mean | rest

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        found = handler.resolve_ref_schema(handler(schema))
        mean = found["properties"].pop("mean")
        return {**{name: found[name] for name in ("title", "description", "type", "properties")}, "allOf": [mean]}


class ParameterRow(Part):
    """A parameter of an effect."""

    by_test: Annotated[dict[str, Quantity], Is("where it is named")]
    together: Annotated[Together, Is("their mean")]


class EffectRow(Part):
    """An effect that some test of the stand names."""

    named_in: Annotated[tuple[str, ...], Is("the tests that name it")]
    probability: Annotated[dict[str, float | None], Is("by test, first or beside it; null where not tried", "")]
    parameters: Annotated[dict[str, ParameterRow], Is("by name")]


class OfTests(Part):
    """What is of several tests."""

    tests: Annotated[tuple[str, ...], Is("by name")]


class CommonLaw(FuelLaw, OfTests):
    """One regression law of several tests."""

    agreement: Annotated[Agreement, Is("of the tests")]
    odd: Annotated[Odd | None, Is("the one whose rate at one flux does not fit the rest's")] = None
    flux: Annotated[float | None, Is("oxidizer flux at which rates are compared", "kg/m^2/s")] = None
    alone: Annotated[dict[str, FuelLaw], Is("the law of each test")]


class NoLaw(Part):
    """Why there is no common regression law."""

    reason: Annotated[str, Is("why")]


class StandRow(Part):
    """What the tests of one stand say together."""

    tests: Annotated[tuple[str, ...], Is("of this stand")]
    constants: Annotated[dict[str, Together], Is("C_i, K_loss and m together")]
    effects: Annotated[dict[str, EffectRow], Is("that some test names")]
    regression: Annotated[CommonLaw | NoLaw, Is("the law of all its tests, or the reason why there is none")]
    sensors: Annotated[Mapping[str, SensorRow], Is("by serial number, or by channel where none is stated")] = {}
    trends: Annotated[tuple[Trend, ...], Is("of constants with conditions, as far as they were looked for")] = ()


class Predicted(Part):
    """How good a prediction was that was frozen before its test."""

    test: Annotated[str, Is("that it is of")]
    held: Annotated[int | None, Is("bands that hold", "")] = None
    of: Annotated[int | None, Is("bands that can be compared", "")] = None
    mean_error: Annotated[
        Mapping[str, float | None], Is("mean size of the relative errors: predicted, as_last_time, without_effects", "")
    ] = {}
    reason: Annotated[str | None, Is("why it cannot be told")] = None


class Campaign(Part):
    """Several tests, and their stands."""

    file: ClassVar[str] = "campaign.json"

    tests: Annotated[dict[str, TestRow], Is("by name")]
    stands: Annotated[dict[str, StandRow], Is("by name")]
    predictions: Annotated[Mapping[str, Predicted], Is("of these tests, by the prediction's name")] = {}
