"""RockSim engine files (``.rse``): thrust, propellant mass and center of gravity over time."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from hfanalysis.flight.motor import PLUGGED, Motor, Points, as_written, left_by_thrust, problems
from hfanalysis.rocket.vehicle import STANDARD_GRAVITY


def text(motor: Motor, points: Points, comments: Sequence[str] = (), radii: tuple[float, float] = (0.0, 0.0)) -> str:
    """The engine file; ``radii`` [m] of throat and exit. Raises ValueError for a curve that breaks the rules.

    Without a mass history simulators are told to make one from the thrust, without a center of gravity to take the
    middle.
    """
    points = as_written(points)
    broken = problems(points)
    if broken:
        raise ValueError(f"an engine file cannot have {', '.join(broken)}")
    attributes = {**_engine(motor, points, radii), **_display()}
    head = " ".join(f"{name}={quoteattr(value)}" for name, value in attributes.items())
    said = "\n".join(escape(line) for line in comments)
    return "\n".join([
        '<?xml version="1.0" encoding="UTF-8"?>', "<engine-database>", "  <engine-list>", f"    <engine {head}>",
        f"      <comments>{said}</comments>", "      <data>", *_rows(motor, points), "      </data>", "    </engine>",
        "  </engine-list>", "</engine-database>", "",
    ])  # fmt: skip


def _engine(motor: Motor, points: Points, radii: tuple[float, float]) -> dict[str, str]:
    burn, impulse = float(points.time[-1]), points.impulse
    share = 100.0 * motor.propellant_mass / motor.total_mass if motor.total_mass > 0.0 else 0.0
    speed = impulse / (STANDARD_GRAVITY * motor.propellant_mass) if motor.propellant_mass > 0.0 else 0.0
    return {
        "mfg": motor.maker, "code": motor.name, "Type": "hybrid",
        "dia": f"{1e3 * motor.diameter:.3f}", "len": f"{1e3 * motor.length:.3f}",
        "initWt": f"{1e3 * motor.total_mass:.3f}", "propWt": f"{1e3 * motor.propellant_mass:.3f}", "delays": PLUGGED,
        "auto-calc-mass": str(int(points.mass is None)), "auto-calc-cg": str(int(points.center is None)),
        "avgThrust": f"{impulse / burn:.3f}", "peakThrust": f"{points.thrust.max():.3f}",
        "throatDia": f"{2e3 * radii[0]:.3f}", "exitDia": f"{2e3 * radii[1]:.3f}", "Itot": f"{impulse:.3f}",
        "burn-time": f"{burn:.6f}", "massFrac": f"{share:.2f}", "Isp": f"{speed:.2f}",
    }  # fmt: skip


def _display() -> dict[str, str]:
    """How RockSim draws its table: even steps are not forced."""
    return {f"{name}{key}": value for name in ("t", "F", "m", "cg")
            for key, value in (("Div", "10"), ("Step", "-1."), ("Fix", "1"))}  # fmt: skip


def _rows(motor: Motor, points: Points) -> list[str]:
    mass = motor.propellant_mass * left_by_thrust(points) if points.mass is None else points.mass
    center = np.full(points.time.size, 0.5 * motor.length) if points.center is None else points.center
    return [
        f'        <eng-data cg="{1e3 * c:.3f}" f="{f:.4f}" m="{1e3 * m:.3f}" t="{t:.6f}"/>'
        for t, f, m, c in zip(points.time, points.thrust, mass, center, strict=True)
    ]


def read(content: str) -> tuple[Motor, Points, tuple[str, ...], tuple[float, float]]:
    """The first engine of a file: header, curve, comments, radii [m] of throat and exit.

    Raises ValueError where it is no such file, naming what is missing.
    """
    try:
        engine = ET.fromstring(content.encode()).find(".//engine")
    except ET.ParseError as error:
        raise ValueError(f"not an XML file: {error}") from None
    if engine is None:
        raise ValueError("the file holds no <engine>")
    rows = engine.findall("./data/eng-data")
    if not rows:
        raise ValueError("the engine holds no <eng-data>")
    time, thrust = (np.array([_number(row, key) for row in rows]) for key in ("t", "f"))
    mass, center = (np.array([_number(row, key, "0") for row in rows]) for key in ("m", "cg"))
    points = Points(
        time,
        thrust,
        None if engine.get("auto-calc-mass") == "1" else 1e-3 * mass,
        None if engine.get("auto-calc-cg") == "1" else 1e-3 * center,
    )
    motor = Motor(
        engine.get("code", "engine"), 1e-3 * _number(engine, "dia"), 1e-3 * _number(engine, "len"),
        1e-3 * _number(engine, "propWt"), 1e-3 * _number(engine, "initWt"), engine.get("mfg", "unknown"),
    )  # fmt: skip
    radii = (0.5e-3 * _number(engine, "throatDia", "0"), 0.5e-3 * _number(engine, "exitDia", "0"))
    return motor, points, tuple((engine.findtext("comments") or "").splitlines()), radii


def _number(element: ET.Element, key: str, default: str | None = None) -> float:
    found = element.get(key, default)
    try:
        return float(found)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise ValueError(f"<{element.tag}> has {key}={found!r}; expected a number") from None
