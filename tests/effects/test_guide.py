"""docs/effects.md: what it says of the library is so, and its worked example works as it stands there."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pipeline import effects_page
from tests.effects.runs import SECONDS, base
from tests.engine.stand import engine_on_stand

import hfanalysis
from hfanalysis.cli.effects import effects
from hfanalysis.effects import effect, library
from hfanalysis.effects.trust import agree
from hfanalysis.engine.effect import Effect
from hfanalysis.engine.sensitivity import run_with_tangents
from hfanalysis.engine.unsteady import Burn, burn
from hfanalysis.errors import InputError

PAGE = Path(__file__).parents[2] / "docs" / "effects.md"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A team's folder of effects, with the guide's example in the file that its first line names."""
    code = re.findall(r"```python\n(# effects/(\w+\.py)\n.*?)```", PAGE.read_text(encoding="utf-8"), re.S)
    assert len(code) == 1
    root = tmp_path_factory.mktemp("root") / "effects"
    root.mkdir()
    (root / code[0][1]).write_text(code[0][0], encoding="utf-8")
    agree(root)
    return root


@pytest.fixture(scope="module")
def seal(folder: Path) -> Effect:
    return effect("tank_seal", folder)


def leaking(seal: Effect, moment: float, rtol: float = 1e-7) -> Burn:
    engine = engine_on_stand(effects=(seal.at(area=2e-6, moment=moment),))
    return burn(engine, SECONDS, rtol, run_on=True)


def test_the_page_describes_the_library_as_it_is() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert effects_page.anew(page) == page


def test_every_effect_has_its_page_and_its_picture_and_no_other_has() -> None:
    there = {path.stem: path.read_text(encoding="utf-8") for path in effects_page.FOLDER.glob("*.md")}
    assert there == effects_page.pages()
    assert {path.stem for path in effects_page.FOLDER.glob("*.png")} == set(there)


def test_the_example_stands_among_the_effects_of_the_library(folder: Path) -> None:
    found = library(folder)
    assert set(found) - set(library()) == {"tank_seal"}
    assert list(found) == sorted(found)


def test_an_engine_file_may_name_the_example(folder: Path) -> None:
    """One in engines/ beside the team's folder; one that lies elsewhere may not."""
    engine = (PAGE.parents[1] / "engines" / "maelstrom.toml").read_text(encoding="utf-8")
    named = engine + '[effects.tank_seal]\narea = "20 mm^2"\nmoment = "2 s"\n'
    there, elsewhere = folder.parent / "engines" / "leaking.toml", folder.parent / "other" / "leaking.toml"
    for path in (there, elsewhere):
        path.parent.mkdir(exist_ok=True)
        path.write_text(named, encoding="utf-8")
    sealed = hfanalysis.simulate(PAGE.parents[1] / "engines" / "maelstrom.toml")
    leaking = hfanalysis.simulate(there)
    assert leaking.attrs["result"]["total_impulse"]["value"] < 0.95 * sealed.attrs["result"]["total_impulse"]["value"]
    with pytest.raises(InputError, match="tank_seal"):
        hfanalysis.simulate(elsewhere)


def test_code_that_an_engine_file_does_not_name_needs_nobody_to_agree_to_it(folder: Path, tmp_path: Path) -> None:
    shutil.copytree(folder, tmp_path / "effects")
    engine = (PAGE.parents[1] / "engines" / "maelstrom.toml").read_text(encoding="utf-8")
    path = tmp_path / "engine.toml"
    path.write_text(f"{engine}[effects.nozzle_divergence]\nloss = 0.01\n", encoding="utf-8")
    assert hfanalysis.simulate(path).attrs["result"]["total_impulse"]["value"] > 0.0
    path.write_text(f'{engine}[effects.tank_seal]\narea = "3 mm^2"\n', encoding="utf-8")
    with pytest.raises(InputError, match="nobody has agreed"):
        hfanalysis.simulate(path)


def test_the_list_of_effects_calls_the_example_what_its_file_does(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    effects(folder.parent, as_json=False)
    assert "tank that leaks" in capsys.readouterr().out


def test_the_example_at_strength_zero_is_the_base_model(seal: Effect) -> None:
    found = burn(engine_on_stand(effects=(seal.at(area=0.0),)), SECONDS, run_on=True)
    assert np.array_equal(found.states, base().states)


def test_the_examples_leak_begins_at_its_moment_and_is_what_the_tank_lacks(seal: Effect) -> None:
    found = leaking(seal, 2.0)
    leaked = found.states[:, -1]
    assert np.abs(leaked[found.time <= 2.0]).max() < 1e-6
    expected = 2e-6 * np.sqrt(2.0 * 820.0 * 44e5)
    assert np.interp(2.5, found.time, leaked) == pytest.approx((0.5 - 0.05) * expected, rel=0.03)
    assert any(abs(at - 2.0) < 1e-9 for at in found.steps.times[:, 1])


def test_the_examples_tangents_cross_its_switch(seal: Effect) -> None:
    engine = engine_on_stand(effects=(seal.at(area=2e-6, moment=2.0),))
    tangents = run_with_tangents(engine, ["tank_seal.moment"], SECONDS, rtol=1e-6, run_on=True)
    later, sooner = leaking(seal, 2.001, 1e-8), leaking(seal, 1.999, 1e-8)
    at = np.array([1.5, 2.5, 4.0, 5.0])
    quotient = (later.steps.at(at)[1][:, 0] - sooner.steps.at(at)[1][:, 0]) / 0.002
    assert tangents.output("tank_pressure", at)[:, 0] == pytest.approx(quotient, rel=2e-3, abs=5.0)
    assert quotient[-1] > 100.0


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("tank_heat.py", lambda example: example, "name of its own"),
        ("seal.py", lambda example: example, "calls itself 'tank_seal'"),
        ("broken.py", lambda example: "1/0", "ZeroDivisionError"),
        ("ended.py", lambda example: "raise SystemExit", "SystemExit"),
        ("empty.py", lambda example: "", "found no EFFECT"),
    ],
)
def test_a_file_that_holds_no_effect_of_its_name_is_refused(
    folder: Path, tmp_path: Path, name: str, text: Callable[[str], str], message: str
) -> None:
    example = (folder / "tank_seal.py").read_text(encoding="utf-8")
    (tmp_path / name).write_text(text(example), encoding="utf-8")
    agree(tmp_path)
    with pytest.raises(InputError, match=message):
        library(tmp_path)


def test_files_with_an_underscore_and_a_folder_that_is_not_there_are_no_effects(tmp_path: Path) -> None:
    (tmp_path / "_shared.py").write_text("1/0", encoding="utf-8")
    assert list(library(tmp_path)) == list(library(tmp_path / "nowhere")) == list(library())
