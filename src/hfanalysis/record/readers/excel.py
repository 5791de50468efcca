"""Spreadsheets (.xlsx, .xls, .ods): the columns of a sheet by their names, of several sheets by ``SHEET.NAME``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers.series import from_rows
from hfanalysis.record.readers.table import LogSeries, Table


def open_source(path: Path, spec: FileSpec) -> Table:
    """The sheets' columns of numbers; raises :class:`InputError` where the file cannot be read or has none."""
    from python_calamine import CalamineWorkbook

    try:
        book = CalamineWorkbook.from_path(path)
        sheets = {name: book.get_sheet_by_name(name).to_python() for name in book.sheet_names}
    except Exception as error:  # damaged files fail in every way that there is
        said = f"cannot be read as a spreadsheet: {str(error) or type(error).__name__}"
        raise InputError(f"{path}: {said}; expected one saved anew, or as CSV") from None
    found = {name: list(from_rows(rows)) for name, rows in sheets.items()}
    filled = {name: columns for name, columns in found.items() if columns}
    if len(filled) == 1:
        return Table(path, next(iter(filled.values())))
    return Table(path, [_under(name, column) for name, columns in filled.items() for column in columns])


def _under(sheet: str, column: LogSeries) -> LogSeries:
    return replace(column, name=f"{sheet}.{column.name}")
