"""``ENGINE.published.toml`` beside an engine file: what a report, a paper or another program has of the engine."""

from __future__ import annotations

from dataclasses import field
from pathlib import Path
from typing import Any

from hfanalysis.products.engines import Designed, Simulated, SimulatedFlight
from hfanalysis.products.model import Part, units_of
from hfanalysis.record.document import read_toml, validate
from hfanalysis.record.schema import Refused, Section, Text, refusing, section, unknown_key
from hfanalysis.units import parse_as

ENDING = ".published.toml"

TABLES: dict[str, type[Part]] = {"simulate": Simulated, "flight": SimulatedFlight, "design": Designed}
"""Its tables, and the products whose quantities they name."""


@section
class PublishedNumbers(Section):
    """Numbers by the names of simulate.json, of its flight, and of design.json, with their units; in ``source``, whose
    they are."""

    source: Text
    simulate: dict[str, Any] = field(default_factory=dict)
    flight: dict[str, Any] = field(default_factory=dict)
    design: dict[str, Any] = field(default_factory=dict)

    def check(self) -> None:
        for table in TABLES:
            self.numbers(table)

    def numbers(self, table: str) -> dict[str, float]:
        """Of one of the tables, by name [SI]."""
        units, found = units_of(TABLES[table]), {}
        for name, stated in getattr(self, table).items():
            if name not in units:
                raise Refused(str(unknown_key(name, units)), table)
            with refusing(table, name):
                found[name] = parse_as(stated, units[name], "")
        return found

    def texts(self, table: str) -> dict[str, str]:
        """The same as they are written."""
        return {name: str(stated) for name, stated in getattr(self, table).items()}


def published(engine: Path) -> PublishedNumbers | None:
    """What lies beside the engine file at that path; None where nothing does.

    Raises :class:`InputError` naming file, key, found and expected.
    """
    path = engine.with_suffix(ENDING)
    return validate(PublishedNumbers, read_toml(path)[1], path) if path.is_file() else None
