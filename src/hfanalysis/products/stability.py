"""What validation.json says of how smoothly a test burnt."""

from __future__ import annotations

from typing import Annotated

from hfanalysis.products.model import Is, Part, Words
from hfanalysis.quantity import Quantity


class Roughness(Part):
    """The fluctuation of a channel in a phase, without the sensor's own noise."""

    rms: Annotated[Quantity, Is("root mean square, as share of the mean", "")]
    peak_to_peak: Annotated[Quantity, Is("range of 99 % of the samples in windows of 1 s, as share of the mean", "")]


class Line(Part):
    """An oscillation at a frequency."""

    frequency: Annotated[Quantity, Is("its 95 % interval has what it moves over", "Hz")]
    width: Annotated[float, Is("standard deviation of what its frequency moves by", "Hz")]
    amplitude: Annotated[Quantity, Is("rms, as share of the mean of the first of its channels", "")]
    channels: Annotated[tuple[str, ...], Is("that show it")]
    phase: Annotated[str, Is("of the burn: liquid, vapor")]
    start: Annotated[float, Is("first seen, after the opening", "s")]
    end: Annotated[float, Is("last seen, after the opening", "s")]
    course: Annotated[str, Is("grows, fades (by a factor of two and more), or is steady")]
    cause: Annotated[Words, Is("what it is, or what it can be where that cannot be told")]


class Stability(Part):
    """How smoothly it burnt."""

    verdict: Annotated[str, Is("smooth, rough, unstable, or unseen")]
    why: Annotated[Words, Is("for it")]
    roughness_rms: Annotated[Quantity | None, Is("of p_chamber in the liquid phase, as share of the mean", "")] = None
    roughness_peak_to_peak: Annotated[
        Quantity | None, Is("of p_chamber in the liquid phase, as share of the mean", "")
    ] = None
    bandwidth: Annotated[Quantity | None, Is("up to which p_chamber shows oscillations", "Hz")] = None
    detection_limit: Annotated[
        Quantity | None, Is("rms from which on a line of p_chamber is found, as share of the mean", "")
    ] = None
    lines: Annotated[tuple[Line, ...], Is("that stand out of the broadband floor, by phase")]
    roughness: Annotated[dict[str, dict[str, Roughness]], Is("by phase and channel")]
