"""The types of the products say all that their files hold, and the documents say what the types say."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import pytest
from pipeline import products_page
from tests.products.filled import filled
from tests.products.keys import KEYS

from hfanalysis.products.calibration import Calibration
from hfanalysis.products.disk import to_json
from hfanalysis.products.kinds import KINDS
from hfanalysis.products.model import Is, Part
from hfanalysis.quantity import Quantity


def parts(kind: type[Part]) -> Iterator[type[Part]]:
    """A model and all models in it."""
    yield kind
    for field in kind.model_fields.values():
        for part, _ in products_page._parts(field.annotation):
            yield from parts(part)


EVERY = sorted({part for kind in products_page.ALL.values() for part in parts(kind)}, key=lambda part: part.__name__)


def test_the_page_and_the_schemas_are_what_the_types_say() -> None:
    page = products_page.PAGE.read_text(encoding="utf-8")
    assert products_page.anew(page) == page, "make readme writes it anew"
    assert page.count("<!-- fields of ") == len(products_page.ALL)
    there = {path.name: path.read_text(encoding="utf-8") for path in products_page.SCHEMAS.iterdir()}
    assert there == products_page.schemas(), "make readme writes them anew"


@pytest.mark.parametrize("part", EVERY, ids=lambda part: part.__name__)
def test_every_field_says_what_it_is_and_every_number_its_unit(part: type[Part]) -> None:
    for name, field in part.model_fields.items():
        (about,) = (data for data in field.metadata if isinstance(data, Is))
        assert about.words, name
        number = any(kind in str(field.annotation) for kind in ("float", "int"))
        assert about.unit is not None or not number, name


@pytest.mark.parametrize("product", KEYS)
def test_the_keys_are_those_that_they_were(product: str) -> None:
    kind = KINDS[product.partition("/")[2]]
    assert list(_in_order(kind, KEYS[product])) == []


def _in_order(kind: type[Part], keys: Mapping[str, Any], where: str = "") -> Iterator[str]:
    """What of a product's keys is not in the type, lacks, or stands in another place."""
    fields = {field.alias or name: field for name, field in kind.model_fields.items()}
    known = [name for name in fields if name in keys and name != "provenance"]
    if known != [name for name in keys if name != "provenance"]:
        yield f"{where}: {list(keys)}"
    for name, field in fields.items():
        if field.is_required() and name not in keys:
            yield f"{where}.{name}"
        for part, path in products_page._parts(field.annotation):
            for below in _reached(keys.get(name), path):
                yield from _in_order(part, below, f"{where}.{name}{path}")


def _reached(keys: Any, path: str) -> list[Mapping[str, Any]]:
    found = [keys]
    while path:
        step, path = (path[:2], path[2:])
        found = [below for one in found if one for below in (one.values() if step == ".*" else one)]
    return [one for one in found if one]


@pytest.mark.parametrize("kind", KINDS.values(), ids=lambda kind: kind.__name__)
def test_a_product_is_read_as_it_was_written(kind: type[Part]) -> None:
    made = filled(kind, {})
    text = to_json(made)
    assert to_json(kind.from_json(json.loads(text))) == text


def test_a_key_that_no_type_has_is_refused() -> None:
    with pytest.raises(ValueError, match="C_j"):
        Calibration.from_json({**filled(Calibration, {}).to_json(), "C_j": 1.0})


def test_what_was_not_given_is_not_in_the_file() -> None:
    made = filled(Calibration, {})
    assert "tank_temperature" not in made.to_json()
    assert list(made.but(tank_temperature=Quantity(290.0, "K")).to_json())[-1] == "tank_temperature"
