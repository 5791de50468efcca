"""The keys of the products of HF4 and HF5, as they have to stay."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

KEYS: dict[str, dict[str, Any]] = json.loads((Path(__file__).parent / "keys.json").read_text(encoding="utf-8"))
"""Nested, by test and file; of a list, those of its first element; a quantity has none."""


def keys_of(product: dict[str, Any]) -> dict[str, Any]:
    """The nested keys of a product, in order, but for what its sentences quote, which is another in each."""
    told = {name: part for name, part in product.items() if name != "quoted"}
    return {name: _nested(part) if name != "provenance" else None for name, part in told.items()}


def _nested(data: Any) -> Any:
    if isinstance(data, list):
        return next(([_nested(part)] for part in data if isinstance(part, dict)), None)
    if not isinstance(data, dict) or ("value" in data and not isinstance(data["value"], list)):
        return None
    return {name: _nested(part) for name, part in data.items()}
