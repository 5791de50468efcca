"""Writes the list of the library in docs/effects.md and a page per effect, from the library itself: `make readme`."""

from __future__ import annotations

from math import isfinite
from pathlib import Path

from pipeline.effects_pictures import shown

from hfanalysis.effects import library
from hfanalysis.engine.effect import EQUATIONS, Effect, Parameter

PAGE = Path(__file__).resolve().parent.parent / "docs" / "effects.md"
FOLDER = PAGE.parent / "effects"
BEGIN, END = "<!-- library (written by `make readme`) -->\n", "<!-- end of library -->"


def main() -> None:
    PAGE.write_text(anew(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    for name, page in pages().items():
        (FOLDER / f"{name}.md").write_text(page, encoding="utf-8")


def pages() -> dict[str, str]:
    """The page of every effect, by its name."""
    return {e.name: _effect(e) for e in library().values()}


def anew(page: str) -> str:
    """The page with its part about the library as the library is now."""
    before, rest = page.split(BEGIN)
    return before + BEGIN + "\n" + _library() + "\n" + END + rest.split(END)[1]


def _library() -> str:
    found = sorted(library().values(), key=lambda e: (EQUATIONS.index(e.equation), e.name))
    lines = ["| effect | in plain words | equation | what it says |", "|---|---|---|---|"]
    lines += [f"| [`{e.name}`](effects/{e.name}.md) | {e.plain_name} | {e.equation} | {e.meaning} |" for e in found]
    return "\n".join(lines) + "\n"


def _effect(e: Effect) -> str:
    lines = [
        f"# {e.plain_name[0].upper()}{e.plain_name[1:]}: `{e.name}`\n",
        f"{e.meaning[0].upper()}{e.meaning[1:]}.\n",
        f"    {e.formula}\n",
        f"![What the sensors read with it, and dashed without]({e.name}.png)\n",
        f"A simulated test with {_size(e)} (in color) and without the effect (dashed).\n",
        f"Equation: {e.equation}. Values are SI; a strength is bold; a prior reads *center ± standard deviation*.\n",
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


def _size(e: Effect) -> str:
    """The size that its picture shows."""
    sizes = shown(e).named
    units = {p.name: "" if p.unit == "-" else f" {p.unit}" for p in e.parameters}
    return " and ".join(f"{p.name} {sizes[p.name]:.3g}{units[p.name]}" for p in e.parameters[: e.strengths])


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
