"""Every color of the pages and plots, for light and for dark, in one place."""

from __future__ import annotations

COLOURS: dict[str, tuple[str, str]] = {
    "paper": ("#fbfaf7", "#14171b"),
    "raised": ("#ffffff", "#1c2026"),
    "ink": ("#1b1f24", "#eceae4"),
    "soft": ("#4d5660", "#aeb6c0"),
    "rule": ("#d9d6ce", "#363c45"),
    "grid": ("#e8e5dd", "#282d35"),
    "good": ("#14663f", "#7ddba6"),
    "good-tint": ("#e3f1e8", "#153324"),
    "open": ("#7a4a00", "#f2c46d"),
    "open-tint": ("#fbeed5", "#392b10"),
    "bad": ("#a11d24", "#ff9a97"),
    "bad-tint": ("#fbe3e2", "#421b1d"),
    "accent": ("#0b4f9e", "#8fc1ff"),
    "p_tank": ("#0b5cad", "#6fb4ff"),
    "p_run": ("#b14a07", "#ffab6b"),
    "p_chamber": ("#b3202c", "#ff8087"),
    "p_purge": ("#0f7350", "#55d3a5"),
    "p_fill": ("#5d5a8c", "#b3aee8"),
    "thrust": ("#6a36a8", "#c3a3ff"),
    "m_tank": ("#7b6100", "#e2c655"),
    "C_i": ("#0b5cad", "#6fb4ff"),
    "model": ("#1b1f24", "#eceae4"),
    "residual": ("#1b1f24", "#eceae4"),
    "raw": ("#6b7178", "#959da7"),
    "other": ("#6b7178", "#959da7"),
    "fill": ("#8a94a0", "#8a94a0"),
    "liquid": ("#2f7fd1", "#4b97e6"),
    "vapor": ("#c08a1e", "#d9a53c"),
    "nitrogen": ("#2c9a6d", "#3fbd8b"),
}
"""Name: (light, dark). Inks reach WCAG AA (4.5) on both grounds, lines 3."""

STYLES = ("p_tank", "p_run", "p_chamber", "p_purge", "thrust", "m_tank")
"""The colors that lines without one of their own take, in turn."""


def declarations(dark: bool) -> str:
    """The colors as custom properties of CSS."""
    return " ".join(f"--{name}: {pair[dark]};" for name, pair in COLOURS.items())


def style_of(name: str, number: int = 0) -> str:
    """The color of a channel: its own where it has one, else the next of the row."""
    return name if name in COLOURS else STYLES[number % len(STYLES)]
