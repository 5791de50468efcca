"""The content of predictions/NEXT.json, and of what is said of it once the test has been fired."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from hfanalysis.products.model import Is, Notes, Part
from hfanalysis.quantity import Quantity

IN_UNIT = "as unit says"


class Foretold(Part):
    """What is predicted of one quantity."""

    value: Annotated[float | None, Is("median of the draws", IN_UNIT)]
    low: Annotated[float | None, Is("below it are 5 % of the draws", IN_UNIT)]
    high: Annotated[float | None, Is("above it are 5 % of the draws", IN_UNIT)]
    unit: Annotated[str, Is("SI")]
    reason: Annotated[str | None, Is("why there is none")] = None


class Scatter(Part):
    """How far tests of one stand differ in a constant."""

    std: Annotated[float, Is("relative standard deviation from test to test", "")]
    drawn: Annotated[float, Is("the same about the mean of the tests that the constants are from", "")]
    freedom: Annotated[int | None, Is("degrees of freedom of Student's t; null in older ones: normal", "")]
    source: Annotated[str, Is("where it is from")]


class Origin(Part):
    """A test that a prediction was made from."""

    raw: Annotated[dict[str, str], Is("its raw files by SHA-256")]
    test_toml: Annotated[str, Is("its definition by SHA-256")]
    products: Annotated[dict[str, str], Is("what was read of it, by SHA-256")]
    effects: Annotated[tuple[str, ...], Is("adopted, that act")]


class Prediction(Part):
    """Bands of what a planned test will measure, frozen."""

    file: ClassVar[str] = "prediction.json"

    name: Annotated[str, Is("of the planned test")]
    tests: Annotated[tuple[str, ...], Is("that it was made from; the last one is last time")]
    temperature: Annotated[Quantity, Is("of the planned tank", "K")]
    oxidizer_mass: Annotated[Quantity, Is("planned load", "kg")]
    injector_area: Annotated[Quantity, Is("of the planned holes", "m^2")]
    band: Annotated[float, Is("share of the draws within low and high", "")]
    predicted: Annotated[dict[str, Foretold], Is("by quantity")]
    over_temperature: Annotated[
        Mapping[str, dict[str, Foretold]],
        Is("the same, of fewer draws, with the tank at another temperature; by that temperature", "degC"),
    ] = {}
    rivals: Annotated[dict[str, dict[str, Quantity]], Is("what others say: as_last_time, without_effects")]
    scatter: Annotated[dict[str, Scatter], Is("between tests of a stand, by constant")]
    misses: Annotated[dict[str, float], Is("mean of ln(measured over model) in the tests, by which it is moved", "")]
    draws: Annotated[int, Is("engines drawn", "")]
    refused: Annotated[int, Is("of them, that cannot be run", "")]
    seed: Annotated[int, Is("of the draws", "")]
    notes: Notes
    plan: Annotated[str, Is("NEXT.toml by SHA-256")]
    made_from: Annotated[dict[str, Origin], Is("the tests, by name")]
    hfanalysis: Annotated[str, Is("version")]


class Scored(Part):
    """One quantity of a prediction beside what was measured."""

    measured: Annotated[Quantity, Is("by the log")]
    foretold: Annotated[Foretold, Is("as it was frozen")]
    holds: Annotated[bool | None, Is("whether the measured value is in the band; null: one of them is lacking")]
    error: Annotated[float | None, Is("predicted over measured, less 1", "")]
    rivals: Annotated[dict[str, float | None], Is("the same of the rivals", "")]


class Score(Part):
    """A prediction laid over its test."""

    file: ClassVar[str] = "score.json"

    name: Annotated[str, Is("of the prediction")]
    test: Annotated[str, Is("that was fired")]
    prediction: Annotated[str, Is("its file by SHA-256, as it was printed when it was frozen")]
    raw: Annotated[dict[str, str], Is("files of the test by SHA-256, none of which the prediction knew")]
    scored: Annotated[dict[str, Scored], Is("by quantity")]
    held: Annotated[int, Is("bands that hold", "")]
    of: Annotated[int, Is("bands that could be compared", "")]
    mean_error: Annotated[dict[str, float | None], Is("mean of the errors' sizes over what all can be compared in", "")]
    notes: Notes
    provenance: Annotated[dict[str, Any], Is("products that were read, by SHA-256")]
