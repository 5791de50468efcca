"""The effects that may be named, and what a test states of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from hfanalysis.engine.effect import Effect
from hfanalysis.inference.fitting.hypothesis import Hypothesis


@dataclass(frozen=True)
class Catalogue:
    """The effects that may be named, and what a test states of them [SI]."""

    effects: Mapping[str, Effect]
    stated: Mapping[str, Mapping[str, float]]

    def add(self, hypothesis: Hypothesis, name: str) -> Hypothesis:
        """The hypothesis with an effect more."""
        return hypothesis.with_effect(self.effects[name], **self.stated.get(name, {}))
