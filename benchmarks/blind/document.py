"""docs/blind-benchmark.md: every figure of the benchmark, and what it was measured on."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from simulated.blind import targets
from simulated.blind.figures import middle, quantile
from simulated.blind.judged import NAMES, Case
from simulated.blind.score import score

from .effects_table import confusion_table, effects_table
from .folder import ABSENT, DONE, Folder, scoring_digest
from .picture import reliability_svg
from .results import Results, results
from .variants import comparison
from .words import BASELINE_FIGURES, FIGURES, INTRODUCTION, TIMES, WITHOUT_EFFECT
from .wrong import longest, sizes_by_effect, wrong_names


def document(full: Results, split: str, picture: str | None) -> tuple[str, dict[str, Any]]:
    """The page and all figures."""
    cases = list(full.cases.values())
    result = score(cases, full.missing, full.groups)
    sections = [
        ("# Blind benchmark", [INTRODUCTION, "", *facts(full, split)]),
        ("## Figures", figures(result)),
        ("## Single effects by d'", by_d_prime(result)),
        ("## Effect by effect", [_EFFECTS, "", *effects_table(cases, full.groups), "", twins(result)]),
        ("## Confusion matrix", [_CONFUSION, "", *confusion_table(result["confusion"], (*NAMES, "none", "unknown"))]),
        ("## What is wrong", [_WRONG, "", *wrong_names(cases, full.groups)]),
        ("## Sizes by effect", [_SIZES, "", *sizes_by_effect(cases)]),
        ("## Stated probabilities", reliability(result, picture)),
        ("## False alarms by family of noise", counted(result["false_alarm_by_noise"], "noise")),
        ("## Time", [TIMES, "", *times(full, result), "", *longest(full.notes)]),
        ("## Beside methods that do not look", baselines(result)),
        *((f"## Variant {v}", lines) for v, lines in variants(full, split)),
        ("## Without a diagnosis", failures(full)),
    ]
    return "\n".join("\n".join([title, "", *lines, ""]) for title, lines in sections), result


def without_effect(full: Results, split: str) -> tuple[str, dict[str, Any]]:
    """A page on the tests without an effect alone, and the figures."""
    cases = [case for case in full.cases.values() if case.kind == "none"]
    result = score(cases, full.missing, full.groups)
    sections = [
        ("# Tests without an effect", [WITHOUT_EFFECT, "", *facts(full, split)]),
        ("## Figures", rows(result, ("false_alarm", "no_source_on_none"))),
        ("## By family of noise", counted(result["false_alarm_by_noise"], "noise")),
        ("## What was claimed", claims(cases)),
        ("## Without a diagnosis", failures(full)),
    ]
    return "\n".join("\n".join([title, "", *lines, ""]) for title, lines in sections), result


def claims(cases: Iterable[Case]) -> list[str]:
    """Every test without an effect in which one, or a source, was claimed."""
    wrong = sorted((c for c in cases if c.claims or c.stated != "none"), key=lambda c: str(c.answer["id"]))
    if not wrong:
        return ["Nothing."]
    lines = ["| case | noise | stated | probability | verdict |", "|---|---|---|---|---|"]
    for c in wrong:
        verdict = c.product.get("verdict", "-")
        lines.append(
            f"| {c.answer['id']} | {c.answer['noise']['family']} | {c.stated} | {c.probability:.2f} | {verdict} |"
        )
    return lines


_EFFECTS = (
    "Single effects with d' >= 6, outsiders with d' >= 8 after the best of the library, all tests with two effects and "
    "with none, the worst first."
)
_CONFUSION = "Single effects and outsiders with d' >= 6, and tests without an effect."
_WRONG = (
    "Single effects with d' >= 6 and outsiders with d' >= 8 after the best of the library of which another label is "
    "stated, and all labels that are stated above 0.9 and wrong (sure). The first log evidence is the right label's."
)
_SIZES = "Effects with d' >= 6 whose source is given in its own equation and unit."


def facts(full: Results, split: str) -> list[str]:
    """What the figures rest on."""
    plan = full.plan
    planned = plan.get("n")
    command = (
        f"python -m benchmarks.blind run --split {split} --n {planned} --jobs {plan['jobs']}" if planned else "unknown"
    )
    if plan.get("kind"):
        command += f" --kind {plan['kind']}"
    if plan.get("seed"):
        command += f" --seed {plan['seed']}"
    lines = ["| | |", "|---|---|", f"| command | `{command}` |", f"| split | {split} |",
             f"| cases planned | {planned or '-'} |",
             f"| diagnosed or failed | {len(full.cases)} |",
             f"| of these failed | {sum(c.failed for c in full.cases.values())} |"]  # fmt: skip
    if planned and not plan.get("kind") and len(full.cases) < planned:
        lines.append(f"| **not the whole plan** | {planned - len(full.cases)} cases were not run |")
    for (code, constants), number in full.codes.most_common():
        fitted = "none" if constants == ABSENT else f"`{constants[:12]}`"
        lines.append(f"| code `{code[:12]}`, fitted constants {fitted} | {number} cases |")
    lines += [f"| generator `{made[:12]}` | {number} cases |" for made, number in full.generators.most_common()]
    return [*lines, f"| scorer | `{scoring_digest()[:12]}` |"]


def rows(result: dict[str, Any], names: Iterable[str]) -> list[str]:
    """Lines of the main table."""
    head = ["| figure | measured | 95 % limits | cases | must | aim | |", "|---|---|---|---|---|---|---|"]
    return [*head, *(targets.row(name, result["figures"][name], FIGURES[name]) for name in names)]


def times(full: Results, result: dict[str, Any]) -> list[str]:
    """Seconds on the clock, against what they must be, and of the processor and the last stage alone."""
    notes = [n for n in full.notes.values() if n.status == DONE and not n.first]
    parts = {"processor time [s]": [n.processor_seconds for n in notes],
             "the stage diagnose alone [s]": [n.diagnosis_seconds for n in notes]}  # fmt: skip
    lines = rows(result, ("runtime", "runtime_90", "runtime_max"))
    for what, seconds in parts.items():
        for name, figure in (("median", middle(seconds)), ("the longest", quantile(seconds, 1.0))):
            lines.append(targets.row("", figure.to_json(), f"{what}, {name}"))
    return lines


def figures(result: dict[str, Any]) -> list[str]:
    """The main table."""
    return rows(result, [name for name in FIGURES if name in result["figures"]])


def _cell(figure: dict[str, Any]) -> str:
    if figure["value"] is None:
        return "-"
    return f"{figure['value']:.3f}" + (
        "" if figure["low"] is None else f" ({figure['low']:.2f} to {figure['high']:.2f})"
    )


def by_d_prime(result: dict[str, Any]) -> list[str]:
    """Accuracy against detectability."""
    lines = ["| d' asked for | cases | exact name | twin group | anything claimed |", "|---|---|---|---|---|"]
    for row in result["by_d_prime"]:
        cells = [_cell(row[key]) for key in ("exact", "group", "claimed")]
        lines.append(f"| {row['d_prime']:g} | {row['exact']['n']} | {' | '.join(cells)} |")
    return lines


def twins(result: dict[str, Any]) -> str:
    """The groups that the benchmark declares."""
    groups = "; ".join(", ".join(group) for group in result["twins"]) or "none"
    return f"Twins: {groups}. Mean size of a group: {result['mean_group_size']:.2f}."


def reliability(result: dict[str, Any], picture: str | None) -> list[str]:
    """The diagram, and its numbers."""
    lines = [f"![stated probability against the share that was right]({picture})", ""] if picture else []
    lines += ["| stated, mean | right | 95 % limits | cases |", "|---|---|---|---|"]
    for r in result["reliability"]:
        lines.append(f"| {r['stated']:.3f} | {r['right']:.3f} | {r['low']:.3f} to {r['high']:.3f} | {r['n']:.0f} |")
    return lines


def counted(shares: dict[str, dict[str, Any]], what: str) -> list[str]:
    """Shares by kind."""
    lines = [f"| {what} | share | cases |", "|---|---|---|"]
    return [*lines, *(f"| {name} | {_cell(figure)} | {figure['n']} |" for name, figure in shares.items())]


def baselines(result: dict[str, Any]) -> list[str]:
    """The method beside three that say the same whatever the test."""
    methods = {"diagnosis": {**result["figures"], "label": result["label"]}, **result["baselines"]}
    names = [name for name in BASELINE_FIGURES if name in methods["always_none"]]
    lines = ["| figure | " + " | ".join(m.replace("_", " ") for m in methods) + " |", "|---" * (len(methods) + 1) + "|"]
    for name in names:
        what = "right label, all but pairs, any d'" if name == "label" else FIGURES[name]
        lines.append(f"| {what} | {' | '.join(_cell(m[name]) for m in methods.values())} |")
    return lines


def variants(full: Results, split: str) -> Iterable[tuple[str, list[str]]]:
    """What becomes of the figures without a part of the method, on the cases that both have, by the same code."""
    for name in full.folder.variants():
        other = results(Folder(full.folder.root, name), split)
        same = {
            i: case for i, case in other.cases.items() if i in full.notes and full.notes[i].code == other.notes[i].code
        }
        settings = ", ".join(f"{k} = {v}" for k, v in other.plan.get("settings", {}).items()) or "-"
        lines = [f"Settings: {settings}."]
        if rest := other.cases.keys() - same.keys():
            said = ", ".join(f"`{code[:12]}`" for code in sorted({other.notes[i].code for i in rest}))
            lines.append(
                f"{len(rest)} cases were diagnosed by {said}, and not by the full method: they are not compared."
            )
        yield name, [*lines, "", *(comparison(full.cases, same, full.groups) if same else [])]


def failures(full: Results) -> list[str]:
    """Every reason with its cases; none is dropped."""
    if not full.failures:
        return ["Every case that was run has one."]
    by_reason: dict[tuple[str, str], list[str]] = defaultdict(list)
    for note in full.failures:
        by_reason[note.status, note.message.splitlines()[0] if note.message else ""].append(note.id)
    lines = ["| what became of it | why | cases | |", "|---|---|---|---|"]
    for (status, why), names in sorted(by_reason.items(), key=lambda item: -len(item[1])):
        shown = ", ".join(sorted(names)[:3]) + (", …" if len(names) > 3 else "")
        lines.append(f"| {status} | {why.replace('|', '/')[:200]} | {len(names)} | {shown} |")
    return lines


def write(full: Results, split: str, page: Path) -> dict[str, Any]:
    """Write the page and its picture; all figures as JSON come back."""
    page.parent.mkdir(parents=True, exist_ok=True)
    picture = page.with_name(f"{page.stem}-reliability.svg")
    text, result = document(full, split, picture.name)
    reliability_svg(result["reliability"], picture)
    page.write_text(text, encoding="utf-8")
    return result
