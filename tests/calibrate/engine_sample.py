"""An engine on paper and the evidence that its burn gives about a and n."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from math import pi
from typing import Any

import numpy as np

from hfanalysis.assembly.calibrated import Regression
from hfanalysis.assembly.burnt_gas import combustion_of
from hfanalysis.calibrate.evidence import NUISANCES, Evidence, Scalar, chamber_at
from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.engine.unsteady import Engine, burn
from hfanalysis.thermo.combustion import PROPEP_OXIDIZER_ENTHALPY
from hfanalysis.thermo.nitrous import saturation

TRUTH = Regression(1e-4, 0.5)


@lru_cache(maxsize=1)
def engine() -> Engine:
    """A stand's engine of 15 bar that burns for some 8 s, 6 of them on liquid."""
    return Engine(
        saturation=saturation("coolprop"),
        combustion=combustion_of(),
        feed=FeedSystem(16.5e-3, 2.4e-5, 2e8),
        oxidizer_mass=10.0,
        temperature=291.0,
        polytropic_exponent=1.12,
        fuel_mass=1.6,
        grain_length=0.6,
        outer_radius=40e-3,
        fuel_density=900.0,
        a=TRUTH.a,
        n=TRUTH.n,
        dead_volume=1.1e-3,
        throat_area=pi * 22e-3**2,
        exit_area=pi * 36e-3**2,
        ambient_pressure=101_130.0,
        oxidizer_enthalpy=PROPEP_OXIDIZER_ENTHALPY,
    )


def evidence(
    truth: Regression = TRUTH,
    noise: float = 0.02e5,
    burn_time_std: float = 0.05,
    start: float = 0.5,
    stop: float | None = None,
    nuisance: dict[str, float] | None = None,
    **change: Any,
) -> Evidence:
    """What the engine's burn with true constants tells; ``nuisance``: standard deviations of what is known of it."""
    lit = replace(engine(), a=truth.a, n=truth.n, **change)
    burnt = burn(lit)
    assert burnt.liquid_out is not None
    time = np.linspace(start, stop or burnt.liquid_out - 0.2, 100)
    pressure = chamber_at(lit, burnt, time) + noise * np.random.default_rng(3).standard_normal(time.size)
    seen = Scalar(burnt.burn_time, burn_time_std, "video") if burnt.fuel_out else None
    std = np.array([(nuisance or {}).get(name, 0.0) for name in NUISANCES])
    anchor = (start, float(np.interp(start, burnt.time, burnt.output("tank_pressure"))))
    return Evidence(
        "T", replace(lit, a=1e-3, n=0.0), time, pressure, seen, None, burnt.burn_time, anchor, np.diag(std**2), noise,
        np.zeros((time.size, time.size)),
    )  # fmt: skip


def rate(law: Regression, flux: float) -> float:
    """r = a G^n [m/s]."""
    return float(law.a * flux**law.n)
