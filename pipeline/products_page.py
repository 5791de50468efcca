"""Writes the fields of every product in docs/products.md, and docs/schemas/, from the types: `make readme`."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

from hfanalysis.products.campaign import Campaign
from hfanalysis.products.effects import EffectLibrary
from hfanalysis.products.engines import Designed, NextTests, Simulated
from hfanalysis.products.kinds import KINDS
from hfanalysis.products.model import Is, Part, Product
from hfanalysis.products.prediction import Prediction, Score
from hfanalysis.products.quick import QuickLook

DOCS = Path(__file__).resolve().parent.parent / "docs"
PAGE, SCHEMAS = DOCS / "products.md", DOCS / "schemas"
BLOCK = re.compile(
    r"(<!-- fields of (?P<file>\S+) \(written by `make readme`\) -->\n).*?(<!-- end of fields -->)", re.DOTALL
)
OTHERS = (Campaign, Simulated, Designed, NextTests, EffectLibrary, QuickLook, Prediction, Score)
"""What commands write or print that is no product of a stage."""
ALL: dict[str, type[Part]] = {**KINDS, **{kind.file: kind for kind in OTHERS}}

DIALECT = "https://json-schema.org/draft/2020-12/schema"
NUMBER_OR_NOTHING = ["number", "null"]
QUANTITY: dict[str, Any] = {
    "$schema": DIALECT,
    "$id": "quantity.schema.json",
    "title": "Quantity",
    "description": "A number with its unit and uncertainty, or the reason why it cannot be had.",
    "type": "object",
    "required": ["value"],
    "properties": {
        "value": {"type": NUMBER_OR_NOTHING, "description": "in SI; null where it cannot be had"},
        "unit": {"type": "string", "description": "SI; empty for a pure number"},
        "std": {"type": NUMBER_OR_NOTHING, "description": "one standard deviation"},
        "ci95": {"type": ["array", "null"], "items": {"type": "number"}, "description": "95 % interval"},
        "reason": {"type": "string", "description": "why there is no value"},
        "verdict": {"type": "string", "description": "identified, not identifiable, or unphysical"},
        "why": {"type": "string", "description": "of the verdict, or where the value is from"},
    },
}


def main() -> None:
    PAGE.write_text(anew(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    SCHEMAS.mkdir(exist_ok=True)
    for name, text in schemas().items():
        (SCHEMAS / name).write_text(text, encoding="utf-8")


def anew(page: str) -> str:
    """The page with its tables as the types are now; a product that has none yet gets one at the end."""
    page += "".join(_place(file) for file in ALL if f"<!-- fields of {file} (" not in page)
    return BLOCK.sub(lambda found: f"{found[1]}\n{_table(ALL[found['file']])}\n\n{found[3]}", page)


def _place(file: str) -> str:
    """Where the table of a product stands."""
    return f"\n### {file}\n\n<!-- fields of {file} (written by `make readme`) -->\n<!-- end of fields -->\n"


def schemas() -> dict[str, str]:
    """JSON schemas by the names of their files."""
    found = {file.replace(".json", ".schema.json"): _schema(file, kind) for file, kind in ALL.items()}
    found[QUANTITY["$id"]] = QUANTITY
    return {name: json.dumps(schema, indent=2, ensure_ascii=False) + "\n" for name, schema in found.items()}


def _schema(file: str, kind: type[Part]) -> dict[str, Any]:
    found = _tidied(kind.model_json_schema())
    if issubclass(kind, Product):
        found["required"] = [*Product.model_fields, *found["required"]]
    return {"$schema": DIALECT, "$id": file.replace(".json", ".schema.json"), **found}


def _tidied(schema: Any) -> Any:
    """The schema with a reference wherever it has a quantity, and without titles, which repeat the names."""
    if isinstance(schema, list):
        return [_tidied(part) for part in schema]
    if not isinstance(schema, dict):
        return schema
    is_quantity = schema.get("title") == "Quantity"
    kept = (name for name in schema if name != "title" and not (is_quantity and name == "type"))
    return {**({"$ref": QUANTITY["$id"]} if is_quantity else {}), **{name: _tidied(schema[name]) for name in kept}}


def _table(kind: type[Part]) -> str:
    lines = ["| field | unit | what it is |", "|---|---|---|"]
    for path, unit, words in _rows(kind):
        lines.append(f"| `{path}` | {unit} | {words} |")
    return "\n".join(lines)


def _rows(kind: type[Part], before: str = "") -> Iterator[tuple[str, str, str]]:
    """Path, unit and words of every field; those of what every product has are told once, above the tables."""
    common = Product.model_fields if issubclass(kind, Product) else {}
    own = (item for item in kind.model_fields.items() if before or item[0] not in common)
    for name, field in own:
        about = next(data for data in field.metadata if isinstance(data, Is))
        path = f"{before}{field.alias or name}"
        yield path, "" if about.unit is None else about.unit or "1", about.words
        for part, suffix in _parts(field.annotation):
            yield from _rows(part, f"{path}{suffix}.")


def _parts(of: Any, suffix: str = "") -> Iterator[tuple[type[Part], str]]:
    """The models in a type, and how one comes to them: ``.*`` in a map, ``[]`` in a list."""
    if isinstance(of, type) and issubclass(of, Part):
        yield of, suffix
        return
    origin = getattr(of, "__origin__", None)
    step = "[]" if origin is tuple else ".*" if isinstance(origin, type) and hasattr(origin, "items") else ""
    for inner in get_args(of):
        yield from _parts(inner, suffix + step)


if __name__ == "__main__":
    main()
