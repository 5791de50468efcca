"""What a stage is keyed by: all the code and data that can change its products, and nothing else."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from tests import few_effects
from tests.inference.adopted.firing import make_root

from hfanalysis.sources import PACKAGE, data
from hfanalysis.stages import ORDER, freshness
from hfanalysis.stages.base import load_stage
from hfanalysis.stages.open_test import open_test

ALONE = """
import os, sys
opened = set()
sys.addaudithook(lambda event, values: opened.add(str(values[0])) if event == "open" else None)

import importlib, json
from pathlib import Path
root, name = Path(sys.argv[1]), sys.argv[2]
stage = importlib.import_module(f"hfanalysis.stages.{name}").STAGE
from hfanalysis.stages.base import Context
from hfanalysis.record.definition import find_definition, load_definition
from hfanalysis.products.disk import temporary_path

few = {"calibrate.samples": 100, "flight.flights": 10, "flight.gust_seeds": 1, "flight.winds": [5.0]}
out = root / "processed" / "T1"
out.mkdir(parents=True, exist_ok=True)
context = Context(root, load_definition(find_definition(root, "T1")), out, settings=few)
stage.run(context.at(stage))
for product in map(context.product, stage.products):
    os.replace(temporary_path(product), product)
loaded = [m.__file__ for n, m in list(sys.modules.items()) if n.split(".")[0] == "hfanalysis"]
print(json.dumps([loaded, sorted(opened)]))
"""

ALONE_AMONG_FEW = ALONE.replace("out = root", few_effects.CODE + "out = root", 1)

KEYS = """
import json, sys
from pathlib import Path
from hfanalysis.stages import ORDER, freshness
from hfanalysis.stages.base import load_stage
from hfanalysis.stages.open_test import open_test
context = open_test(Path(sys.argv[1]), "T1")
print(json.dumps({name: freshness.code_hash(freshness.modules(context, load_stage(name))) for name in ORDER}))
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A root with the made-up test T1."""
    return make_root(tmp_path_factory.mktemp("root"))


def printed(code: str, *arguments: object, package: Path = PACKAGE) -> object:
    """What a new process prints that runs ``code`` with a copy of the package."""
    place = {**os.environ, "PYTHONPATH": str(package.parent)}
    command = [sys.executable, "-c", code, *map(str, arguments)]
    done = subprocess.run(command, env=place, capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


@pytest.fixture(scope="module")
def used(made: Path) -> dict[str, set[Path]]:
    """What each stage, alone in a process, loads and opens of the package's files; all effects, and few are tried."""
    found = {}
    for name in ORDER:
        loaded, opened = printed(ALONE if name != "diagnose" else ALONE_AMONG_FEW, made, name)  # type: ignore[misc]
        files = {Path(text).resolve() for text in (*loaded, *opened) if not text.isdigit()}
        found[name] = {p for p in files if PACKAGE in p.parents and "__pycache__" not in p.parts and p.is_file()}
    return found


@pytest.mark.parametrize("name", ORDER)
def test_all_that_a_stage_loads_and_opens_is_in_its_key(made: Path, used: dict[str, set[Path]], name: str) -> None:
    key = freshness.modules(open_test(made, "T1"), load_stage(name))
    assert len(used[name]) > 20
    assert used[name] - key - data(key) == set()


def test_what_stages_open_was_seen(used: dict[str, set[Path]]) -> None:
    """The proof above proves nothing of data files that its hook overlooks."""
    seen = {path.relative_to(PACKAGE).as_posix() for path in used["report"]}
    assert {"charts/style.css", "report/templates/page.html.j2", "report/script/9-start.js"} <= seen
    assert PACKAGE / "diagnose" / "answer" / "probabilities.json" in used["diagnose"]
    assert PACKAGE / "record" / "readers" / "delimited.py" in used["ingest"]


def test_a_stage_that_runs_others_rests_on_their_code(made: Path) -> None:
    context = open_test(made, "T1")
    whole = freshness.modules(context, load_stage("diagnose"))
    for name in ("ingest", "segment", "calibrate"):
        assert freshness.modules(context, load_stage(name)) <= whole


def test_what_a_team_s_own_effect_imports_is_in_the_key(tmp_path: Path) -> None:
    context = open_test(make_root(tmp_path), "T1")
    before = freshness.modules(context, load_stage("diagnose"))
    own = tmp_path / "effects" / "slosh.py"
    own.parent.mkdir()
    own.write_text("import pandas\nfrom hfanalysis.flight.rasp import write\n", encoding="utf-8")
    after = freshness.modules(context, load_stage("diagnose"))
    assert {own, PACKAGE / "flight" / "rasp.py"} <= after - before


STYLE, PAGE, AIR = "charts/style.css", "report/templates/page.html.j2", "thermo/air.py"
READER, EFFECT, ODDS = "record/readers/tdms.py", "effects/tank_heat.py", "diagnose/answer/probabilities.json"


@pytest.fixture(scope="module")
def redone(made: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, set[str]]:
    """The stages whose code is another after an edit of one file of a copy of the package, by file."""
    package = tmp_path_factory.mktemp("copy") / "hfanalysis"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    before, found = printed(KEYS, made, package=package), {}
    for name in (STYLE, PAGE, AIR, READER, EFFECT, ODDS):
        text = (package / name).read_text("utf-8")
        (package / name).write_text(text + "\n", "utf-8")
        after = printed(KEYS, made, package=package)
        (package / name).write_text(text, "utf-8")
        found[name] = {stage for stage in ORDER if after[stage] != before[stage]}  # type: ignore[index]
    assert printed(KEYS, made, package=package) == before
    return found


@pytest.mark.parametrize("name", [STYLE, PAGE])
def test_an_edit_of_the_page_s_templates_redoes_the_page_only(redone: dict[str, set[str]], name: str) -> None:
    assert redone[name] == {"report"}


def test_an_edit_of_the_air_redoes_the_flight_but_neither_ingest_nor_segment(redone: dict[str, set[str]]) -> None:
    assert "flight" in redone[AIR]
    assert not redone[AIR] & {"ingest", "segment"}


def test_an_edit_of_a_reader_redoes_the_ingest(redone: dict[str, set[str]]) -> None:
    assert "ingest" in redone[READER]
    assert not redone[READER] & {"segment", "validate", "flight", "report"}


def test_an_edit_of_an_effect_or_of_the_stated_odds_redoes_the_diagnosis(redone: dict[str, set[str]]) -> None:
    assert {"diagnose", "calibrate", "validate", "flight"} <= redone[EFFECT]
    assert "diagnose" in redone[ODDS]
    assert not (redone[EFFECT] | redone[ODDS]) & {"ingest", "segment"}
