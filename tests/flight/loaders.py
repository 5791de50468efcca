"""What the loaders of other programs take, told from their sources; each function returns what it would refuse.

OpenRocket: RASPMotorLoader, RockSimMotorLoader and AbstractMotorLoader (net.sf.openrocket.file.motor); thrustcurve.org:
simulate/parsers (rasp.js, rocksim.js); RocketPy: Motor.import_eng and import_rse. They are rules restated, not the
programs; RockSim itself, RASAero and what ran before these sources are not among them.
"""

from __future__ import annotations

import itertools
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator

PLUGGED_FROM = 90.0
"""[s] from which on OpenRocket takes a delay of a .rse for none."""

APART = {"rasp": 5e-4, "rocksim": 5e-5}
"""[s] between points, and to the first, that thrustcurve.org asks for."""


def openrocket_eng(text: str) -> list[str]:
    """Faults in a .eng; it is read as Latin-1."""
    return list(_openrocket_eng(text.encode().decode("latin-1")))


def _openrocket_eng(text: str) -> Iterator[str]:
    lines = [line for line in text.splitlines() if line]
    header = next(i for i, line in enumerate(lines) if line[0] != ";")
    cells = lines[header].split()
    if len(cells) != 7:
        yield f"{len(cells)} fields in the header"
        return
    if not any(part.upper() in ("P", "PLUGGED") for part in re.split("[-,]+", cells[3])):
        yield f"not plugged: {cells[3]}"
    if float(cells[4]) > float(cells[5]):
        yield "more propellant than mass"
    data = [line.split() for line in _until_comment(lines[header + 1 :])]
    yield from _openrocket_curve([(float(t), float(f)) for t, f in data])


def _until_comment(lines: list[str]) -> Iterator[str]:
    for line in lines:
        if line.startswith(";"):
            return
        yield line


def _openrocket_curve(points: list[tuple[float, float]]) -> Iterator[str]:
    if len(points) < 2:
        yield "too short a curve"
    if points != sorted(points):
        yield "times that do not increase"
    if any(b[0] - a[0] < 1e-8 for a, b in itertools.pairwise(points)):
        yield "two points at a time"


def openrocket_rse(text: str) -> list[str]:
    """Faults in a .rse."""
    return list(_openrocket_rse(ET.fromstring(text.encode())))


def _openrocket_rse(root: ET.Element) -> Iterator[str]:
    engine = root.find("./engine-list/engine")
    assert engine is not None
    yield from (f"no {key}" for key in ("mfg", "code", "dia", "len", "initWt", "propWt") if engine.get(key) is None)
    if _openrocket_delays(engine.get("delays", "")) != ["plugged"]:
        yield f"not plugged: {engine.get('delays')}"
    if float(engine.get("propWt", "nan")) > float(engine.get("initWt", "nan")):
        yield "more propellant than mass"
    if len(engine.findall("data")) != 1 or {child.tag for child in engine} - {"comments", "data"}:
        yield "other than one <data>"
    rows = engine.findall("./data/eng-data")
    yield from _openrocket_curve([(float(r.get("t", "nan")), float(r.get("f", "nan"))) for r in rows])


def _openrocket_delays(text: str) -> list[str]:
    if text.upper() in ("P", "PLUGGED"):
        return ["plugged"]
    return ["plugged" if float(part) >= PLUGGED_FROM else part for part in text.split(",")]


def thrustcurve_eng(text: str) -> list[str]:
    """What thrustcurve.org says of a .eng."""
    return list(_thrustcurve_eng([line.strip() for line in text.strip().split("\n")]))


def _thrustcurve_eng(lines: list[str]) -> Iterator[str]:
    first = next(i for i, line in enumerate(lines) if line and line[0] != ";")
    cells = lines[first].split()
    if len(cells) != 7:
        yield f"{len(cells)} fields in the header"
    yield from _sizes(*(float(cells[i]) for i in (1, 2)), 1e3 * float(cells[4]), 1e3 * float(cells[5]))
    body = [*lines[first + 1 :], ""]
    end = next(i for i, line in enumerate(body) if not line or line[0] == ";")
    points = [(float(t), float(f)) for t, f in (line.split() for line in body[:end])]
    yield from _thrustcurve_points(points, APART["rasp"], points[0][0])
    if any(line and line[0] != ";" for line in body[end:]):
        yield "more after the motor"
    if points[-1][1] > 1e-4:
        yield "no zero at the end"


def _sizes(diameter: float, length: float, propellant: float, total: float) -> Iterator[str]:
    """Of mm, mm, g, g."""
    if diameter < 1.0 or length < 1.0 or propellant < 0.1 or total < 1.0:
        yield f"sizes: {diameter} mm, {length} mm, {propellant} g, {total} g"


def _thrustcurve_points(points: list[tuple[float, float]], apart: float, first: float) -> Iterator[str]:
    if len(points) < 2:
        yield "too few points"
    if first < apart and first > 0.0:
        yield f"first time {first} not positive"
    if any(b[0] < a[0] + apart for a, b in itertools.pairwise(points)):
        yield "times too close"
    if any(t < 0.0 or f < 0.0 for t, f in points):
        yield "negative"


def thrustcurve_rse(text: str) -> list[str]:
    """What thrustcurve.org says of a .rse."""
    return list(_thrustcurve_rse(ET.fromstring(text.encode())))


def _thrustcurve_rse(root: ET.Element) -> Iterator[str]:
    if root.tag != "engine-database" or [child.tag for child in root] != ["engine-list"]:
        yield "other than one list in the database"
    engine = root[0][0]
    about = {key: float(engine.get(key, "nan")) for key in ("dia", "len", "propWt", "initWt")}
    yield from _sizes(*about.values())
    least = {"Itot": 0.1, "avgThrust": 1e-3, "peakThrust": 0.01, "burn-time": 0.01, "massFrac": 1.0, "Isp": 1.0}
    yield from (f"{key}={engine.get(key)}" for key, low in least.items() if not float(engine.get(key, "nan")) >= low)
    if not re.match("reload|hybrid|single", engine.get("Type", ""), re.IGNORECASE):
        yield "no type"
    rows = engine.findall("./data/eng-data")
    points = [(float(r.get("t", "nan")), float(r.get("f", "nan"))) for r in rows]
    yield from _thrustcurve_points(points, APART["rocksim"], points[0][0])


def rocketpy_eng(text: str) -> tuple[list[str], list[tuple[float, float]]]:
    """The header's fields and the curve, (0, 0) first; raises ValueError where a line is no pair of numbers."""
    header: list[str] = []
    points = [(0.0, 0.0)]
    for line in (re.sub(";.*", "", line).strip() for line in text.splitlines()):
        if line and not header:
            header = line.split(" ")
        elif line:
            time, thrust = re.findall(r"[-+]?\d*\.\d+|[-+]?\d+", line)
            points.append((float(time), float(thrust)))
    return header, points
