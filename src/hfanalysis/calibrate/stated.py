"""Constants that test.toml states: they are held, and what the log itself says of them stands beside."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from hfanalysis.products.calibration import UNIT_OF_A
from hfanalysis.quantity import STATED, Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.thermo.saturation import Saturation
from hfanalysis.units import Value

UNITS = {"C_i": "", "m": "", "K_loss": "1/m^4", "a": UNIT_OF_A, "n": ""}


@dataclass(frozen=True)
class Held:
    """What is held, and the key that states it, by the constant's name."""

    values: dict[str, Value]
    keys: dict[str, str]

    @classmethod
    def of(cls, definition: TestDefinition, saturation: Saturation, temperature: float) -> Held:
        """As ``definition`` has it; ``temperature`` [K] of the vapor at t_v, which c_p/c_v is taken at."""
        found = {name: (value, key) for name, key, value in _stated(definition, saturation, temperature)}
        return cls({n: v for n, (v, _) in found.items()}, {n: k for n, (_, k) in found.items()})

    def value(self, name: str) -> float:
        """The held constant [SI]; NaN where it is not stated."""
        return self.values[name].value if name in self.values else float("nan")

    def std(self, name: str) -> float:
        """Its standard deviation [SI]; 0 where none is stated."""
        return (self.values[name].std or 0.0) if name in self.values else 0.0

    def quantity(self, name: str, by_log: Quantity | None = None) -> Quantity:
        """The held constant with its verdict, and what the log says of it."""
        value = self.values[name]
        why = f"held as {self.keys[name]} states it" + (f"; {beside(by_log)}" if by_log is not None else "")
        return Quantity(value.value, UNITS[name], value.std, verdict=STATED, why=why)

    def contradictions(self, found: dict[str, Quantity]) -> Iterator[str]:
        """Where the log says otherwise, by more than both intervals, in a sentence each."""
        for name, by_log in found.items():
            if name in self.values and apart(self.quantity(name), by_log):
                yield f"{self.keys[name]} states {_words(self.quantity(name))}, but the log says {_words(by_log)}"


def _stated(definition: TestDefinition, saturation: Saturation, temperature: float) -> Iterator[tuple[str, str, Value]]:
    injector, feed, tank = definition.injector, definition.feed, definition.tank
    if injector is not None and injector.C_i is not None and injector.C_i.value > 0.0:
        yield "C_i", "[injector] C_i", injector.C_i
    if feed is not None and feed.K_loss is not None:
        yield "K_loss", "[feed] K_loss", feed.K_loss
    exponent = tank.polytropic_exponent if tank is not None else None
    if isinstance(exponent, Value):
        yield "m", "[tank] polytropic_exponent", exponent
    elif exponent is not None:
        cv, cp = (float(c) for c in saturation.heat_capacities(temperature))
        yield "m", "[tank] polytropic_exponent", Value(cp / cv)


def law_of(definition: TestDefinition) -> dict[str, Value]:
    """Of a [SI] and n [-], those that are stated."""
    grain = definition.grain
    found = {"a": grain.a, "n": grain.n} if grain is not None else {}
    return {name: value for name, value in found.items() if value is not None}


def held_law(name: str, value: Value, by_log: Quantity | None) -> Quantity:
    """a or n as stated, and what the log says of it."""
    return Held({name: value}, {name: f"[grain] {name}"}).quantity(name, by_log)


def apart(one: Quantity, other: Quantity) -> bool:
    """Whether two of them differ by more than their 95 % intervals.

    >>> apart(Quantity(0.5, "", 0.01), Quantity(0.3, "", 0.05)), apart(Quantity(0.31), Quantity(0.3, "", 0.05))
    (True, False)
    """
    if one.value is None or other.value is None:
        return False
    (a, b), (c, d) = (q.interval or (q.value, q.value) for q in (one, other) if q.value is not None)
    return max(a, c) > min(b, d)


def beside(by_log: Quantity) -> str:
    """What the log says of a held constant, in words."""
    if by_log.value is None:
        return f"the log does not tell it: {by_log.reason}"
    return f"the log says {_words(by_log)}"


def _words(quantity: Quantity) -> str:
    """Value and 95 % half-width."""
    if quantity.value is None:
        return "nothing"
    low, high = quantity.interval or (quantity.value, quantity.value)
    unit = f" {quantity.unit}" if quantity.unit else ""
    return f"{quantity.value:.4g} ({low:.4g} to {high:.4g}){unit}" if high > low else f"{quantity.value:.4g}{unit}"
