"""An engine file of a calibrated test: geometry as stated, constants as calibrated, adopted effects with it."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hfanalysis.assembly.calibrated import exponent, loss_factor
from hfanalysis.effects import library_of
from hfanalysis.engine.unsteady import Engine
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.inference.adopted.effects import Adopted, tables
from hfanalysis.inference.full_run import FullRun
from hfanalysis.products.calibration import Calibration, Joint
from hfanalysis.quantity import IDENTIFIED, Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.document import read_toml
from hfanalysis.record.engine_file import TANK_SIZES, engine_of
from hfanalysis.record.written import table_lines, value_text
from hfanalysis.simulation.commented import Table, comment, marked
from hfanalysis.validate.model_errors import together
from hfanalysis.version import __version__

AS_STATED = "as stated in test.toml"
GENERATED = {"replica": " (REPLICA: generated, not measured)", "synthetic": " (SYNTHETIC: generated, not measured)"}


@dataclass(frozen=True)
class OfTest:
    """A test's engine as it is known.

    ``calibration`` and ``adopted``: the constants and effects in ``full``, the model's run; ``whose``: where each
    constant is from that is not the test's own, by name.
    """

    definition: TestDefinition
    calibration: Calibration
    full: FullRun
    adopted: Adopted
    whose: Mapping[str, str] = field(default_factory=dict)

    @property
    def joint(self) -> Joint:
        """Errors of the constants together [SI]."""
        return together(self.full.engine, self.calibration)


@dataclass(frozen=True)
class Written:
    """The text of an engine file, and what is left out of it, in words."""

    text: str
    left_out: tuple[str, ...]


def text_of(found: OfTest, path: Path, flight: bool = False) -> Written:
    """The engine file that is to be at ``path``; ``flight``: without what is of the stand alone.

    Raises AbsentError where a constant is none that an engine can have.
    """
    sections = _sections(found, flight)
    acting, left_out = _effects(found.adopted, path, flight)
    lines = [*_heading(found, left_out, flight), "schema = 1"]
    for name, table in sections.items():
        lines += table.lines(name)
    lines += _tables(found, acting, path, flight)
    body = "\n".join(lines) + "\n"
    text = marked(body)
    try:
        engine_of(tomllib.loads(text), path, text.encode())
    except InputError as error:
        name = found.definition.test.id
        raise AbsentError(f"test {name}: its calibration is no engine that can be: {error}") from None
    return Written(text, left_out)


def _heading(found: OfTest, left_out: tuple[str, ...], flight: bool) -> Iterator[str]:
    test = found.definition.test
    place = "in flight" if flight else "on its stand"
    yield from comment(
        f"The engine of test {test.id}{GENERATED.get(test.source, '')} {place}, hfanalysis {__version__}."
    )
    yield from comment("Numbers in SI; +/- is one standard deviation.")
    if not flight and found.definition.rocket is not None:
        yield from comment("Without [rocket], which would put it into flight: hfa engine --flight has it.")
    for text in left_out:
        yield from comment(f"Left out: {text}.")
    if not (found.full.follows or found.full.engine.oxidizer_enthalpy is None or _report(found)):
        yield from comment(
            "The model of the test feeds its chamber with the enthalpy of the opening; an engine file's follows the "
            "tank, which is worth a few thousandths of the impulse (docs/predict.md)."
        )


def _report(found: OfTest) -> bool:
    return found.definition.model.conventions == "report"


def _sections(found: OfTest, flight: bool) -> dict[str, Table]:
    test, stated = found.definition.test, _stated(found.definition)
    head = Table()
    head.put("id", f"{test.id}-flight" if flight else test.id, "of the test")
    if test.stand:
        head.put("stand", test.stand, AS_STATED)
    parts = {name: _as_stated(stated.get(name, {})) for name in ("tank", "injector", "grain", "chamber", "nozzle")}
    if "fuel" in stated:
        parts["fuel"] = _as_stated(stated["fuel"])
    _constants(found, parts)
    feed = Table()
    if flight:
        feed.put("K_loss", "0.0 1/m^4", f"the stand's line, {loss_factor(found.calibration):.4g} 1/m^4, is left out: "
                                        "state that of the rocket here")  # fmt: skip
    else:
        _put(feed, "K_loss", _bounded(found.calibration.K_loss, loss_factor(found.calibration)), "1/m^4", found)
    model = found.definition.model
    about = Table()
    about.put("conventions", model.conventions, AS_STATED if "model" in stated else "the default")
    about.put("properties", model.properties, AS_STATED if "model" in stated else "the default")
    tank = {"tank": parts.pop("tank"), "feed": feed}
    return {"engine": head, "model": about, **tank, **parts, **_site(found, flight)}


def _stated(definition: TestDefinition) -> dict[str, Any]:
    """The test's own words, as they are in its file."""
    return read_toml(definition.path)[1]


def _as_stated(part: Mapping[str, Any]) -> Table:
    table = Table()
    for key, value in part.items():
        table.put(key, value, AS_STATED)
    return table


def _constants(found: OfTest, parts: dict[str, Table]) -> None:
    """Calibrated constants in the place of stated ones."""
    calibration, engine = found.calibration, found.full.engine
    for key in TANK_SIZES:
        if key != "volume":
            parts["tank"].keys.pop(key, None)
    _put(parts["tank"], "oxidizer_mass", calibration.load, "kg", found)
    _temperature(found, parts["tank"], engine)
    m = calibration.m
    if m.value is None:
        m = Quantity(*_assumed(calibration), why=f"assumed, for the test does not tell: {m.reason}")
    _put(parts["tank"], "polytropic_exponent", m, "", found, "m")
    _put(parts["injector"], "C_i", calibration.C_i, "", found)
    _put(parts["grain"], "a", calibration.a, "", found)
    _put(parts["grain"], "n", calibration.n, "", found)


def _assumed(calibration: Calibration) -> tuple[float, str, float]:
    value, std = exponent(calibration)
    return value, "", std


def _temperature(found: OfTest, tank: Table, engine: Engine) -> None:
    fitted = found.calibration.tank_temperature
    std = fitted.std if fitted is not None and fitted.value is not None else None
    said = (
        "fitted with all else" if std is not None else "from which the model's tank meets p_tank when the line is full"
    )
    tank.put("temperature", _text(engine.temperature, std, "K"), f"of this test's tank at the opening: {said}")


def _bounded(quantity: Quantity, used: float) -> Quantity:
    """A loss coefficient as the model takes it: none where it is not known or negative."""
    if quantity.value == used:
        return quantity
    why = quantity.reason or f"found {quantity.value:.4g}, negative"
    return Quantity(used, quantity.unit, quantity.std, why=f"the model takes none: {why}")


def _put(table: Table, key: str, quantity: Quantity, unit: str, found: OfTest, name: str = "") -> None:
    """A calibrated number with where it is from, and what is doubted of it."""
    if quantity.value is None:
        raise AbsentError(f"test {found.definition.test.id}: {key} is missing ({quantity.reason})")
    said = [found.whose.get(name or key, f"calibrated from {found.definition.test.id}")]
    if quantity.verdict not in (None, IDENTIFIED):
        said[0] += f", {str(quantity.verdict).upper()}"
    if quantity.interval is not None:
        said += [f"95 %: {quantity.interval[0]:.5g} to {quantity.interval[1]:.5g} {unit}".rstrip()]
    said += [quantity.why] if quantity.why else []
    table.put(key, _text(quantity.value, quantity.std, unit), "; ".join(said))


def _text(value: float, std: float | None, unit: str) -> str:
    """In full, so that what is read is what was found."""
    spread = "" if std is None else f" +/- {float(std)!r}"
    return f"{float(value)!r}{spread} {unit}".rstrip()


def _site(found: OfTest, flight: bool) -> dict[str, Table]:
    definition = found.definition
    if flight and definition.rocket is not None and definition.rocket.launch_altitude is not None:
        return {}
    ambient, site = definition.ambient_pressure, definition.site
    table = Table()
    if site is not None and site.ambient_pressure is not None:
        table.put("ambient_pressure", _stated(definition)["site"]["ambient_pressure"], AS_STATED)
    else:
        said = "of the stated altitude" if site is not None and site.altitude is not None else "sea level: none stated"
        table.put("ambient_pressure", _text(ambient.value, ambient.std, "Pa"), said)
    return {"site": table}


def _effects(adopted: Adopted, path: Path, flight: bool) -> tuple[Adopted, tuple[str, ...]]:
    """The effects that the engine has here, and which are left out, with the reason."""
    left_out, known = {}, library_of(path, [active.effect.name for active in adopted.effects])
    for active in adopted.effects:
        effect = active.effect
        if effect.of_sensor:
            left_out[effect.name] = "it acts on what a sensor reads, not on the engine"
        elif flight and effect.stand_only:
            left_out[effect.name] = f"it is of {effect.stand_only}"
        elif effect.name not in known:
            raise AbsentError(f"effect {effect.name}: is a team's own, and {path} is not where its file would be found")
    kept = tuple(active for active in adopted.effects if active.effect.name not in left_out)
    words = [f"{name}: {why}" for name, why in left_out.items()]
    if flight:
        words += ["K_loss: it is of the stand's feed line"]
    return Adopted(kept, adopted.stated, adopted.file), tuple(words)


def _tables(found: OfTest, acting: Adopted, path: Path, flight: bool) -> Iterator[str]:
    """What has tables within it: rocket, effects, and the errors of the constants together."""
    if flight and "rocket" in (stated := _stated(found.definition)):
        yield ""
        yield from comment(AS_STATED)
        yield from table_lines(_rocket(stated["rocket"], found.definition, path), "rocket")
    for name, table in tables(acting).items():
        yield f"\n[effects.{name}]"
        yield from comment(found.whose.get("effects", f"adopted, engines/{acting.file}; others than stated there have "
                                                       "their prior's center"))  # fmt: skip
        yield from (f"{key} = {value_text(text)}" for key, text in table.items())
    joint = found.joint
    yield "\n[covariance]"
    yield from comment(
        "errors of the constants together, in SI; flow_area is C_i N_i A_i. "
        + found.whose.get("joint", "As calibrated")
    )
    yield f"names = {value_text(list(joint.names))}"
    yield f"std = {value_text(list(joint.std))}"
    rows = ",\n".join(f"    {value_text(list(row))}" for row in joint.correlation)
    yield f"correlation = [\n{rows},\n]"


def _rocket(stated: Mapping[str, Any], definition: TestDefinition, path: Path) -> dict[str, Any]:
    """As stated; its drag table is found from where the file will be."""
    table = stated.get("drag_table")
    if table is None:
        return dict(stated)
    there = os.path.relpath(definition.folder / table, path.parent)
    return {**stated, "drag_table": Path(there).as_posix()}
