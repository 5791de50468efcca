"""The pictures of docs/how-it-thinks.md, from HF5's own diagnosis: `make pictures`."""

from __future__ import annotations

import tempfile
from pathlib import Path

import matplotlib as mpl
import numpy as np

import hfanalysis
from hfanalysis.charts.colors import COLORS
from hfanalysis.effects import library
from hfanalysis.products.diagnosis import Diagnosis
from hfanalysis.wording.numbers import people_unit

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

FOLDER = Path(__file__).resolve().parent.parent / "docs"
CHANNELS = {
    "p_tank": "tank pressure", "p_run": "run line pressure", "p_chamber": "chamber pressure", "thrust": "thrust",
    "m_tank": "tank mass", "p_purge": "purge line pressure",
}  # fmt: skip
SHOWN = ("p_tank", "p_chamber")
NAMES = {name: effect.plain_name for name, effect in library().items()}
SOFT, INK, NAMED = (COLORS[name][0] for name in ("other", "ink", "accent"))


def what_is_left(found: hfanalysis.Firing) -> Figure:
    """Measured and modeled, as calibrated; below, what is left beside the noise."""
    figure, panels = plt.subplots(2, 2, figsize=(9.0, 4.4), layout="constrained", sharex="col", height_ratios=(2, 1))
    for (above, below), channel in zip(panels.T, SHOWN, strict=True):
        data = found.residuals[f"full/{channel}"]
        factor, unit = people_unit(data["measured"].attrs["units"])
        time = np.asarray(data["time"])
        measured, model, left, noise = (
            factor * np.asarray(data[name]) for name in ("measured", "model", "residual", "noise_std")
        )
        above.plot(time, measured, color=COLORS[channel][0], linewidth=1.2, label="measured")
        above.plot(time, model, color=INK, linewidth=1.0, linestyle="--", label="model, calibrated")
        above.set_title(f"{CHANNELS[channel]} [{unit}]", fontsize=9, loc="left")
        below.fill_between(time, -2.0 * noise, 2.0 * noise, color=SOFT, alpha=0.4, label="twice the noise")
        below.plot(time, left, color=INK, linewidth=1.0, label="what is left")
        below.set_xlabel("time after the valve opens [s]", fontsize=8)
        for axes in (above, below):
            axes.legend(fontsize=7, frameon=False)
    return figure


def one_at_a_time(found: Diagnosis) -> Figure:
    """What each effect alone makes the data more probable by."""
    alone = sorted((t.log_evidence, NAMES[t.names[0]]) for t in found.tried if len(t.names) == 1 and not t.unknown)
    figure, axes = plt.subplots(figsize=(9.0, 4.2), layout="constrained")
    axes.barh([name for _, name in alone], [max(gain, 0.0) for gain, _ in alone], color=NAMED)
    axes.set_xlabel("log evidence gained over the model without it (3 is odds of 20 to 1)", fontsize=8)
    return figure


def several_together(found: Diagnosis) -> Figure:
    """The best explanation of each number of effects, and the best with an unknown source."""
    best: dict[int, tuple[float, tuple[str, ...]]] = {0: (0.0, ())}
    for tried in found.tried:
        if not tried.unknown:
            best[len(tried.names)] = max(best.get(len(tried.names), (-np.inf, ())), (tried.log_evidence, tried.names))
    rows = [",\n".join(NAMES[n] for n in names) or "nothing" for _, (_, names) in sorted(best.items())]
    gains = [gain for _, (gain, _) in sorted(best.items())]
    if unknown := [t.log_evidence for t in found.tried if t.unknown]:
        rows, gains = [*rows, "the best that has something unknown in it"], [*gains, max(unknown)]
    figure, axes = plt.subplots(
        figsize=(9.0, 0.8 + 0.16 * len(rows) * (1 + max(row.count("\n") for row in rows))), layout="constrained"
    )
    axes.barh(
        rows[::-1],
        [max(gain, 0.0) for gain in gains[::-1]],
        color=[SOFT] * (len(rows) - len(best)) + [NAMED] * len(best),
    )
    axes.set_xlabel("log evidence gained", fontsize=8)
    return figure


def over_time(found: Diagnosis) -> Figure:
    """What each of the named does, over time, with its 90 % band."""
    rows = [p for p in found.localisation if p.history is not None and p.site in NAMES]
    figure, panels = plt.subplots(1, len(rows), figsize=(3.0 * len(rows), 2.6), layout="constrained", squeeze=False)
    for axes, row in zip(panels[0], rows, strict=True):
        assert row.history is not None
        time, mean, low, high = (np.asarray(v, dtype=float) for v in (
            row.history.time, row.history.mean, row.history.low90, row.history.high90
        ))  # fmt: skip
        factor, unit = people_unit(row.history.unit)
        axes.fill_between(time, factor * low, factor * high, color=NAMED, alpha=0.3)
        axes.plot(time, factor * mean, color=NAMED, linewidth=1.2)
        axes.set_title(f"{NAMES[row.site]} [{unit}]", fontsize=8, loc="left")
        axes.set_xlabel("time after the valve opens [s]", fontsize=7)
    return figure


def the_gap(found: Diagnosis) -> Figure:
    """How far the model is off, by channel: calibrated, refitted, with what was named; and the noise."""
    gap = found.gap
    kinds = {
        "calibrated": gap.calibrated, "refitted": gap.before, "with what was named": gap.after, "noise": gap.noise,
    }  # fmt: skip
    colors = (COLORS["rule"][0], SOFT, NAMED, INK)
    channels = [c for c in CHANNELS if c in gap.noise]
    figure, axes = plt.subplots(figsize=(9.0, 3.0), layout="constrained")
    for i, ((label, sizes), color) in enumerate(zip(kinds.items(), colors, strict=True)):
        if sizes is not None:
            heights = [sizes.get(c, np.nan) / gap.noise[c] for c in channels]
            axes.bar(np.arange(len(channels)) + 0.2 * (i - 1.5), heights, 0.18, label=label, color=color)
    axes.set_yscale("log")
    axes.set_xticks(range(len(channels)), [CHANNELS[c] for c in channels], fontsize=8)
    axes.set_ylabel("rms in units of the noise", fontsize=8)
    axes.legend(fontsize=8, frameon=False, ncols=4, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    return figure


def plain(axes: Axes) -> None:
    """Without what says nothing."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8)


def main() -> None:
    """All five, from a diagnosis made anew in a folder of its own."""
    with tempfile.TemporaryDirectory() as out:
        firing = hfanalysis.open("HF5", FOLDER.parent, out).run(to="diagnose")
        found = firing.diagnosis
        figures = [
            what_is_left(firing),
            one_at_a_time(found),
            several_together(found),
            over_time(found),
            the_gap(found),
        ]
        for number, figure in enumerate(figures, start=1):
            for axes in figure.axes:
                plain(axes)
            figure.savefig(FOLDER / f"how-it-thinks-{number}.png", dpi=80, metadata={"Software": None})


if __name__ == "__main__":
    main()
