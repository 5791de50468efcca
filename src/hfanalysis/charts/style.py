"""The style sheet, with the colors put in."""

from __future__ import annotations

import functools
from importlib.resources import files

from markupsafe import Markup

from hfanalysis.charts.colours import declarations


@functools.cache
def sheet() -> Markup:
    """The style sheet of pages and of plots that stand by themselves: light, dark by preference or choice, print."""
    text = (files("hfanalysis.charts") / "style.css").read_text(encoding="utf-8")
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
