"""What the models of all products have in common: fields that say what they are, and the way to JSON and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from hfanalysis import sentences
from hfanalysis.quantity import Quantity
from hfanalysis.sentences import Text


@dataclass(frozen=True)
class Is:
    """What a field is, and in which unit its numbers stand ("" for pure numbers)."""

    words: str
    unit: str | None = None

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        said = {"description": self.words} | ({} if self.unit is None else {"unit": self.unit})
        return {**handler(schema), **said}


class _AsItIs:
    """A text that stays what it is: a model would make a plain one of a sentence that knows its quantities."""

    def __get_pydantic_core_schema__(self, _source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_wrap_validator_function(_kept, handler(str))


def _kept(given: Any, as_usual: core_schema.ValidatorFunctionWrapHandler) -> Any:
    return given if isinstance(given, Text) else as_usual(given)


Words = Annotated[str, _AsItIs()]
"""A sentence, or some."""


class Part(BaseModel):
    """A part of a product. In JSON it has the fields that were given, in the order of the class."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", populate_by_name=True, serialize_by_alias=True, protected_namespaces=(),
        defer_build=True,
    )  # fmt: skip

    def to_json(self) -> dict[str, Any]:
        """As JSON has it."""
        return self.model_dump(exclude_unset=True)

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Self:
        """The inverse of :meth:`to_json`."""
        return cls.model_validate(data)

    def but(self, **changes: Any) -> Self:
        """The same with other values in some fields, which are not checked again."""
        return self.model_copy(update=changes)

    @property
    def content(self) -> dict[str, Any]:
        """Its fields that were given, by name."""
        own = {name: getattr(self, name) for name in type(self).model_fields if name in self.model_fields_set}
        return own | (self.__pydantic_extra__ or {})

    @property
    def shown(self) -> dict[str, Quantity]:
        """Its quantities under the names that people read, where it has any to show."""
        return self.quantities

    @property
    def quantities(self) -> dict[str, Quantity]:
        """Its own quantities [SI] by name, in order; those of its parts are not among them."""
        fields = ((name, getattr(self, name)) for name in type(self).model_fields)
        return {name: value for name, value in fields if isinstance(value, Quantity)}


def units_of(part: type[Part]) -> dict[str, str]:
    """The units [SI] of a part's own quantities by name, whether it has them or not."""
    found = {}
    for name, field in part.model_fields.items():
        said = next((about for about in field.metadata if isinstance(about, Is)), None)
        if field.annotation is Quantity and said is not None and said.unit is not None:
            found[name] = said.unit
    return found


LAST = ("quoted", "provenance")
"""Fields of a product that its file has last."""


class QuotedQuantity(Part):
    """A quantity that a sentence of the product has."""

    value: Annotated[float, Is("in SI", "as unit says")]
    unit: Annotated[str, Is("SI")]
    std: Annotated[float | None, Is("standard deviation, where the sentence has it", "as unit says")]


class Product(Part):
    """A JSON product of a stage; who writes it adds the test and what it was made from.

    Each has its own ``notes`` and ``warnings``, where its file has them.
    """

    file: ClassVar[str]
    """Of the product, with its ending."""

    test: Annotated[str, Is("name of the test")] = ""
    source: Annotated[str, Is("measured, or generated: replica, synthetic")] = ""
    quoted: Annotated[Mapping[str, QuotedQuantity], Is("quantities in its sentences, by their words")] = {}
    provenance: Annotated[Mapping[str, Any], Is(
        "what it was made from: SHA-256 of the raw files, of test.toml, of the source and of the products it rests on; "
        "versions; parameters"
    )] = {}  # fmt: skip

    @property
    def warned(self) -> tuple[str, ...]:
        """Its warnings, which stand elsewhere in each."""
        found: tuple[str, ...] = getattr(self, "warnings", ())
        return found

    def to_json(self) -> dict[str, Any]:
        """As JSON has it: what its sentences quote, and the provenance, last."""
        out = super().to_json()
        quoted = sentences.to_json(sentences.quoted_in(out))
        last = {"quoted": quoted} if quoted else {}
        return (
            {name: part for name, part in out.items() if name not in LAST}
            | last
            | {name: out[name] for name in LAST[1:] if name in out}
        )

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Self:
        """The inverse of :meth:`to_json`: its sentences know their quantities again."""
        quoted = sentences.from_json(data.get("quoted", {}))
        return super().from_json(sentences.revived(data, quoted) if quoted else data)


Warnings = Annotated[tuple[Words, ...], Is("what to be wary of")]
Notes = Annotated[tuple[Words, ...], Is("what was done, and with what")]
Numbers = tuple[float, ...]


class AdoptedEffect(Part):
    """An effect that was adopted into the model of a test."""

    name: Annotated[str, Is("as the library of effects has it")]
    file: Annotated[str, Is("in engines/, which states it")]
    parameters: Annotated[dict[str, Quantity], Is("as stated, by name")]

    @property
    def table(self) -> list[Quantity]:
        """The values of one that is a table over a state; empty of an effect of the library."""
        return [quantity for name, quantity in self.parameters.items() if name.startswith("value_")]


Adopted = Annotated[tuple[AdoptedEffect, ...], Is("adopted effects in the model that this was made with")]
