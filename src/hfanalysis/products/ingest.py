"""The content of ingest.json: what an ingested log holds."""

from __future__ import annotations

from typing import Annotated, ClassVar

from hfanalysis.products.model import Is, Part, Product, Warnings

OWN = "of the channel"


class ChannelSummary(Part):
    """One channel in a few numbers."""

    label: Annotated[str, Is("its column in the log")]
    unit: Annotated[str, Is("of its values, SI")]
    samples: Annotated[int, Is("how many it has", "")]
    good: Annotated[int, Is("how many carry no flag", "")]
    rate: Annotated[float | None, Is("samples per second: the inverse of the median step", "1/s")]
    start: Annotated[float | None, Is("time of its first sample", "s, log time")]
    end: Annotated[float | None, Is("time of its last sample", "s, log time")]
    least: Annotated[float | None, Is("least good value", OWN)]
    largest: Annotated[float | None, Is("largest good value", OWN)]
    flags: Annotated[dict[str, int], Is("samples by flag; flags that none carries are left out", "")]
    accuracy: Annotated[float, Is("one standard deviation of its bias", OWN)]
    accuracy_stated: Annotated[bool, Is("whether test.toml states the accuracy; else it is that of its class")]
    zero: Annotated[float, Is("what was taken off as its zero", OWN)]
    zero_std: Annotated[float | None, Is("one standard deviation of the zero", OWN)]
    drift: Annotated[float, Is("of the zero over the firing, taken off linearly", OWN)]
    history: Annotated[tuple[str, ...], Is("what was done to it")]


class Ingest(Product):
    """What the log holds, channel by channel."""

    file: ClassVar[str] = "ingest.json"

    channels: Annotated[dict[str, ChannelSummary], Is("by canonical name")]
    warnings: Warnings
