"""The command line as users and scripts hold on to it: what it prints where, and its exit status."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests import few_effects
from tests.cli.run import Run
from tests.inference.adopted.firing import make_root

import hfanalysis
from hfanalysis.cli import perform as performing
from hfanalysis.errors import AbsentError
from hfanalysis.interface import bringing

REPOSITORY = Path(__file__).parents[2]


def bytes_below(folder: Path) -> dict[Path, bytes]:
    """Every file below a folder."""
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A root with the replica HF5."""
    root = tmp_path_factory.mktemp("root")
    shutil.copytree(REPOSITORY / "raw_tests" / "HF5", root / "raw_tests" / "HF5")
    return root


@pytest.fixture(scope="module")
def quick(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A root with a made-up test T1 that lacks nothing, as a few effects see it: soon diagnosed."""
    with pytest.MonkeyPatch.context() as patch:
        few_effects.install(patch)
        yield make_root(tmp_path_factory.mktemp("quick"))


def test_the_version(run: Run) -> None:
    assert run("--version").out == f"hfa {hfanalysis.__version__}\n"


def test_a_notebooks_way_to_draw_has_no_effect(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MPLBACKEND", "module://of_a_notebook")
    run("--version")
    assert "MPLBACKEND" not in os.environ


def test_calibrate_prints_a_table_for_people(run: Run, root: Path) -> None:
    ended = run("calibrate", "HF5", "--root", root)
    assert ended.status == 0
    for name in ("C_i", "m", "K_loss", "p_loss_liquid", "p_loss_vapor", "t_feed", "t_v", "t_purge", "bar", "95 %"):
        assert name in ended.out
    assert "REPLICA: generated, not measured" in ended.out


def test_calibrate_says_what_a_and_n_belong_to(run: Run, root: Path) -> None:
    ended = run("calibrate", "HF5", "--root", root)
    assert "without nitrogen" in ended.out
    told = re.search(r"burn time ([\d.]+) s \(measured ([\d.]+) s\)", ended.out)
    assert told is not None
    fitted, measured = map(float, told.groups())
    # the fit weighs it against p_chamber: it need not meet it to the printed hundredth
    assert measured == 17.0
    assert fitted == pytest.approx(measured, abs=0.05)


def test_validate_prints_the_performance(run: Run, root: Path) -> None:
    ended = run("validate", "HF5", "--root", root)
    for name in ("total impulse", "specific impulse", "peak thrust", "chamber_forced", "full"):
        assert name in ended.out


def test_a_regression_of_one_test_is_no_regression_of_several(run: Run, root: Path) -> None:
    ended = run("regression", "HF5", "HF5", "--root", root)
    assert ended.status == 2
    assert "expected at least two: hfa regression TEST OTHER" in ended.err


def test_json_is_the_product_and_nothing_else(run: Run, root: Path) -> None:
    ended = run("calibrate", "HF5", "--root", root, "--json")
    assert ended.out == (root / "processed/HF5/calibration.json").read_text()
    assert json.loads(ended.out)["test"] == "HF5"


def test_a_test_without_a_rocket_has_nothing_to_fly(run: Run, tmp_path: Path) -> None:
    folder = tmp_path / "raw_tests" / "HF5"
    shutil.copytree(REPOSITORY / "raw_tests" / "HF5", folder)
    text = (folder / "test.toml").read_text()
    (folder / "test.toml").write_text(text[: text.index("[rocket]")])
    ended = run("flight", "HF5", "--root", tmp_path, "-q")
    assert ended.status == 3
    assert "no [rocket] to fly" in ended.err


def test_raw_thrust_flies_lower(run: Run, root: Path) -> None:
    flights = ("--root", root, "--json", "--set", "flight.flights=50")
    corrected, raw = (run("flight", "HF5", *flights, *more).out for more in ((), ("--raw-thrust",)))
    assert json.loads(raw)["thrust"] == "as measured on the stand"
    assert json.loads(raw)["apogee"]["value"] < json.loads(corrected)["apogee"]["value"]


@pytest.mark.parametrize("stage", ["ingest", "segment", "calibrate", "validate", "diagnose", "flight", "report", "run"])
def test_every_stage_speaks_json(run: Run, quick: Path, stage: str) -> None:
    ended = run(stage, "T1", "--root", quick, "--json")
    assert ended.status == 0
    assert isinstance(json.loads(ended.out), dict)


def test_warnings_of_the_products_are_on_standard_error(run: Run, root: Path) -> None:
    ended = run("calibrate", "HF5", "--root", root, "--quiet")
    assert ended.out == ""
    warned = json.loads((root / "processed/HF5/calibration.json").read_text())["warnings"]
    assert warned
    assert all(f"hfa: warning: {text}\n" in ended.err for text in warned)


def test_run_does_every_stage_and_keeps_the_raw_files_as_they_are(run: Run, quick: Path) -> None:
    before = bytes_below(quick / "raw_tests")
    assert run("run", "T1", "--root", quick).status == 0
    made = {path.name for path in (quick / "processed/T1").iterdir()}
    expected = {"ingest.h5", "segments.json", "calibration.json", "residuals.h5", "diagnosis.json", "report.html"}
    assert expected | {"run.log"} <= made
    assert (quick / "processed/index.html").exists()
    assert bytes_below(quick / "raw_tests") == before


def test_products_go_to_another_folder(run: Run, root: Path, tmp_path: Path) -> None:
    assert run("ingest", "HF5", "--root", root, "--out", tmp_path, "-q").status == 0
    assert (tmp_path / "HF5/ingest.h5").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["calibrate", "HF6"], "HF5"),
        (["calibrate", "../HF5"], "folder"),
        (["calibrate", "/"], "folder"),
        (["calibrate", ""], "folder"),
        (["calibrate", "."], "folder"),
        (["calibrate", "HF5", "--set", "calibrate.sample=3"], "calibrate.samples"),
        (["calibrate", "HF5", "--set", "calibrate.samples=many"], "400"),
        (["calibrate", "HF5", "--set", "calibrate.samples=3"], "expected 10 or more"),
        (["flight", "HF5", "--set", "flight.flights=0"], "expected 10 or more"),
        (["flight", "HF5", "--set", "flight.seed=-1"], "expected 0 or more"),
        (["flight", "HF5", "--set", "flight.winds=[2.0, -1.0]"], "expected 0 or more"),
        (["flight", "HF5", "--set", "flight.winds=[]"], "list of numbers"),
        (["flight", "HF5", "--set", 'flight.winds=["calm"]'], "list of numbers"),
        (["ingest", "HF5", "--out", "/proc/nowhere"], "/proc/nowhere"),
        (["diagnose", "HF5", "--proof-test", "HF6"], "HF5"),
        (["diagnose", "HF5", "--proof-test", "HF5"], "the test itself"),
        (["diagnose", "HF5", "--proof-test", "../HF5"], "folder"),
        (["diagnose", "HF5", "--apply", "--proof-test", "HF6"], "HF5"),
        (["diagnose", "HF5", "--set", "diagnose.proof_test=HF5"], "the test itself"),
        (["new", "HF5", "--log", "nowhere.csv"], "nowhere.csv"),
        (["new", "../x", "--log", "nowhere.csv"], "../x"),
    ],
)
def test_bad_input_ends_with_one_plain_message(run: Run, root: Path, arguments: list[str], message: str) -> None:
    ended = run(*arguments, "--root", root)
    assert ended.status == 2
    assert ended.out == ""
    assert ended.err.startswith("hfa: ")
    assert ended.err.count("\n") == 1
    assert message in ended.err
    assert not (root / "processed/HF6").exists()


@pytest.mark.parametrize("arguments", [["nonsense"], ["calibrate"], ["calibrate", "HF5", "--nonsense"], ["new", "X"]])
def test_misuse_of_the_command_line_is_bad_input(run: Run, arguments: list[str]) -> None:
    assert run(*arguments).status == 2


def test_a_log_without_what_was_asked_ends_with_three(run: Run, root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def absent(*_: object, **__: object) -> None:
        raise AbsentError("the log holds no firing")

    monkeypatch.setattr(bringing, "run_to", absent)
    ended = run("calibrate", "HF5", "--root", root)
    assert (ended.status, ended.out) == (3, "")
    *warned, last = ended.err.splitlines()
    assert last == "hfa: the log holds no firing"
    assert warned, "what the log is warned of may say why"
    assert all(line.startswith("hfa: warning: ") for line in warned)


def test_ctrl_c_ends_without_a_traceback(run: Run, root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(bringing, "run_to", interrupted)
    ended = run("calibrate", "HF5", "--root", root)
    assert ended.status == 130
    assert "Traceback" not in ended.err


def test_only_a_defect_of_ours_shows_a_traceback(root: Path) -> None:
    code = (
        "import sys; from hfanalysis.cli import main\nfrom hfanalysis.interface import bringing\n"
        "def broken(*_, **__): raise ValueError('ours')\n"
        f"bringing.run_to = broken; sys.argv = ['hfa', 'ingest', 'HF5', '--root', {str(root)!r}]; main()"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ended.returncode == 1
    assert "ValueError: ours" in ended.stderr


def test_help_and_fresh_results_load_nothing_heavy(run: Run, root: Path) -> None:
    run("calibrate", "HF5", "--root", root, "-q")
    for arguments in (["--help"], ["calibrate", "HF5", "--root", str(root)]):
        code = (
            f"import sys; sys.argv = {['hfa', *arguments]!r}; from hfanalysis.cli import main\n"
            "try: main()\nexcept SystemExit as end: assert not end.code, end.code\n"
            "print(*{name.split('.')[0] for name in sys.modules})"
        )
        ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        loaded = set(ended.stdout.splitlines()[-1].split())
        assert not {"numpy", "scipy", "pandas", "xarray", "matplotlib", "CoolProp", "numba", "h5py", "pint"} & loaded


def test_a_calibration_loads_no_more_than_it_needs(run: Run, root: Path, tmp_path: Path) -> None:
    arguments = ["calibrate", "HF5", "--root", str(root), "--out", str(tmp_path), "-q", "--set", "calibrate.samples=20"]
    run(*arguments)  # compiled code and tables are there now
    code = (
        f"import sys; sys.argv = {['hfa', *arguments, '--force']!r}; from hfanalysis.cli import main\n"
        "try: main()\nexcept SystemExit as end: assert not end.code, end.code\nprint(*sys.modules)"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(ended.stdout.splitlines()[-1].split())
    assert "numba" in loaded
    assert not {"pandas", "xarray", "pint", "matplotlib", "CoolProp"} & loaded


def test_a_parameter_can_be_set_for_a_run(run: Run, root: Path, tmp_path: Path) -> None:
    ended = run("calibrate", "HF5", "--root", root, "--out", tmp_path, "--set", "calibrate.samples=20", "--json")
    assert json.loads(ended.out)["provenance"]["parameters"]["samples"] == 20


QUIET = "time,p_tank,p_run\n" + "".join(f"{i / 100},{50 + (i % 7) / 100},1.0{i % 5}\n" for i in range(2000))
TOML = """\
schema = 1
[test]
id = "Q1"
kind = "hot_fire"
[log]
files = ["log.csv"]
time = { column = "time", unit = "s" }
[channels.p_tank]
column = "p_tank"
unit = "bar"
[channels.p_run]
column = "p_run"
unit = "bar"
"""


def test_a_log_with_no_firing_ends_with_three_and_still_gets_its_page(run: Run, tmp_path: Path) -> None:
    folder = tmp_path / "raw_tests" / "Q1"
    folder.mkdir(parents=True)
    (folder / "log.csv").write_text(QUIET)
    (folder / "test.toml").write_text(TOML)
    ended = run("run", "Q1", "--root", tmp_path, "-q")
    assert ended.status == 3
    assert ended.err.splitlines()[-1].startswith("hfa: ")
    page = (tmp_path / "processed/Q1/report.html").read_text()
    assert "No firing was found in this log" in page
    assert run("report", "Q1", "--root", tmp_path, "-q").status == 0
    assert run("calibrate", "Q1", "--root", tmp_path).status == 3


def test_the_test_to_prove_it_on_is_a_parameter_of_the_diagnosis(
    run: Run, root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(root / "raw_tests" / "HF5", tmp_path / "raw_tests" / "HF5")
    shutil.copytree(REPOSITORY / "raw_tests" / "HF4", tmp_path / "raw_tests" / "HF4")
    asked: list[performing.Request] = []
    monkeypatch.setattr(performing, "stage", lambda _name, request: asked.append(request))
    assert run("diagnose", "HF5", "--root", tmp_path, "--proof-test", "HF4").status == 0
    assert run("diagnose", "HF5", "--root", tmp_path).status == 0
    assert [request.settings for request in asked] == [('diagnose.proof_test="HF4"',), ()]
    assert performing._settings(asked[0].settings) == {"diagnose.proof_test": "HF4"}


def test_a_mistyped_proof_test_costs_no_finished_diagnosis(run: Run, root: Path, tmp_path: Path) -> None:
    made = tmp_path / "HF5" / "diagnosis.json"
    made.parent.mkdir()
    made.write_text("{}")
    assert run("diagnose", "HF5", "--root", root, "--out", tmp_path, "--proof-test", "HF6").status == 2
    assert made.exists()


def shell(command: str) -> subprocess.CompletedProcess[str]:
    """``hfa`` in a shell, as the status of the first command of a pipe."""
    hfa = f"{sys.executable} -m hfanalysis"
    script = f"set -o pipefail; {command.replace('hfa', hfa)}"
    return subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=False)


@pytest.mark.parametrize("options", ["", "--json"])
def test_a_reader_that_goes_away_is_no_fault(run: Run, root: Path, options: str) -> None:
    run("calibrate", "HF5", "--root", root, "-q")
    ended = shell(f"hfa calibrate HF5 --root {root} {options} | true")
    assert ended.returncode == 0
    assert "BrokenPipe" not in ended.stderr


def test_a_terminal_without_special_signs_is_no_fault(run: Run, root: Path) -> None:
    run("calibrate", "HF5", "--root", root, "-q")
    ended = shell(f"PYTHONIOENCODING=ascii hfa calibrate HF5 --root {root}")
    assert ended.returncode == 0
    assert "C_i" in ended.stdout


def test_the_report_also_comes_as_plots(run: Run, root: Path) -> None:
    ended = run("report", "HF5", "--root", root, "--plots")
    assert ended.status == 0
    plots = root / "processed/HF5/plots"
    assert "written: " in ended.err
    assert {path.stem for path in plots.glob("*.png")} == {path.stem for path in plots.glob("*.csv")}
    assert {"pressures", "thrust", "flow"} <= {path.stem for path in plots.glob("*.csv")}


def test_a_pdf_without_a_browser_ends_with_what_is_missing(
    run: Run, root: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    ended = run("report", "HF5", "--root", root, "--pdf")
    assert ended.status == 2
    assert ended.err.startswith("hfa: --pdf: no browser to print with; expected one of chromium")


def test_a_campaign_has_every_test_and_says_which_is_at_fault(run: Run, quick: Path, tmp_path: Path) -> None:
    broken = quick / "raw_tests" / "T2" / "test.toml"
    broken.parent.mkdir()
    broken.write_text("schema = 1\n")
    ended = run("campaign", "--root", quick, "--jobs", 1)
    shutil.rmtree(broken.parent)
    assert ended.status == 2
    assert "T2" in ended.err
    assert "T1: the model lacks: nothing that can be claimed" in ended.out
    product = json.loads((quick / "processed" / "campaign.json").read_text())
    assert {test: row["status"] for test, row in product["tests"].items()} == {"T1": "done", "T2": "input at fault"}
    assert product["tests"]["T1"]["calibration"]["C_i"]["verdict"] == "identified"
    assert "T1/report.html" in (quick / "processed" / "campaign.html").read_text()
    assert 'href="campaign.html">What they say together' in (quick / "processed" / "index.html").read_text()
    assert run("campaign", "T3", "--root", quick).status == 2
    assert run("campaign", "--root", tmp_path).status == 2


def test_two_tests_are_compared_on_one_page(run: Run, root: Path) -> None:
    if not (root / "raw_tests/HF4").exists():
        shutil.copytree(REPOSITORY / "raw_tests" / "HF4", root / "raw_tests" / "HF4")
    ended = run("compare", "HF5", "HF4", "--root", root, "--json")
    assert ended.status == 0
    (path,) = json.loads(ended.out)["products"]
    text = Path(path).read_text()
    assert text.count("REPLICA") == 2
    assert ">HF4</th>" in text
    assert 'href="HF5/compare_HF4.html"' in (Path(path).parents[1] / "index.html").read_text()


def test_a_comparison_knows_both_tests_before_it_computes(run: Run, tmp_path: Path) -> None:
    shutil.copytree(REPOSITORY / "raw_tests" / "HF5", tmp_path / "raw_tests" / "HF5")
    ended = run("compare", "HF5", "HF55", "--root", tmp_path)
    assert ended.status == 2
    assert "HF55" in ended.err
    assert not list(tmp_path.glob("processed/HF5/*.json"))


def test_a_test_is_not_compared_with_itself(run: Run, root: Path) -> None:
    ended = run("compare", "HF5", "HF5", "--root", root)
    assert ended.status == 2
    assert ended.err == "hfa: compare HF5 HF5: one test twice; expected two different ones\n"
