"""The report's engine in a rocket whose shape and masses are stated."""

from __future__ import annotations

from pathlib import Path

MAELSTROM = Path(__file__).parents[2] / "engines" / "maelstrom.toml"

GEOMETRY = """
[rocket.geometry]
nose = { kind = "ogive", length = "0.6 m" }
body = { length = "3.64 m" }
fins = { count = 4, root = "0.30 m", tip = "0.12 m", span = "0.16 m" }
structure = { mass = "40 kg", center_of_gravity = "1.75 m" }
tank_position = "2.1 m"
chamber_position = "3.4 m"
engine_mass = "12.5 kg"
engine_center_of_gravity = "3.1 m"
"""
"""Of the report's length and diameter; the rest is made up."""


def engine(folder: Path, geometry: str = GEOMETRY, *changes: tuple[str, str]) -> Path:
    """The report's engine in a rocket with a shape."""
    text = MAELSTROM.read_text(encoding="utf-8").replace('frontal_area = "19478 mm^2"', 'diameter = "157.48 mm"')
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / "engine.toml"
    path.write_text(text + geometry, encoding="utf-8")
    return path
