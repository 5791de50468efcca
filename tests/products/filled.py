"""Products of made-up tests: what a test says of one, and the least that must be there besides."""

from __future__ import annotations

from collections.abc import Mapping
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, get_args, get_origin

from pydantic import BaseModel

from hfanalysis.products.calibration import Calibration
from hfanalysis.products.model import Part
from hfanalysis.quantity import Quantity

P = TypeVar("P", bound=Part)
NOT_SAID = Quantity.absent("this test does not say it")


def filled(kind: type[P], data: Mapping[str, Any] | P) -> P:
    """The product with these fields, as its JSON has them; the others are as empty as they can be."""
    return data if isinstance(data, kind) else kind.from_json(_part(kind, data))


def loaded(mass: float, std: float) -> Calibration:
    """A calibration that says how much was loaded [kg], and nothing else."""
    return filled(Calibration, {"oxidizer_mass": Quantity(mass, "kg", std)})


def _part(kind: type[BaseModel], data: Any) -> Any:
    if not isinstance(data, Mapping):
        return data
    out = dict(data)
    for name, field in kind.model_fields.items():
        key = field.alias or name
        if key in out:
            out[key] = _value(field.annotation, out[key])
        elif field.is_required():
            out[key] = _empty(field.annotation)
    return out


def _value(of: Any, data: Any) -> Any:
    """What is given, with all its parts filled."""
    origin, inner = get_origin(of), get_args(of)
    if isinstance(of, type) and issubclass(of, BaseModel):
        return _part(of, data)
    if origin in (Union, UnionType) and data is not None:
        return _value(next(one for one in inner if one is not NoneType), data)
    if origin is tuple and inner[-1] is Ellipsis:
        return [_value(inner[0], item) for item in data]
    if isinstance(origin, type) and issubclass(origin, Mapping) and isinstance(data, Mapping):
        return {name: _value(inner[1], item) for name, item in data.items()}
    return data


def _empty(of: Any) -> Any:
    origin, inner = get_origin(of), get_args(of)
    if NoneType in inner:
        return None
    if of is Quantity:
        return NOT_SAID
    if isinstance(of, type) and issubclass(of, BaseModel):
        return _part(of, {})
    if origin is tuple:
        return [] if inner[-1] is Ellipsis else [_empty(one) for one in inner]
    return (origin or of)()
