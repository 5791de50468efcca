"""Writes the part of docs/effects.md that describes the library, from the library itself: `make readme`."""

from __future__ import annotations

from math import isfinite
from pathlib import Path

from hfanalysis.effects import library
from hfanalysis.engine.effect import EQUATIONS, Effect, Parameter

PAGE = Path(__file__).resolve().parent.parent / "docs" / "effects.md"
BEGIN, END = "<!-- library (written by `make readme`) -->\n", "<!-- end of library -->"


def main() -> None:
    PAGE.write_text(anew(PAGE.read_text(encoding="utf-8")), encoding="utf-8")


def anew(page: str) -> str:
    """The page with its part about the library as the library is now."""
    before, rest = page.split(BEGIN)
    return before + BEGIN + "\n" + _library() + "\n" + END + rest.split(END)[1]


def _library() -> str:
    found = sorted(library().values(), key=lambda e: (EQUATIONS.index(e.equation), e.name))
    lines = ["| effect | in plain words | equation | what it says |", "|---|---|---|---|"]
    lines += [f"| [`{e.name}`](#{e.name}) | {e.plain_name} | {e.equation} | {e.meaning} |" for e in found]
    return "\n".join(lines) + "\n\n" + "\n".join(_effect(e) for e in found)


def _effect(e: Effect) -> str:
    lines = [
        f"### {e.name}\n",
        f"{e.meaning[0].upper()}{e.meaning[1:]}.\n",
        f"    {e.formula}\n",
        "| parameter | unit | | prior | bounds |",
        "|---|---|---|---|---|",
        *(_parameter(p, k < e.strengths) for k, p in enumerate(e.parameters)),
        "",
        f"Acts on {_words(e.sites)}, in {_words(e.phases)}."
        + (f" States of its own: {_words(tuple(f'{s.name} [{s.unit}]' for s in e.states))}." if e.states else "")
        + (f" Twins: {_words(e.twins)}." if e.twins else "")
        + f" Decided by: {e.decisive}."
        + _believable(e),
        f"\nSource: {e.reference}.\n",
    ]
    return "\n".join(lines)


def _believable(e: Effect) -> str:
    limit = e.believable
    if limit is None:
        return ""
    return f" Believable: `{limit.parameter}` up to {limit.text(limit.most)} ({limit.why})."


def _parameter(p: Parameter, strength: bool) -> str:
    name = f"**`{p.name}`**" if strength else f"`{p.name}`"
    prior = "given by the test, else " if p.given else ""
    low, high = (f"{bound:g}" if isfinite(bound) else "–" for bound in (p.low, p.high))
    return f"| {name} | {p.unit} | {p.meaning} | {prior}{p.center:g} ± {p.typical:g} | {low} to {high} |"


def _words(names: tuple[str, ...]) -> str:
    return ", ".join(f"`{name}`" for name in names)


if __name__ == "__main__":
    main()
