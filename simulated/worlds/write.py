"""Tests on disk: raw_tests/ID/{test.toml, log.csv} for the engineer, answers/ID.json kept apart.

python -m simulated.worlds.write DIR [--set quick] [--limit 60]
"""

from __future__ import annotations

import argparse
import json
import os
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from simulated.blind import sensors as se
from simulated.blind import slots as s
from simulated.blind.build import Built
from simulated.blind.effects import EFFECTS, Hidden, drawn, named_shape
from simulated.blind.kernel import STEP
from simulated.blind.plan import Case
from simulated.blind.stand import Histories, Stand
from simulated.blind.write import column, document
from simulated.worlds import engines, laws, loggers, reference
from simulated.worlds.hidden import distorted, observed, sized, to_rivals
from simulated.worlds.plan import SETS, Test, plan

RATES = 30
"""Instants at which a regression rate is written down."""


def write_test(test: Test, root: Path, fade: tuple[float, float] | None = None) -> None:
    """Write one test; the answer comes last, whole, and is what says that the test is there.

    ``fade``: how long what is left burns on and how slowly the chamber turns cold [s], instead of what is drawn.
    """
    rng, logger = np.random.default_rng(test.seed), loggers.LOGGERS[test.logger]
    if test.of_reference:
        world = laws.plain()
    else:
        world = laws.draw(rng if test.laws is None else np.random.default_rng(test.laws))
    if fade is not None:
        world = world.fading(*fade)
    stand = engines.drawn(rng, test.engine, test.end, world)
    with_ = loggers.drawn(rng, logger, stand)
    sizes = [sized(stand, world, drawn(EFFECTS[n], rng), test.target, logger, with_) for n in test.effects]
    case = Case(test.id, test.kind, test.effects, test.target, test.logger, test.seed, test.seed)
    made = fired(rng, case, stand, world, tuple(h for h, _ in sizes), logger, with_, test.of_reference)
    true = made.true
    tables = world.tank_table(), world.gas_table()
    put(made, {
        "id": test.id, "kind": test.kind, "engine": test.engine, "logger": test.logger, "end": test.end,
        "world": test.world,
        "effects": {h.effect.name: {"strength": h.strength, "unit": h.effect.unit, "d_prime": d,
                                    "to_rivals": to_rivals(stand, world, h, logger, with_, tables),
                                    "inside_library": h.effect.inside, "equations": list(h.effect.equations),
                                    "shape": named_shape(h.shape)} for h, d in sizes},
        "laws": world.names, "fade": [float(world.laws[i]) for i in (laws.TAIL, laws.MIXING)],
        "t_v": true.t_v, "t_fuel_out": true.t_fuel_out if np.isfinite(true.t_fuel_out) else None,
        "truth": constants(stand), "run": of_run(stand, true),
    }, root)  # fmt: skip


def constants(stand: Stand) -> dict[str, float]:
    """What a test would find of a stand where its laws are the model's."""
    return {"C_i": stand.C_i, "K_loss": stand.K_loss, "m": stand.m, "a": stand.a, "n": stand.n}


def of_run(stand: Stand, true: Histories) -> dict[str, object]:
    """What a test has whatever its laws are: oxidizer gone and left at the end of the liquid [kg], and regression [m/s]
    by oxidizer flux [kg/(m^2 s)] at some instants of the fire; nothing where the liquid does not end."""
    if not np.isfinite(true.t_v):
        return {}
    left = float(true.trace(s.M_TANK)[int(true.t_v / STEP)])
    radius, flow = true.trace(s.RADIUS), true.trace(s.FLOW)
    flux, rate = flow / (np.pi * radius**2), np.gradient(radius, STEP)
    burnt = min(stand.closing, true.t_fuel_out if np.isfinite(true.t_fuel_out) else np.inf) / STEP
    at = np.linspace(0.05 * burnt, 0.98 * burnt, RATES).astype(int)
    return {
        "gone_at_t_v": stand.mass - left, "left_at_t_v": left,
        "flux": flux[at].tolist(), "rate": rate[at].tolist(),
    }  # fmt: skip


def fired(
    rng: np.random.Generator, case: Case, stand: Stand, world: laws.World, hidden: tuple[Hidden, ...],
    logger: loggers.Logger, with_: loggers.Sensors, of_reference: bool = False,
) -> Built:  # fmt: skip
    """A test as it went, its log, and what was weighed before and after; ``of_reference``: run by that solver."""
    if of_reference:
        true = reference.histories(stand)
        channels = distorted(true, hidden)
    else:
        channels, true = observed(stand, world, hidden, (world.tank_table(), world.gas_table()))
    log = loggers.written(rng, stand, true, channels, logger, with_)
    left = max(stand.fuel_mass - float(true.trace(s.FUEL).sum()) * STEP, 0.0)
    weighed = {"oxidizer_mass": stand.mass + float(rng.normal(0.0, 0.01)),
               "fuel_mass_after": max(left + float(rng.normal(0.0, 0.003)), 0.0)}  # fmt: skip
    return Built(case, stand, _none(), hidden, true, channels, log, {}, weighed)


def put(made: Built, answer: dict[str, object], root: Path, rocket: str = "") -> None:
    """A test's folder, with the section of its ``rocket``; the answer comes last, whole."""
    folder = root / "raw_tests" / made.case.id
    folder.mkdir(parents=True, exist_ok=True)
    lacking = [
        name for name, seen in zip(s.CHANNELS, np.isfinite(made.log.values).any(axis=0), strict=True) if not seen
    ]
    (folder / "test.toml").write_text(_without(_document(made), lacking) + rocket, encoding="utf-8")
    frame = pd.DataFrame({"Time (s)": [f"{t:.4f}" for t in made.log.time]})
    for name in [c for c in s.CHANNELS if c not in lacking]:
        frame[column(name)] = made.log.values[:, s.CHANNELS.index(name)]
    frame.to_csv(folder / "log.csv", index=False, float_format="%.4f", lineterminator="\n")
    path = answer_path(made.case.id, root)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(f".{os.getpid()}.part")
    part.write_text(json.dumps(answer, indent=1), encoding="utf-8")
    os.replace(part, path)


def _document(made: Built) -> str:
    """test.toml, which leaves nothing out where the log ends as the valve closes."""
    before, _, excluded = document(made).partition("[[exclude]]")
    after_closing = float(made.log.time[-1]) > made.log.t_open + made.stand.closing
    return before + "[[exclude]]" + excluded if after_closing else before


def _without(document: str, channels: Sequence[str]) -> str:
    """test.toml without channels that the stand does not have."""
    for name in channels:
        document = re.sub(rf"\[channels\.{name}\]\n(?:[^\n]+\n)+", "", document)
        document = document.replace(f'"{name}", ', "").replace(f', "{name}"', "")
    return document


def _none() -> se.Instruments:
    """No instruments of the blind generator: what is stated in test.toml does not depend on them."""
    return se.Instruments("worlds", (), se.Oscillation(50.0, 5.0, 0.0, 0.0), 0.0, 20.0, 0, 0)


def answer_path(name: str, root: Path) -> Path:
    """Where the answer to a test lies."""
    return root / "answers" / f"{name}.json"


def main() -> None:
    """Write the tests that are not there."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, metavar="DIR")
    parser.add_argument("--set", choices=sorted(SETS), default="quick")
    parser.add_argument("--limit", type=int, default=60)
    given = parser.parse_args()
    for test in plan(given.set, max(given.limit, 60))[: given.limit]:
        if not answer_path(test.id, given.out).is_file():
            write_test(test, given.out)
            print(test.id, test.kind, "+".join(test.effects), test.engine, test.logger, test.end, flush=True)


if __name__ == "__main__":
    main()
