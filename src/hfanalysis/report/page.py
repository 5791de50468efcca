"""The page of a test: one HTML file that needs nothing else."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from hfanalysis.quantity import IDENTIFIED, UNPHYSICAL
from hfanalysis.report import wording
from hfanalysis.report.charts import figures
from hfanalysis.report.material import EVENTS, Material, phase_list
from hfanalysis.report.wording import in_words, is_quantity, quantities, shown


@functools.cache
def _environment() -> Environment:
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.globals |= {"style": Markup(_resource("style.css")), "source_words": _source_words}
    environment.filters |= {"fixed": wording.fixed, "in_words": in_words, "tidy": _scaled}
    return environment


def _resource(name: str) -> str:
    return (files("hfanalysis.report") / "templates" / name).read_text(encoding="utf-8")


def render(template: str, **values: Any) -> str:
    """Fill one of the templates; everything that is put in is escaped."""
    return _environment().from_string(_resource(template)).render(**values)


def page(material: Material) -> str:
    """The HTML of a test's page."""
    calibration = quantities(material.calibration or {})
    return render(
        "page.html.j2",
        test=material.definition.test,
        kind=_kind(material),
        verdicts=verdicts(calibration),
        sentence=sentence(material, calibration),
        warnings=warnings(material),
        absent=material.absent or {},
        figures=figures(material),
        phases=phase_list(material),
        events=_events(material),
        engineer=(material.segments or {}).get("engineer", []),
        notes=(material.segments or {}).get("notes", []),
        calibration={name: shown(quantity) for name, quantity in calibration.items()},
        rest=rest_rows(material),
        sensors=sensors(material),
        provenance=provenance(material),
    )


def _source_words(source: str) -> str:
    return wording.SOURCES.get(source, source)


def _kind(material: Material) -> str:
    kind = (material.segments or {}).get("kind") or material.definition.test.kind
    return wording.KINDS.get(kind, str(kind))


def _scaled(value: float | None, factor: float = 1.0) -> str:
    """A number of a sensor table."""
    return "–" if value is None else wording.tidy(value * factor)


def verdicts(calibration: Mapping[str, Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The cards at the top: what a calibration is asked for first, with how far each can be trusted."""
    wanted = [name for name in wording.MASTHEAD if name in calibration]
    return [{"name": name, "shown": (s := shown(calibration[name])), "mark": mark(s.verdict)} for name in wanted]


def mark(verdict: str) -> str:
    """The class of a verdict for the style sheet."""
    return {IDENTIFIED: "good", UNPHYSICAL: "bad"}.get(verdict, "open")


def sentence(material: Material, calibration: Mapping[str, Mapping[str, Any]]) -> str:
    """The verdict in a sentence."""
    if material.segments is None:
        return "No firing was found in this log, so there is nothing to calibrate."
    if not calibration:
        return "This test could not be calibrated; the reason is given below."
    by_mark: dict[str, list[str]] = {"good": [], "open": [], "bad": []}
    for card in verdicts(calibration):
        by_mark[card["mark"]].append(in_words(card["name"]))
    parts = [
        f"Identified: {_listed(by_mark['good'])}." if by_mark["good"] else "Nothing could be identified.",
        f"Outside its physical range: {_listed(by_mark['bad'])}." if by_mark["bad"] else "",
        f"Not identifiable from this test: {_listed(by_mark['open'])}." if by_mark["open"] else "",
    ]
    return " ".join(filter(None, parts))


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def warnings(material: Material) -> list[str]:
    """What every product warns of, each once; what bears on the results first."""
    products = (material.calibration or {}, material.segments or {}, material.ingest)
    texts = [str(text) for product in products for text in product.get("warnings", [])]
    return list(dict.fromkeys([*texts, *material.definition.warnings]))


def _events(material: Material) -> dict[str, Any]:
    segments = material.segments or {}
    return {name: shown(segments[name]) for name in ("t_open", *EVENTS) if is_quantity(segments.get(name))}


def rest_rows(material: Material) -> list[dict[str, Any]]:
    """The tank at rest: quantities as rows, sentences as they are."""
    rest = (material.calibration or {}).get("rest") or {}
    return [_rest_row(name, value) for name, value in rest.items() if value not in (None, [], {})]


def _rest_row(name: str, value: Any) -> dict[str, Any]:
    if is_quantity(value):
        return {"name": name, "shown": shown(value), "text": ""}
    text = "; ".join(map(str, value)) if isinstance(value, list) else str(value)
    return {"name": name, "shown": None, "text": text}


def sensors(material: Material) -> list[dict[str, Any]]:
    """One row per channel, in the units of people."""
    rows = []
    for name, channel in material.ingest["channels"].items():
        factor, unit = wording.people_unit(channel["unit"])
        flags = ", ".join(f"{count} {flag}" for flag, count in channel["flags"].items())
        rows.append({**channel, "name": name, "factor": factor, "unit": unit, "flag_words": flags or "none"})
    return rows


def provenance(material: Material) -> list[tuple[str, str]]:
    """What the page was made from, as rows of a table."""
    last = material.calibration or material.segments or material.ingest
    return list(_flat(last.get("provenance", {})))


def _flat(data: Mapping[str, Any], before: str = "") -> list[tuple[str, str]]:
    rows: list[tuple[str, str]] = []
    for name, value in data.items():
        full = f"{before}{name}"
        rows += _flat(value, f"{full} / ") if isinstance(value, Mapping) else [(full, str(value))]
    return rows
