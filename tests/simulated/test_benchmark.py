"""The benchmark's runner loses no case, whatever dies; its table and its calibration say what is there."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from benchmarks.blind import folder as fo
from benchmarks.blind.archive import cases_of, pack, rounded, unpack
from benchmarks.blind.calibrate import Unfit, alarms, calibrate, forms, leads, pooled, save, weights
from benchmarks.blind.document import document, without_effect, write
from benchmarks.blind.fit import OFFSETS, Constants, Sample, fit, folds
from benchmarks.blind.folder import Folder, Note, write_json
from benchmarks.blind.logs import built_of, write_logs
from benchmarks.blind.pool import Outcome, Pool
from benchmarks.blind.results import results
from benchmarks.blind.run import (
    Refused,
    Request,
    archive_of,
    asked_for,
    check_plan,
    is_done,
    state_plan,
    variant_settings,
    without_log,
)
from benchmarks.blind.variants import comparison
from benchmarks.blind.work import Job, settings_of
from benchmarks.blind.wrong import longest, wrong_names
from simulated.blind import write as blind_write
from simulated.blind.judged import Case
from simulated.blind.plan import SHARES, SPLITS, plan
from simulated.blind.plan import Case as LogCase
from tests import few_effects
from tests.simulated.made_up import answer, broken, nothing, product, work

ROOT = Path(__file__).parents[2]
NOW = ("code", "constants")


def outcomes(names: list[str], folder: Path, count: int = 2) -> dict[str, Outcome]:
    """What a pool makes of jobs of those names; one after a dash is the second test of the stand before it."""
    jobs = [Job(folder, folder, n, n.removesuffix("B") + "A" if n.endswith("B") else None) for n in names]
    found = list(Pool(count, 1.5, folder / "log", work, nothing).run(jobs))
    assert sorted(o.job.id for o in found) == sorted(names), "each case comes back once"
    return {o.job.id: o for o in found}


def test_workers_that_die_or_take_for_ever_are_replaced_and_no_case_is_lost(tmp_path: Path) -> None:
    found = outcomes(["die-always", "die-once", "for-ever", "fail", *"abcd"], tmp_path)
    status = {name: o.status for name, o in found.items()}
    assert status == {"die-always": fo.DIED, "die-once": fo.DONE, "for-ever": fo.LATE, "fail": fo.FAILED,
                      **dict.fromkeys("abcd", fo.DONE)}  # fmt: skip
    assert found["fail"].message == "ValueError: no pressure in this log"
    assert "1.5 s" in found["for-ever"].message


def test_every_digest_is_of_files_that_are_there() -> None:
    of_nothing = fo.digest(ROOT / "no such folder")
    assert of_nothing not in (fo.code_digest(), fo.scoring_digest())


def test_workers_stay_and_say_which_case_was_their_first(tmp_path: Path) -> None:
    found = outcomes(list("abcdefgh"), tmp_path)
    assert len({o.result.settings["worker"] for o in found.values()}) <= 2
    assert 1 <= sum(o.first for o in found.values()) <= 2


def test_the_second_test_of_a_stand_waits_for_the_first(tmp_path: Path) -> None:
    found = outcomes(["xA", "xB", "y"], tmp_path)
    assert found["xB"].result.seconds >= found["xA"].result.diagnosis_seconds


def test_what_no_worker_can_load_ends_the_run(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="no such library"):
        list(Pool(1, 5.0, tmp_path / "log", work, broken).run([Job(tmp_path, tmp_path, "a")]))


def test_the_second_test_of_a_stand_gets_the_first_as_proof_where_the_diagnosis_takes_one(tmp_path: Path) -> None:
    job = Job(tmp_path, tmp_path, "D1B", "D1A", {"diagnose.variant": "plain"})
    assert settings_of(job, {"proof_test": None}) == {"diagnose.variant": "plain", "diagnose.proof_test": "D1A"}
    assert settings_of(job, {}) == {"diagnose.variant": "plain"}


def test_a_worker_loads_nothing_that_knows_the_answers() -> None:
    code = (
        "import sys, benchmarks.blind.__main__, benchmarks.blind.pool; from benchmarks.blind.work import prepare\n"
        "prepare(); sys.exit(any(name.startswith('tests') for name in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=False).returncode == 0


def test_what_is_done_stays_until_the_code_changes(tmp_path: Path) -> None:
    request = Request("scored", 10, Folder(tmp_path))
    note, there = Note("a", fo.DONE, code="code", probabilities="constants"), tmp_path
    refused = replace(note, status=fo.FAILED)
    assert is_done(note, there, request, NOW)
    assert not is_done(None, there, request, NOW)
    assert not is_done(note, tmp_path / "gone", request, NOW)
    assert not is_done(replace(note, code="older"), there, request, NOW)
    assert is_done(replace(note, code="older"), there, replace(request, keep=True), NOW)
    assert not is_done(replace(note, probabilities="older"), there, request, NOW)
    assert is_done(replace(note, probabilities="older"), there, replace(request, split="calibration"), NOW)
    assert is_done(refused, tmp_path / "gone", request, NOW)
    assert not is_done(refused, tmp_path / "gone", replace(request, retry=True), NOW)
    assert not is_done(replace(note, status=fo.DIED), there, request, NOW)
    assert not is_done(note, there, replace(request, settings={"diagnose.variant": "x"}), NOW)


def test_the_digest_sees_the_code_but_not_the_fitted_constants(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text("1")
    constants = tmp_path / "probabilities.json"
    first = fo.digest(tmp_path, constants)
    constants.write_text("{}")
    assert fo.digest(tmp_path, constants) == first
    (tmp_path / "a.py").write_text("2")
    assert fo.digest(tmp_path, constants) != first


def test_a_variant_that_the_diagnosis_does_not_know_is_refused() -> None:
    assert variant_settings(None, {}, ()) == {}
    assert variant_settings("plain", {}, ("variant",)) == {"diagnose.variant": "plain"}
    assert variant_settings("few", {"diagnose.starts": 1}, ("starts",)) == {"diagnose.starts": 1}
    for variant, given, known in (("plain", {}, ()), ("few", {"diagnose.start": 1}, ("starts",)),
                                  (None, {"diagnose.starts": 1}, ("starts",))):  # fmt: skip
        with pytest.raises(Refused):
            variant_settings(variant, given, known)


def test_cases_of_another_plan_are_refused(tmp_path: Path) -> None:
    case = plan(24)[0]
    path = tmp_path / "answers" / f"{case.id}.json"
    there = {"seed": case.seed, "kind": case.kind, "target_d_prime": case.target,
             "effects": [{"name": e} for e in case.effects]}  # fmt: skip
    write_json(path, there)
    check_plan([case], tmp_path)
    write_json(path, {**there, "target_d_prime": 99.0})
    with pytest.raises(Refused, match="another plan"):
        check_plan([case], tmp_path)


def hidden(i: int, name: str | None, split: str = "calibration", **more: object) -> dict[str, object]:
    return answer(name, 0.0 if name is None else 10.0) | {"id": f"X{i:03d}", "seed": SPLITS[split] + i,
                                                          "stand": None} | more  # fmt: skip


@pytest.fixture
def made(tmp_path: Path) -> Callable[..., Folder]:
    """A folder with cases, what was found, and notes; names in ``failed`` failed."""

    def make(found: list[tuple[str | None, dict[str, object]]], variant: str | None = None, failed: int = 0) -> Folder:
        folder = Folder(tmp_path, variant)
        for i, (name, what) in enumerate(found):
            a = hidden(i, name)
            write_json(folder.answers / f"{a['id']}.json", a)
            bad = i < failed
            folder.write_note(
                Note(str(a["id"]), fo.FAILED, "no flow")
                if bad
                else Note(str(a["id"]), fo.DONE, "", 9.0, 4.0, i == failed, "c")
            )
            if not bad:
                write_json(folder.product(str(a["id"])), what)
        write_json(folder.plan_file, {"n": len(found) + 5, "jobs": 2, "settings": {}})
        return folder

    return make


def test_the_page_counts_failures_and_what_was_not_run(made: Callable[..., Folder], tmp_path: Path) -> None:
    found = [("tank_heat", product("tank_heat"))] * 6 + [(None, product("none"))] * 4
    folder = made(found, failed=2)
    (folder.runs / "X009.json").unlink()  # a product that nothing vouches for
    page = tmp_path / "page" / "blind-benchmark.md"
    figures = write(results(folder, "calibration"), "calibration", page)["figures"]
    assert (figures["exact_name"]["k"], figures["exact_name"]["n"]) == (4, 6)
    assert figures["false_alarm"]["n"] == 3
    assert figures["runtime"]["n"] == 6, "neither failures nor the first of a process"
    text = page.read_text(encoding="utf-8")
    for line in ("| failed | no flow | 2 | X000, X001 |", "| cases planned | 15 |", "| of these failed | 2 |",
                 "| **not the whole plan** | 6 cases were not run |"):  # fmt: skip
        assert line in text
    assert "failed 2" in next(line for line in text.splitlines() if line.startswith("| tank_heat | 6 |"))
    picture = re.search(r"!\[.*\]\((.*)\)", text)
    assert picture is not None
    svg = (page.parent / picture[1]).read_bytes()
    write(results(folder, "calibration"), "calibration", page)
    assert (page.parent / picture[1]).read_bytes() == svg


def test_a_page_on_tests_without_an_effect_lists_what_was_claimed(made: Callable[..., Folder]) -> None:
    found = [("tank_heat", product("n2_purge")), (None, product("none")), (None, product("tank_heat"))]
    text, result = without_effect(results(made(found), "calibration"), "calibration")
    assert (result["figures"]["false_alarm"]["k"], result["figures"]["false_alarm"]["n"]) == (1, 2)
    listed = text.split("## What was claimed")[1]
    assert "| X002 | " in listed
    assert " | tank_heat | " in listed
    assert "X000" not in listed
    assert "X001" not in listed


def test_a_variant_stands_beside_the_full_method_on_the_same_cases(made: Callable[..., Folder]) -> None:
    full = made([("tank_heat", product("tank_heat"))] * 8 + [("n2_purge", product("n2_purge"))])
    made([("tank_heat", product("n2_purge"))] * 6 + [("tank_heat", product("tank_heat"))] * 2, variant="blind")
    text, _ = document(results(full, "calibration"), "calibration", None)
    assert "## Variant blind" in text
    row = next(x for x in text.split("## Variant")[1].splitlines() if x.startswith("| exact name"))
    cells = [cell.strip() for cell in row.split("|")]
    assert (cells[2], cells[3], cells[4], cells[6]) == ("1.000", "0.250", "+0.750", "8")


def test_a_variant_is_compared_by_means_and_medians_but_not_in_time(made: Callable[..., Folder]) -> None:
    full = made([("tank_heat", product("tank_heat"))] * 4)
    made([("tank_heat", {**product("tank_heat"), "set90": ["tank_heat", "none", "unknown"]})]
         + [("tank_heat", product("tank_heat"))] * 3, variant="blind")  # fmt: skip
    text, _ = document(results(full, "calibration"), "calibration", None)
    assert "one diagnosis [s]" in text.split("## Variant")[0]
    table = text.split("## Variant")[1].split("## ")[0]
    assert "one diagnosis [s]" not in table
    size = cells_of(next(x for x in table.splitlines() if x.startswith("| mean size")))
    assert size[1:4] == ["1.000", "1.500", "-0.500"]


def test_a_variant_of_another_version_of_the_code_is_not_compared(made: Callable[..., Folder]) -> None:
    full = made([("tank_heat", product("tank_heat"))] * 8)
    other = made([("tank_heat", product("n2_purge"))] * 8, variant="blind")
    for i, note in list(other.notes().items())[:-1]:
        other.write_note(replace(note, id=i, code="older"))
    text, _ = document(results(full, "calibration"), "calibration", None)
    assert "7 cases were diagnosed by `older`, and not by the full method" in text
    row = next(x for x in text.split("## Variant")[1].splitlines() if x.startswith("| exact name"))
    assert row.split("|")[-2].strip() == "1"
    for i, note in other.notes().items():
        other.write_note(replace(note, id=i, code="older"))
    text, _ = document(results(full, "calibration"), "calibration", None)
    assert "full less variant" not in text


def test_what_is_wrong_is_listed_with_its_rival_and_whether_it_was_sure(made: Callable[..., Folder]) -> None:
    full = made([("tank_heat", product("tank_heat", 0.95)), ("n2_purge", product("tank_heat", 0.95)),
                 ("n2_purge", product("tank_heat", 0.6)), (None, product("none"))])  # fmt: skip
    found = results(full, "calibration")
    head, _, *lines = wrong_names(found.cases.values(), found.groups)
    rows = [dict(zip(cells_of(head), cells_of(line), strict=True)) for line in lines]
    assert [(r["case"], r["hidden"], r["stated"], r["sure"]) for r in rows] == [
        ("X001", "n2_purge", "tank_heat", "yes"), ("X002", "n2_purge", "tank_heat", "")]  # fmt: skip
    text, _ = document(found, "calibration", None)
    assert lines[0] in text


def test_the_longest_diagnoses_are_listed_but_those_that_compiled() -> None:
    notes = {
        name: Note(name, fo.DONE, seconds=seconds, processor_seconds=0.5 * seconds, first=name == "b")
        for name, seconds in {"a": 3.0, "b": 90.0, "c": 60.0, "d": 10.0, "e": 9.0, "f": 8.0, "g": 7.0}.items()
    }
    lines = longest(notes)[2:]
    assert [cells_of(line)[0] for line in lines] == ["c", "d", "e", "f", "g"]
    assert cells_of(lines[0]) == ["c", "60.0", "30.0"]


def cells_of(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


ALL = ("X000", "X001", "X002")
PLACE = {"equation": "tank_energy", "phase": "liquid", "significance": 9.0, "history": {"time": [1.0, 2.0]}}


@pytest.fixture
def kept(made: Callable[..., Folder], tmp_path: Path) -> Path:
    """A file with a named effect, one that failed, and none."""
    further = PLACE | {"equation": "nozzle", "significance": 2.0}
    named = product("tank_heat", 0.93456789, localisation=[further, PLACE], gap={"before": {}, "closed_fraction": {}})
    named["effects"] = [{"name": "tank_heat", "probability": 0.9, "meaning": "blankets"}]
    folder = made([("tank_heat", named), ("n2_purge", named), (None, product("none", likeliest_place=PLACE))], failed=1)
    for path in folder.answers.glob("*.json"):
        write_json(path, json.loads(path.read_text(encoding="utf-8")) | {"generator": "g"})
    assert pack(folder, tmp_path / "kept.xz") == 3
    return tmp_path / "kept.xz"


def test_a_run_goes_on_elsewhere_from_what_was_kept(kept: Path, tmp_path: Path) -> None:
    here, there = Folder(tmp_path), Folder(tmp_path / "there")
    now = ("c", fo.ABSENT)
    assert unpack(kept, there, ALL, now, "g") == 2, "what failed was of no code"
    assert sorted(there.notes()) == ["X001", "X002"]
    note, product_there = there.note("X001"), json.loads(there.product("X001").read_text(encoding="utf-8"))
    assert note == here.note("X001")
    assert product_there["posterior"]["tank_heat"] == 0.934568
    assert [row.get("history") for row in product_there["localisation"]] == [PLACE["history"], None]
    assert product_there["effects"] == [{"name": "tank_heat", "probability": 0.9}]
    one, other = (document(results(f, "calibration"), "calibration", None)[1]["figures"] for f in (here, there))
    assert one["false_alarm"] == other["false_alarm"]
    request = Request("calibration", 3, there)
    assert is_done(note, there.product("X001"), request, now)
    assert unpack(kept, there, ALL, now, "g") == 0, "it is there already"


def test_what_an_earlier_version_found_stands_beside_it(kept: Path, tmp_path: Path) -> None:
    """The same cases, each figure by both, and their paired difference."""
    here = results(Folder(tmp_path), "calibration")
    now, earlier = here.cases, cases_of(kept, ("X000", "X001"))
    assert sorted(earlier) == ["X000", "X001"]
    assert earlier["X000"].failed
    assert earlier["X001"].posterior["tank_heat"] == pytest.approx(now["X001"].posterior["tank_heat"], abs=1e-6)
    lines = comparison(now, earlier, here.groups, ("now", "earlier"))
    assert lines[0].startswith("| figure | now | earlier | now less earlier |")
    assert all(" +0.000 " in line for line in lines[2:])


@pytest.mark.parametrize(
    ("now", "generator"), [(("other", fo.ABSENT), "g"), (("c", "other"), "g"), (("c", fo.ABSENT), "h")]
)
def test_what_another_version_made_stays_where_it_was_kept(
    now: tuple[str, str], generator: str, kept: Path, tmp_path: Path
) -> None:
    there = Folder(tmp_path / "there")
    assert unpack(kept, there, ALL, now, generator) == 0
    assert not there.notes()
    assert len(list(there.answers.glob("*.json"))) == (3 if generator == "g" else 0), "answers are the generator's"
    assert unpack(kept, there, ALL, None, generator) == (3 if generator == "g" else 0), "but for --keep"


def test_a_case_that_could_not_be_written_is_no_result(kept: Path, tmp_path: Path) -> None:
    there = Folder(tmp_path / "there")
    there.write_note(Note("X009", fo.UNWRITTEN, "ZeroDivisionError: float division by zero", code="c"))
    assert pack(there, kept) == 3


def test_logs_that_were_not_kept_are_written_anew(tmp_path: Path) -> None:
    """For what is to be diagnosed, and for the other test of a stand that it is proved on."""
    cases = plan(5, "calibration")
    names = [case.id for case in cases]
    for name in names[:4]:
        write_json(Folder(tmp_path).answers / f"{name}.json", {})
    (tmp_path / "raw_tests" / names[1]).mkdir(parents=True)
    (tmp_path / "raw_tests" / names[1] / "log.csv").touch()
    jobs = [Job(tmp_path, tmp_path, names[i], first) for i, first in ((1, None), (2, names[0]), (4, None))]
    assert [case.id for case in without_log(cases, jobs, tmp_path)] == [names[0], names[2]]


def test_a_log_written_to_its_answer_is_the_one_that_it_was_written_with(tmp_path: Path) -> None:
    case = LogCase("X", "stand", ("tank_heat",), 8.0, "ar1", 42, 41, "stand-x", True)  # the second of its stand
    blind_write.write_case(case, tmp_path)
    folder, answer = tmp_path / "raw_tests" / "X", tmp_path / "answers" / "X.json"
    log, document = pd.read_csv(folder / "log.csv"), (folder / "test.toml").read_text(encoding="utf-8")
    write_json(answer, rounded(json.loads(answer.read_text(encoding="utf-8"))))
    kept = answer.read_bytes()
    shutil.rmtree(folder)
    write_logs([case], tmp_path, 1)
    again = pd.read_csv(folder / "log.csv")
    assert json.loads(answer.read_bytes()) == json.loads(kept)
    assert (folder / "test.toml").read_text(encoding="utf-8") == document
    assert list(again) == list(log)
    assert np.array_equal(again.isna(), log.isna())
    differ = (again != log) & again.notna()
    assert differ.to_numpy().mean() < 0.02
    quanta = {blind_write.column(x.channel): x.quantum for x in built_of(case, json.loads(kept)).instruments.sensors}
    for name in log.columns[1:]:
        assert (again[name] - log[name]).abs().max() <= 1.01 * quanta[name], name
    stronger = json.loads(kept)
    stronger["effects"][0]["strength"] *= 1.5
    assert not np.array_equal(built_of(case, stronger).true.traces, built_of(case, json.loads(kept)).true.traces)


def test_an_answer_whose_log_cannot_be_written_to_it_is_sought_anew(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = LogCase("X", "single", ("tank_heat",), 8.0, "ar1", 41, 41)
    answer = tmp_path / "answers" / "X.json"
    write_json(answer, {"effects": []})
    write_logs([case], tmp_path, 1)
    assert not answer.exists()
    assert "X: KeyError" in capsys.readouterr().err


def test_a_part_of_a_plan_leaves_what_the_folder_goes_by(tmp_path: Path) -> None:
    whole = Request("scored", 1500, Folder(tmp_path), limit=300)
    part = replace(whole, kind="none", each=30, limit=None)

    def stated() -> dict[str, Any]:
        return dict(json.loads(whole.folder.plan_file.read_text(encoding="utf-8")))

    state_plan(part)
    assert stated()["kind"] == "none"
    state_plan(whole)
    state_plan(part)
    assert (stated()["limit"], "kind" in stated()) == (300, False)


def test_a_variant_is_kept_apart_from_the_full_method(tmp_path: Path) -> None:
    given = Request("scored", 3, Folder(tmp_path), archive=tmp_path / "scored.jsonl.xz")
    assert archive_of(given) == tmp_path / "scored.jsonl.xz"
    assert archive_of(replace(given, folder=Folder(tmp_path, "white"))) == tmp_path / "scored-white.jsonl.xz"
    assert archive_of(replace(given, archive=None)) is None


def test_of_what_is_kept_only_the_cases_asked_for_are_taken(kept: Path, tmp_path: Path) -> None:
    there = Folder(tmp_path / "there")
    assert unpack(kept, there, ("X000", "X002"), ("c", fo.ABSENT), "g") == 1
    assert list(there.notes()) == ["X002"]


def test_what_is_kept_is_added_to_and_replaced_but_never_lost(kept: Path, tmp_path: Path) -> None:
    there = Folder(tmp_path / "there")
    unpack(kept, there, ALL, ("c", fo.ABSENT), "g")
    note = there.note("X002")
    assert note is not None
    there.write_note(replace(note, seconds=1.0))
    (there.runs / "X001.json").unlink()
    assert pack(there, kept) == 3
    again = Folder(tmp_path / "again")
    unpack(kept, again, ALL, ("c", fo.ABSENT), "g")
    assert [n.seconds for n in again.notes().values()] == [9.0, 1.0]


LABELS = ("none", "unknown", "tank_heat", "n2_purge", "fuel_sliver", "nozzle_divergence")


def drawn(true: Constants, number: int) -> list[Sample]:
    """Samples whose right labels come as often as the constants say."""
    rng, out = np.random.default_rng(2), []
    for i in range(number):
        evidences = dict(zip(LABELS, rng.normal(0.0, 15.0, len(LABELS)).tolist(), strict=True))
        leftover = float(rng.uniform(0.8, 4.0))
        p = true.probabilities(evidences, leftover)
        out.append(Sample(evidences, leftover, str(rng.choice(LABELS, p=list(p.values()))), f"g{i // 2}"))
    return out


def test_the_fit_gives_back_the_constants_that_made_the_cases() -> None:
    true = Constants(4.0, 0.8, -1.0, 0.7, unseen_named=-2.5, unseen_unknown=-1.5, unexplained=0.8)
    found = fit(drawn(true, 5000), with_leftover=True)
    k, e = found.constants, found.errors
    z = [(np.log(k.temperature / 4.0), e["ln_temperature"]), (k.per_leftover - 0.8, e["per_leftover"]),
         (k.named + 1.0, e["named"]), (k.unknown - 0.7, e["unknown"]),
         (k.unseen_named + 2.5, e["unseen named"]), (k.unseen_unknown + 1.5, e["unseen unknown"]),
         (k.unexplained - 0.8, e["unexplained"])]  # fmt: skip
    for off, std in z:
        assert std is not None
        assert std < 0.25
        assert abs(off) < 3.0 * std
    assert abs(np.log(Constants().temperature / 4.0)) > 10.0 * e["ln_temperature"]  # the start was not the answer


@pytest.mark.parametrize("which", ["unexplained", "unseen unknown"])
def test_one_constant_may_be_fitted_alone(which: str) -> None:
    true = Constants(4.0, 0.8, -1.0, 0.7, unseen_named=-2.5, unseen_unknown=-1.5, unexplained=0.8)
    own = which.replace(" ", "_")
    found = fit(drawn(true, 3000), True, replace(true, **{own: 0.0}), which)
    std = found.errors[which]
    assert std is not None
    assert abs(getattr(found.constants, own) - getattr(true, own)) < 3.0 * std < 0.6
    assert asdict(replace(found.constants, **{own: getattr(true, own)})) == pytest.approx(asdict(true))


def test_parts_of_the_plan_count_by_their_share_of_it() -> None:
    sampled = {("none", 0.0): 5, ("single", 1.0): 1, ("single", 8.0): 12, ("outside", 32.0): 4}
    cases = [
        Case(answer(None if kind == "none" else "fuel_sliver", d, kind), {})
        for (kind, d), number in sampled.items()
        for _ in range(number)
    ]
    total: Counter[tuple[str, float]] = Counter()
    for case, weight in zip(cases, weights(cases), strict=True):
        total[case.kind, case.answer["target_d_prime"]] += weight
    assert total["single", 1.0] == pytest.approx(total["single", 8.0])
    assert total["single", 1.0] / total["none", 0.0] == pytest.approx(SHARES["single"] / 6 / SHARES["none"])
    assert total["outside", 32.0] / total["none", 0.0] == pytest.approx(SHARES["outside"] / 5 / SHARES["none"])
    assert sum(total.values()) < len(cases)
    assert weights(cases[:5]) == pytest.approx([1.0] * 5)


def test_a_case_counts_as_often_as_it_weighs() -> None:
    samples = drawn(Constants(4.0, 0.0, -1.0, 0.7), 200)
    heavy = [replace(s, weight=3.0) if i % 2 else s for i, s in enumerate(samples)]
    often = samples + 2 * samples[1::2]
    found, expected = (asdict(fit(cases, with_leftover=False).constants) for cases in (heavy, often))
    assert found == pytest.approx(expected, rel=2e-2, abs=2e-2)


def test_a_run_may_ask_for_a_part_of_the_plan() -> None:
    whole = asked_for(Request("development", 1500, Folder(Path("nowhere"))))
    part = asked_for(Request("development", 1500, Folder(Path("nowhere")), kind="single", targets=(8.0, 16.0), each=2))
    assert len(part) == 18 * 2 * 2
    assert [case for case in whole if case in part] == part
    assert {case.target for case in part} == {8.0, 16.0}


@pytest.mark.parametrize("number", [20, 200])
def test_evidence_that_never_misled_may_still_mislead(number: int) -> None:
    """That it misled in none of so many cases does not say that it never does: Laplace's rule of succession."""
    truths = [LABELS[i % 4] for i in range(number)]
    certain = [Sample({k: 60.0 * (k == truth) for k in LABELS}, 1.0, truth, f"g{i}") for i, truth in enumerate(truths)]
    k = fit(certain, with_leftover=False).constants
    assert k.misled == pytest.approx(1.0 / (number + 2))
    assert max(k.probabilities(certain[0].evidences, 1.0).values()) < 1.0 - 0.5 / (number + 2)


def test_how_often_faint_evidence_misleads_is_a_constant_of_its_own() -> None:
    true, rng = Constants(misled=0.01, misled_faint=0.3), np.random.default_rng(3)
    samples = []
    for i, evidence in enumerate(rng.uniform(7.0, 11.0, 1000).tolist()):
        evidences = dict.fromkeys(LABELS, 0.0) | {"tank_heat": evidence}
        p = true.probabilities(evidences, 1.0)
        samples.append(Sample(evidences, 1.0, str(rng.choice(list(p), p=list(p.values()))), f"g{i}"))
    found = fit(samples, with_leftover=False)
    std = found.errors["misled_faint"]
    assert found.constants.misled < 0.05
    assert std is not None
    assert abs(found.constants.misled_faint - 0.3) < 3.0 * std < 0.15


def test_tests_of_one_stand_stay_in_one_fold() -> None:
    fold = folds(drawn(Constants(), 100))
    assert (fold[::2] == fold[1::2]).all()
    assert len(set(fold.tolist())) == 5


def test_calibration_betters_the_stated_probabilities_and_keeps_to_its_split(
    made: Callable[..., Folder], tmp_path: Path
) -> None:
    samples = drawn(Constants(temperature=4.0, named=-1.0, unseen_named=-3.0, unseen_unknown=-3.0), 300)
    cases = [
        (None if s.truth == "none" else s.truth, {"evidences": s.evidences, "leftover": 1.0})
        for s in samples
        if s.truth != "unknown"
    ]
    folder = made(cases)
    lines, data = calibrate(results(folder, "calibration"), "calibration")
    score = {line[:22].strip(): float(line[24:31]) for line in lines if "+-" in line and line[0] not in "* "}
    assert score["fitted, 5-fold"] > score["evidences as they are"] + 0.2
    assert data["temperature"] == pytest.approx(4.0, rel=0.3)
    assert data["cases"] == len(cases)
    save(data, tmp_path / "p.json")
    assert json.loads((tmp_path / "p.json").read_text())["offsets"]["none"] == 0.0
    with pytest.raises(Unfit, match="calibration split"):
        save({**data, "split": "development"})
    folder.write_note(replace(folder.notes()["X000"], code="older"))
    mixed = results(folder, "calibration")
    with pytest.raises(Unfit, match="versions of the code"):
        calibrate(mixed, "calibration")


def constants_with(temperature: float, named: float, error: float | None) -> dict[str, Any]:
    shares = {"misled": 0.02, "misled_faint": 0.1, "unexplained": 0.0}
    return {
        "temperature": temperature, "temperature_per_leftover": 0.0, **shares, "cases": 100,
        "offsets": {"none": 0.0, "named": named, "unknown": -3.0, "unseen named": -4.0, "unseen unknown": -2.0},
        "standard_errors": {**dict.fromkeys(("ln_temperature", *OFFSETS, *shares), error), "per_leftover": None},
        "split": "calibration", "code": ["a"],
    }  # fmt: skip


def test_two_fits_count_by_their_standard_errors() -> None:
    one, other = constants_with(1.0, -2.0, 0.1), constants_with(4.0, -4.0, 0.2)
    found = pooled(one, other)
    assert found["temperature"] == pytest.approx(4.0**0.2)
    assert found["offsets"] == pytest.approx(
        {"none": 0.0, "named": -2.4, "unknown": -3.0, "unseen named": -4.0, "unseen unknown": -2.0}
    )
    assert (found["misled"], found["misled_faint"], found["unexplained"]) == pytest.approx((0.02, 0.1, 0.0))
    assert found["standard_errors"]["named"] == pytest.approx(1.0 / np.sqrt(125.0))
    assert (found["cases"], found["code"], found["split"]) == (200, ["a"], "calibration")
    with pytest.raises(Unfit, match="no standard error"):
        pooled(one, constants_with(1.0, -2.0, None))
    with pytest.raises(Unfit, match="misfit left"):
        pooled(one, {**other, "temperature_per_leftover": 0.1})


def command(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "benchmarks.blind", *arguments]


def test_calibration_counts_the_forms_of_what_is_right(made: Callable[..., Folder]) -> None:
    found = [("tank_heat", 2e-4), ("tank_heat", 6e-4), (None, 2e-4), ("n2_purge", 2e-4)]
    labels = ["tank_heat", "tank_heat", "none", "tank_heat"]  # the last is wrong
    cases = [
        (truth, {"posterior": {label: 0.9}, "compared": {"model_form_error": {"tank": form, "chamber": 8e-4}}})
        for (truth, form), label in zip(found, labels, strict=True)
    ]
    first, tank, chamber = forms(list(results(made(cases), "calibration").cases.values()))
    assert "the 3 cases" in first
    assert tank.split() == ["tank:", "0.02", "%:", "2,", "0.06", "%:", "1"]
    assert chamber.split() == ["chamber:", "0.08", "%:", "3"]


def test_calibration_tells_the_largest_evidences_of_nothing(made: Callable[..., Folder]) -> None:
    found = [{"none": 0.0, "n2_purge": 2.5, "unknown": -3.0}, {"none": 0.0, "n2_purge": -1.0, "unknown": 8.9}]
    cases = [(None, {"posterior": {"none": 0.9}, "evidences": evidences}) for evidences in found]
    cases += [("tank_heat", {"posterior": {"none": 0.9}, "evidences": {"none": 0.0, "tank_heat": 40.0}})]
    first, names, unknown = alarms(list(results(made(cases), "calibration").cases.values()))
    assert "the 2 cases" in first
    assert names.split() == ["names:", "2.5,", "-1.0"]
    assert unknown.split() == ["unknown:", "8.9,", "-3.0"]


def test_leads_of_unknown_sources_are_listed_where_they_act_in_the_same_equation() -> None:
    said = {"none": 0.0, "tank_heat": 40.0, "fuel_sliver": 3.0, "unknown": 44.0}
    found = [
        ("tank_heat", "single", said, None),
        ("tank_heat", "single", said, 44.0),
        ("tank_heat", "single", {**said, "unknown": 39.0}, None),
        ("tank_heat", "single", {**said, "tank_heat": 8.0}, None),
        ("fuel_sliver", "single", said, None),
        ("vent_leak", "outside", {**said, "unknown": 50.0}, -5.0),
    ]
    cases = [
        Case(
            answer(name, 10.0, kind, kind == "single", id=f"X{i}"), {"evidences": evidences, "unknown_elsewhere": apart}
        )
        for i, (name, kind, evidences, apart) in enumerate(found)
    ]
    _, right, outsiders = leads(cases)
    assert right == "  names that are right: 4.0 (40, X0)"
    assert outsiders == "  outsiders: 10.0 (40, X5)"


def test_the_scored_split_is_not_fitted_to_under_any_name(made: Callable[..., Folder], tmp_path: Path) -> None:
    made([(None, product("none"))])
    a = hidden(1, None, split="scored")
    write_json(tmp_path / "answers" / "X001.json", a)
    for split, why in (("scored", "nothing is fitted"), ("calibration", "cases of the split scored")):
        ran = subprocess.run(command("calibrate", "--split", split, "--out", str(tmp_path)), cwd=ROOT,
                             capture_output=True, text=True, check=False)  # fmt: skip
        assert ran.returncode == 2
        assert why in ran.stderr


def until(what: Callable[[], bool], seconds: float = 240.0) -> None:
    """Wait, but not for ever."""
    end = time.monotonic() + seconds
    while not what():
        assert time.monotonic() < end, "it did not come to this"
        time.sleep(0.05)


def interruptible() -> None:
    """A shell that starts the suite in the background has its children ignore interruptions."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def started(log: Path) -> list[str]:
    """The numbers of the workers' processes that have started."""
    return re.findall(r"worker (\d+) starts", log.read_text()) if log.exists() else []


def test_cases_are_diagnosed_to_the_last_though_a_worker_is_killed_and_the_run_interrupted(tmp_path: Path) -> None:
    names = [c.id for c in plan(24) if c.kind == "none"][:3]  # no strength has to be found for these: soon written
    limit = [c.id for c in plan(24)].index(names[-1]) + 1
    what = ("--n", "24", "--limit", str(limit), "--kind", "none", "--split", "development")
    run = command("run", *what, "--jobs", "2", "--out", str(tmp_path))
    folder = Folder(tmp_path.resolve())
    log = folder.runs / "log" / "workers.log"
    few = few_effects.environment(tmp_path)
    with subprocess.Popen(run, cwd=ROOT, env=few, stderr=subprocess.PIPE, text=True, preexec_fn=interruptible) as first:
        until(lambda: len(started(log)) == 2)
        killed, held = (int(number) for number in started(log))
        os.kill(held, signal.SIGSTOP)  # all cases are the other's then: it has one when it dies, and one more waits
        until(lambda: len(folder.notes()) > 0)
        os.kill(killed, signal.SIGKILL)
        until(lambda: len(started(log)) == 3)
        first.send_signal(signal.SIGINT)
        assert "goes on from here" in first.communicate(timeout=60)[1]
    assert first.returncode == 130
    kept = {name: (folder.runs / f"{name}.json").read_bytes() for name in folder.notes()}
    assert 1 <= len(kept) < 3
    again = subprocess.run(run, cwd=ROOT, env=few, capture_output=True, text=True, check=False)
    assert again.returncode == 0, again.stderr
    assert f"{len(kept)} done, {3 - len(kept)} to diagnose" in again.stderr
    assert all((folder.runs / f"{name}.json").read_bytes() == note for name, note in kept.items())
    assert {n.id: n.status for n in folder.notes().values()} == dict.fromkeys(names, fo.DONE)
    assert all(folder.product(name).exists() for name in names)
    page = tmp_path / "page.md"
    table = command("table", "--split", "development", "--out", str(tmp_path), "--write", str(page))
    assert subprocess.run(table, cwd=ROOT, check=False).returncode == 0
    assert "| diagnosed or failed | 3 |" in page.read_text()
    assert "--kind none`" in page.read_text()
