"""The style sheets: of pages, with the colors put in, and of plots that stand by themselves."""

from __future__ import annotations

import functools
import re
from importlib.resources import files

from markupsafe import Markup

from hfanalysis.charts.colors import COLORS, declarations


@functools.cache
def sheet() -> Markup:
    """The style sheet of pages: light, dark by preference or choice, print."""
    text = _stated()
    light, dark = declarations(dark=False), declarations(dark=True)
    every = ":root, :root:not([data-theme=light]), :root[data-theme=dark]"
    return Markup(
        f":root {{ color-scheme: light dark; {light} }}\n"
        f"@media (prefers-color-scheme: dark) {{ :root:not([data-theme=light]) {{ {dark} }} }}\n"
        f":root[data-theme=light] {{ color-scheme: light; }}\n"
        f":root[data-theme=dark] {{ color-scheme: dark; {dark} }}\n"
        f"@media print {{ {every} {{ {light} --paper: #ffffff; }} }}\n"
        f"{text}"
    )


_RULE = re.compile(r"([^{}]+)\{([^{}]*)\}")
_OWN = re.compile(r"--c:\s*var\(--([\w-]+)\)")
_COLOR = re.compile(r"var\(--(?:c, var\(--)?([\w-]+)\)?\)")


@functools.cache
def alone() -> Markup:
    """The style sheet of a plot that stands by itself: the rules of charts in the light colors themselves, for programs
    that know no variables of style sheets (rsvg, Inkscape)."""
    rules, own = [], []
    part = _stated().partition("/* charts: begin */")[2].partition("/* charts: end */")[0]
    for selectors, body in _RULE.findall(part):
        if (color := _OWN.search(body)) is not None:
            shade = COLORS[color[1]][0]
            for name in (selector.strip() for selector in selectors.split(",")):
                own.append(f".line{name}, .level{name} {{ stroke: {shade}; }} .band{name} {{ fill: {shade}; }}")
        elif not selectors.strip().startswith(".alive"):
            rules.append(f"{selectors.strip()} {{{_COLOR.sub(lambda found: COLORS[found[1]][0], body)}}}")
    return Markup("\n".join(["svg { font-family: system-ui, sans-serif; }", *rules, *own]))


def _stated() -> str:
    return (files("hfanalysis.charts") / "style.css").read_text(encoding="utf-8")


def ground(width: float, height: float) -> Markup:
    """What a plot that stands by itself is drawn on."""
    return Markup(f'<rect width="{width:.0f}" height="{height:.0f}" fill="{COLORS["paper"][0]}"/>')
