"""What the models of all products have in common: fields that say what they are, and the way to JSON and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler
from pydantic_core import CoreSchema

from hfanalysis.quantity import Quantity


@dataclass(frozen=True)
class Is:
    """What a field is, and in which unit its numbers stand ("" for pure numbers)."""

    words: str
    unit: str | None = None

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        said = {"description": self.words} | ({} if self.unit is None else {"unit": self.unit})
        return {**handler(schema), **said}


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
    def given(self) -> dict[str, Any]:
        """Its fields that were given, by name."""
        return {name: getattr(self, name) for name in type(self).model_fields if name in self.model_fields_set}

    @property
    def quantities(self) -> dict[str, Quantity]:
        """Its own quantities by name, in order; those of its parts are not among them."""
        fields = ((name, getattr(self, name)) for name in type(self).model_fields)
        return {name: value for name, value in fields if isinstance(value, Quantity)}


class Product(Part):
    """A JSON product of a stage; who writes it adds the test and what it was made from.

    Each has its own ``notes`` and ``warnings``, where its file has them.
    """

    file: ClassVar[str]
    """Of the product, with its ending."""

    test: Annotated[str, Is("name of the test")] = ""
    source: Annotated[str, Is("measured, or generated: replica, synthetic")] = ""
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
        """As JSON has it: the provenance last."""
        out = super().to_json()
        return out | {"provenance": out.pop("provenance")} if "provenance" in out else out


Warnings = Annotated[tuple[str, ...], Is("what to be wary of")]
Notes = Annotated[tuple[str, ...], Is("what was done, and with what")]
Numbers = tuple[float, ...]


class AdoptedEffect(Part):
    """An effect that was adopted into the model of a test."""

    name: Annotated[str, Is("as the library of effects has it")]
    file: Annotated[str, Is("in engines/, which states it")]
    parameters: Annotated[dict[str, Quantity], Is("as stated, by name")]


Adopted = Annotated[tuple[AdoptedEffect, ...], Is("adopted effects in the model that this was made with")]
