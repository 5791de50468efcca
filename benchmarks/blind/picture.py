"""The reliability diagram as SVG: how often what was stated came true."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path


def reliability_svg(rows: Sequence[dict[str, float]], path: Path) -> None:
    """Draw stated probability against the share that was right, with Wilson's limits; the same bytes every time."""
    import matplotlib

    matplotlib.use("svg")
    from matplotlib import pyplot as plt

    with matplotlib.rc_context({"svg.hashsalt": "blind", "svg.fonttype": "path", "font.size": 9}):
        figure, axes = plt.subplots(figsize=(4.2, 4.0), layout="constrained")
        axes.plot([0, 1], [0, 1], color="0.6", linewidth=1.0)
        stated, right = ([row[key] for row in rows] for key in ("stated", "right"))
        below = [max(row["right"] - row["low"], 0.0) for row in rows]
        above = [max(row["high"] - row["right"], 0.0) for row in rows]
        axes.errorbar(stated, right, yerr=[below, above], fmt="o", markersize=4, capsize=2, color="tab:blue")
        axes.set(xlim=(0, 1.02), ylim=(0, 1.02), xlabel="stated probability", ylabel="share that was right")
        figure.savefig(path, format="svg", metadata={"Date": None, "Creator": None})
        plt.close(figure)
