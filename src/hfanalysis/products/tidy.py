"""Every quantity of a test's products as one table: a row each, tidy, for spreadsheets and data frames."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from hfanalysis.errors import InputError
from hfanalysis.products.disk import atomic, read_json
from hfanalysis.quantity import Quantity

COLUMNS = ("test", "product", "name", "value", "unit", "std", "low95", "high95", "verdict", "why")
"""Of the table; ``value`` in the SI unit that ``unit`` names, empty where ``why`` says why."""

FILES = ("segments", "calibration", "validation", "diagnosis", "flight")
"""Products with quantities, in the order of the way through."""

CAMPAIGN = "campaign"

Row = dict[str, Any]


def rows_of_test(folder: Path) -> list[Row]:
    """The rows of the products that are in a test's folder."""
    found = ((name, folder / f"{name}.json") for name in FILES)
    products = [(name, read_json(path)) for name, path in found if path.is_file()]
    return [row for name, product in products for row in rows(str(product.get("test", folder.name)), name, product)]


def rows_of_campaign(folder: Path, tests: Sequence[str]) -> list[Row]:
    """The rows of these tests below ``folder`` (processed/), and of what a campaign says of them together."""
    found = [row for test in tests for row in rows_of_test(folder / test)]
    path = folder / f"{CAMPAIGN}.json"
    return found + (list(rows("", CAMPAIGN, {"stands": read_json(path).get("stands", [])})) if path.is_file() else [])


def rows(test: str, product: str, data: Mapping[str, Any]) -> Iterator[Row]:
    """A row per quantity of a JSON product, wherever it is in it; its name is the way to it.

    >>> [row["name"] for row in rows("T1", "segments", {"t_open": {"value": 1.0, "unit": "s"}, "warnings": []})]
    ['t_open']
    """
    for name, value in _quantities(data, ""):
        yield {"test": test, "product": product, "name": name, **_cells(value)}


def _quantities(data: Any, name: str) -> Iterator[tuple[str, Quantity]]:
    if isinstance(data, Mapping):
        is_history = isinstance(data.get("value"), list)
        if "value" in data and not is_history and ("unit" in data or "reason" in data):
            yield name, _quantity(data)
            return
        parts = [(key, part) for key, part in data.items() if key not in ("provenance", "quoted")]
    elif isinstance(data, list):
        parts = [(_called(i, part), part) for i, part in enumerate(data)]
    else:
        return
    for key, part in parts:
        yield from _quantities(part, f"{name}.{key}" if name else str(key))


def _called(place: int, part: Any) -> str:
    """A part of a list by its name, where it has one."""
    return str(part.get("name") or part.get("stand") or place) if isinstance(part, Mapping) else str(place)


def _quantity(data: Mapping[str, Any]) -> Quantity:
    known = {key: data.get(key) for key in ("std", "reason", "verdict", "why")}
    if data["value"] is None:
        known["reason"] = known["reason"] or "not known"
    ends = data.get("ci95")
    return Quantity(data["value"], data.get("unit", ""), ci95=None if ends is None else (ends[0], ends[1]), **known)


def _cells(found: Quantity) -> Row:
    low, high = found.interval or (None, None)
    return {
        "value": found.value,
        "unit": found.unit or ("1" if found.value is not None else ""),
        "std": found.std,
        "low95": low,
        "high95": high,
        "verdict": found.verdict or "",
        "why": str(found.why or found.reason or ""),
    }


def write(path: Path, table: Sequence[Row]) -> None:
    """The table as ``.csv``, ``.parquet`` or ``.xlsx``, by the ending of ``path``; whole or not at all.

    Raises :class:`InputError` for another ending, and where what writes a workbook is not installed.
    """
    writers = {".csv": _write_csv, ".parquet": _write_parquet, ".xlsx": _write_excel}
    if path.suffix.lower() not in writers:
        raise InputError(f"{path}: expected a name that ends with {', '.join(writers)}")
    with atomic(path) as scratch:
        writers[path.suffix.lower()](scratch, table)


def csv_text(table: Sequence[Row]) -> str:
    """As CSV (RFC 4180 but for line ends): numbers in full, empty where there is none."""
    import csv
    import io

    out = io.StringIO()
    writer = csv.DictWriter(out, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(table)
    return out.getvalue()


def _write_csv(path: Path, table: Sequence[Row]) -> None:
    path.write_text(csv_text(table), encoding="utf-8", newline="")


def _write_parquet(path: Path, table: Sequence[Row]) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    numbers = {"value", "std", "low95", "high95"}
    kinds = {name: pa.float64() if name in numbers else pa.string() for name in COLUMNS}
    columns = {name: pa.array([row[name] for row in table], kind) for name, kind in kinds.items()}
    parquet.write_table(pa.table(columns), path)


def _write_excel(path: Path, table: Sequence[Row]) -> None:
    try:
        import xlsxwriter
    except ImportError:
        raise InputError("a workbook needs XlsxWriter: pip install 'hfanalysis[excel]'") from None
    book = xlsxwriter.Workbook(path, {"strings_to_formulas": False, "strings_to_urls": False, "in_memory": True})
    sheet = book.add_worksheet("results")
    sheet.write_row(0, 0, COLUMNS, book.add_format({"bold": True}))
    for i, row in enumerate(table, 1):
        sheet.write_row(i, 0, [row[name] for name in COLUMNS])
    sheet.freeze_panes(1, 3)
    book.close()
