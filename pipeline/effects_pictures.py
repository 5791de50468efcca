"""A picture of every effect: what the sensors of a stand read with it, over what they read without: `make pictures`."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from simulated.engines import engine_on_stand

from hfanalysis.arrays import Array
from hfanalysis.charts.colors import COLORS
from hfanalysis.effects import library
from hfanalysis.engine.effect import Active, Effect
from hfanalysis.engine.observe import observe
from hfanalysis.engine.unsteady import burn

mpl.use("Agg")
import matplotlib.pyplot as plt

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "effects"
SECONDS = 10.0
TIMES = 2.0
"""The size shown of a strength with a unit, as part of what is typical: large enough to be seen. One without is a share
and shown at its typical size."""

PANELS = {
    "p_tank": ("tank pressure [bar]", 1e-5),
    "p_run": ("run line pressure [bar]", 1e-5),
    "p_chamber": ("chamber pressure [bar]", 1e-5),
    "thrust": ("thrust [kN]", 1e-3),
}


def shown(effect: Effect) -> Active:
    """The effect at the size that is shown, within its bounds."""
    strengths = effect.parameters[: effect.strengths]
    sizes = {p.name: p.typical * (1.0 if p.unit == "-" else TIMES) for p in strengths}
    return effect.at(**{p.name: float(np.clip(sizes[p.name], p.low, p.high)) for p in strengths})


def read(*effects: Active) -> tuple[Array, dict[str, Array]]:
    """Times [s] from the opening to the end of a burn, and what the channels read then [SI]."""
    done = burn(engine_on_stand(effects=effects), SECONDS, run_on=True)
    end = min(done.burn_time + 0.5, SECONDS) if done.burn_time else SECONDS
    times = np.linspace(0.0, end, 1200)
    return times, observe(done, times)


def draw(effect: Effect) -> None:
    """One picture, four panels."""
    (time, plain), (later, changed) = read(), read(shown(effect))
    figure, panels = plt.subplots(1, 4, figsize=(11.0, 2.5), layout="constrained")
    for axes, (channel, (label, factor)) in zip(panels, PANELS.items(), strict=True):
        axes.plot(time, factor * plain[channel], color=COLORS["other"][0], linewidth=1.0, linestyle="--")
        axes.plot(later, factor * changed[channel], color=COLORS[channel][0], linewidth=1.3)
        axes.set_title(label, fontsize=8, loc="left")
        axes.tick_params(labelsize=7)
        axes.set_xlabel("time after the valve opens [s]", fontsize=7)
        axes.set_ylim(bottom=0.0)
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(FOLDER / f"{effect.name}.png", dpi=80, metadata={"Software": None})
    plt.close(figure)


def main() -> None:
    """All of them."""
    FOLDER.mkdir(exist_ok=True)
    for effect in library().values():
        draw(effect)


if __name__ == "__main__":
    main()
