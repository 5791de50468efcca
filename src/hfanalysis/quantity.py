"""A measured or derived number as every product states it: value, unit, standard deviation, 95 % interval."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

NORMAL_95 = 1.959963984540054
"""Half-width of the central 95 % of a normal distribution [standard deviations]. Source: its quantile at 0.975."""

IDENTIFIED = "identified"
NOT_IDENTIFIABLE = "not identifiable"
UNPHYSICAL = "unphysical"
DOUBTED = "doubted"
"""What it rests on cannot be quite believed; ``why`` says what, and the interval has what that may mean."""
STATED = "stated"
"""Held as test.toml has it."""
DERIVED = "derived"
"""It follows from others that are stated or found."""
CONDITIONAL = "conditional"
"""It holds on a condition that ``why`` names."""

HOLDS_ZERO = "its 95 % interval holds zero"


@dataclass(frozen=True)
class Quantity:
    """A number with its unit and uncertainty, or the reason why it cannot be had.

    ``value`` is in the SI unit named by ``unit`` ("" for a pure number); ``std`` is one standard deviation. ``ci95``
    defaults to the normal interval. Where ``value`` is None, ``reason`` says why. ``verdict`` and ``why`` judge it.

    A value lies within its own interval: ValueError, a defect of ours, where it does not. What is not told from zero is
    not identified, whoever says so.
    """

    value: float | None
    unit: str = ""
    std: float | None = None
    ci95: tuple[float, float] | None = None
    reason: str | None = None
    verdict: str | None = None
    why: str | None = None

    def __post_init__(self) -> None:
        if self.value is None and not self.reason:
            raise ValueError("a quantity without a value must say why")
        if self.value is not None and not math.isfinite(self.value):
            raise ValueError(f"a quantity must be finite, not {self.value}")
        if self.std is not None and not (math.isfinite(self.std) and self.std >= 0.0):
            raise ValueError(f"a standard deviation must be finite and not negative, not {self.std}")
        self._check_interval()

    def _check_interval(self) -> None:
        if self.value is None or self.interval is None:
            return
        low, high = self.interval
        if not (math.isfinite(low) and math.isfinite(high) and low <= self.value <= high):
            raise ValueError(f"a value must lie within its own interval, not {self.value} in {low} to {high}")
        if self.verdict == IDENTIFIED and low <= 0.0 <= high:
            object.__setattr__(self, "verdict", NOT_IDENTIFIABLE)
            object.__setattr__(self, "why", f"{HOLDS_ZERO}{f'; {self.why}' if self.why else ''}")

    def __str__(self) -> str:
        """As people write it, in its SI unit, with interval, verdict and why.

        >>> print(Quantity(5.271906, "s", 0.000485))
        5.27191 ± 0.00049 s (95 %: 5.27096 to 5.27286)
        >>> print(Quantity.absent("no p_chamber"))
        absent: no p_chamber
        """
        if self.value is None:
            return f"absent: {self.reason}"
        decimals = None if not self.std else max(1 - math.floor(math.log10(self.std)), 0)

        def text(value: float) -> str:
            plain = decimals is not None and decimals < 9 and abs(value) < 1e6
            return f"{value:.{decimals}f}" if plain else f"{value:.4g}"

        std = f" ± {text(self.std)}" if self.std else ""
        ends = f" (95 %: {' to '.join(text(end) for end in self.interval)})" if self.interval else ""
        judged = ": ".join(part for part in (self.verdict, self.why) if part)
        return f"{text(self.value)}{std}{self.unit and ' '}{self.unit}{ends}{judged and ', '}{judged}"

    def _repr_pretty_(self, printer: Any, _cycle: bool) -> None:
        """What a notebook shows."""
        printer.text(str(self))

    @classmethod
    def absent(cls, reason: str, *, verdict: str | None = None) -> Quantity:
        """A quantity that cannot be had, with the reason."""
        return cls(None, reason=reason, verdict=verdict)

    @property
    def interval(self) -> tuple[float, float] | None:
        """The 95 % interval [``unit``]: as given, else the normal one from ``std``; None where neither is known.

        >>> [round(end, 2) for end in Quantity(10.0, "s", 1.0).interval or ()]
        [8.04, 11.96]
        """
        if self.ci95 is not None:
            return self.ci95
        if self.value is None or self.std is None:
            return None
        half = NORMAL_95 * self.std
        return (self.value - half, self.value + half)

    def reaching(self, *values: float) -> Quantity:
        """The same with an interval that holds ``values`` [``unit``] too: what it may be on one side.

        >>> [round(end, 2) for end in Quantity(1.0, "", 0.01).reaching(0.8).interval or ()]
        [0.8, 1.02]
        """
        if self.value is None:
            return self
        low, high = self.interval or (self.value, self.value)
        return replace(self, ci95=(min(low, *values), max(high, *values)))

    def scaled_to(self, *factors: float) -> Quantity:
        """The same with an interval that holds its own at each of these ``factors`` [-], too.

        >>> [round(end, 2) for end in Quantity(1.0, "", 0.01).scaled_to(0.8).interval or ()]
        [0.78, 1.02]
        """
        ends = self.interval or ((self.value, self.value) if self.value is not None else ())
        return self.reaching(*(end * factor for end in ends for factor in factors))

    def doubted(self, why: str, reach: tuple[float, float] | None = None) -> Quantity:
        """The same in doubt: its interval has ``reach`` [``unit``] too, what it may be if the doubt is right.

        A worse verdict stays, with ``why`` beside its own.

        >>> Quantity(0.6, "", 0.01, verdict=IDENTIFIED).doubted("half the pace", (0.3, 0.3)).interval[0]
        0.3
        """
        if self.value is None:
            return self
        low, high = self.interval or (self.value, self.value)
        if reach is not None:
            low, high = min(low, *reach), max(high, *reach)
        std = self.std if reach is None else max(self.std or 0.0, 0.5 * (high - low) / NORMAL_95)
        verdict = self.verdict if self.verdict in (NOT_IDENTIFIABLE, UNPHYSICAL, STATED) else DOUBTED
        said = f"{why}; {self.why}" if self.why and self.why not in why else why
        return Quantity(self.value, self.unit, std, (low, high), verdict=verdict, why=said)

    def to_json(self) -> dict[str, Any]:
        """The form the products use."""
        if self.value is None:
            judged = {"verdict": self.verdict} if self.verdict else {}
            return {"value": None, "reason": self.reason, **judged}
        out: dict[str, Any] = {"value": self.value, "unit": self.unit, "std": self.std}
        out["ci95"] = list(self.interval) if self.interval else None
        if self.verdict:
            out["verdict"] = self.verdict
        if self.why:
            out["why"] = self.why
        return out

    @classmethod
    def __get_pydantic_core_schema__(cls, _source: Any, _handler: Any) -> Any:
        """In a model: taken as it is or from its JSON form, and written as that."""
        from pydantic_core import core_schema

        return core_schema.no_info_plain_validator_function(
            lambda given: given if isinstance(given, cls) else cls.from_json(given),
            serialization=core_schema.plain_serializer_function_ser_schema(cls.to_json),
        )

    @classmethod
    def __get_pydantic_json_schema__(cls, _schema: Any, _handler: Any) -> dict[str, Any]:
        return {"title": cls.__name__, "type": "object"}

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Quantity:
        """The inverse of :meth:`to_json`: numbers in the SI unit that ``data`` names [``data["unit"]``]."""
        if data["value"] is None:
            return cls(None, reason=data["reason"], verdict=data.get("verdict"))
        ci95 = data.get("ci95")
        return cls(
            data["value"],
            data["unit"],
            data["std"],
            (ci95[0], ci95[1]) if ci95 else None,
            verdict=data.get("verdict"),
            why=data.get("why"),
        )
