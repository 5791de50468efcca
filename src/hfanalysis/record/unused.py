"""Keys that a file may have and that nothing uses yet: whoever states one is told so."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator
from dataclasses import fields
from typing import Any

from hfanalysis.record.schema import Section
from hfanalysis.units import Value

OF_ENGINES = frozenset({
    "model.nozzle", "purge.cracking_pressure", "site.launch_temperature", "site.launch_pressure",
    "rocket.drag_uncertainty", "rocket.shot_to_shot",
})  # fmt: skip
"""Of engine files. Evidence: test_unused.py: ``hfa simulate`` and ``hfa design`` read every other key of the schema,
and none of these."""

LOOSE_OF_ENGINES = frozenset({
    "design.oxidizer_flow", "design.chamber_pressure", "design.target_apogee", "rocket.wind_speed",
    "rocket.casing_diameter", "rocket.casing_length",
    *(f"rocket.geometry.{key}" for key in (
        "nose.length", "body.length", "fins.root", "fins.tip", "fins.span", "fins.sweep", "fins.position",
        "fins.thickness", "tail.length", "tail.diameter", "tail.position", "structure.mass",
        "structure.center_of_gravity", "tank_position", "chamber_position", "engine_mass",
        "engine_center_of_gravity", "roughness",
    )),
})  # fmt: skip
"""Values of engine files whose +/- goes into no band: what is asked for, and what the margin alone is made of."""

OF_TESTS = frozenset({"tank.dip_tube.outer_diameter", "tank.dip_tube.inner_diameter"})
"""Of test.toml. Evidence: test_unused.py: the stages read every other key of the schema, and none of these."""

SPREADS_OF_TESTS = frozenset({
    "tank.volume", "tank.oxidizer_mass", "tank.ullage", "tank.polytropic_exponent", "injector.hole_area",
    "injector.hole_diameter", "injector.C_i", "feed.K_loss", "grain.mass", "grain.a", "grain.n", "nozzle.throat_radius",
    "site.ambient_pressure", "observed.burn_time", "observed.fuel_mass_after", "observed.oxidizer_mass_after",
    "observed.port_radius_after",
    "rocket.dry_mass", "rocket.drag_coefficient", "rocket.launch_angle", "rocket.wind_speed",
})  # fmt: skip
"""Values of test.toml whose +/- goes into intervals; that of an engine file goes into none. Evidence:
test_unused.py."""

SPREADS_OF_FITS = frozenset({
    "grain.length", "grain.outer_radius", "grain.density", "chamber.pre_volume", "chamber.post_volume",
    "nozzle.exit_radius",
})  # fmt: skip
"""Values of test.toml whose +/- is a range for the fits of all channels together alone: a diagnosis, and the constants
after an effect is adopted. Evidence: tests/acceptance/test_half_known.py and tests/calibrate/test_joint_errors.py."""


def unused(stated: Section, keys: Container[str], used: Callable[[str], bool], where: str) -> tuple[str, ...]:
    """One line that names what a file states and nothing uses, or none; ``where`` names the file.

    ``keys``: those that nothing uses; ``used``: whether the +/- of a key is.
    """
    idle = [_in_words(name) for name, _ in _given(stated, "") if name in keys]
    loose = _spreads(stated, lambda name: not (used(name) or name in keys))
    said = [*([", ".join(idle)] if idle else []), *([f"the +/- of {', '.join(loose)}"] if loose else [])]
    return (f"{where}: accepted, but not used yet: {'; '.join(said)}",) if said else ()


def for_fits_alone(stated: Section, where: str) -> tuple[str, ...]:
    """One line that names the +/- that goes into the fits of all channels together and into nothing else, or none."""
    loose = _spreads(stated, SPREADS_OF_FITS.__contains__)
    if not loose:
        return ()
    words = "is a range for hfa diagnose, and in no interval of a calibration without adopted effects"
    return (f"{where}: the +/- of {', '.join(loose)} {words}",)


def _spreads(stated: Section, asked: Callable[[str], bool]) -> list[str]:
    """Keys that are ``asked`` for, of which a +/- is stated, in words."""
    return [
        _in_words(name)
        for name, value in _given(stated, "")
        if isinstance(value, Value) and value.std is not None and asked(name)
    ]


def _given(section: Section, above: str) -> Iterator[tuple[str, Any]]:
    """Every key that is stated, dotted, and its value; sections within sections are gone through and named."""
    for field in fields(section):
        value = vars(section)[field.name]
        if value is None:
            continue
        yield f"{above}{field.name}", value
        if isinstance(value, Section):
            yield from _given(value, f"{above}{field.name}.")


def _in_words(name: str) -> str:
    section, _, key = name.rpartition(".")
    return f"[{section}] {key}"
