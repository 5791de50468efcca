"""A made-up test with every product the page can show, small enough to be made in a moment."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from tests.products.filled import filled
from tests.report.diagnosed import DIAGNOSIS
from tests.report.diagnosed import store as diagnosed_store

from hfanalysis.products.kinds import KINDS
from hfanalysis.record.definition import load_definition
from hfanalysis.record.log import Channel, TestLog
from hfanalysis.record.summary import summary
from hfanalysis.report.material import Material, Store, StoredVariable

TOML = """\
schema = 1
[test]
id = "{id}"
kind = "hot_fire"
date = 2024-05-17
source = "{source}"
description = {description}
[log]
files = ["log.csv"]
time = {{ column = "time", unit = "s" }}
[channels.p_tank]
column = {column}
unit = "bar"
"""


def quantity(value: float, unit: str, std: float, **more: Any) -> dict[str, Any]:
    """A quantity as products state it."""
    return {"value": value, "unit": unit, "std": std, "ci95": [value - 1.96 * std, value + 1.96 * std], **more}


def definition(folder: Path, **text: str) -> Any:
    """A test.toml on disk, loaded; texts are put in as TOML strings, unescaped."""
    words = {"source": "replica", "description": '"made up"', "column": '"p_tank"', **text}
    path = folder / "HF0" / "test.toml"
    path.parent.mkdir(parents=True, exist_ok=True)
    (path.parent / "log.csv").write_text("time,p_tank\n0,1\n1,2\n")
    path.write_text(TOML.format(id="HF0", **words), encoding="utf-8")
    return load_definition(path)


def channel(name: str, unit: str, values: Any, label: str | None = None, **more: Any) -> Channel:
    """A channel at 200 Hz from -3 to 20 s after an opening at 100 s, with a few dropped samples."""
    time = np.arange(-3.0, 20.0, 0.005)
    noise = np.random.default_rng(1).normal(0.0, 0.01, time.size)
    signal = np.asarray(values(time) * (1.0 + noise))
    flags = np.zeros(time.size, np.uint8)
    flags[1000:1010] = 1
    return Channel(name, unit, time + 100.0, signal, flags, 1e4, True, label or name, **more)


def log(label: str | None = None) -> TestLog:
    """Pressures, thrust and tank mass of a plausible firing."""
    on = lambda t: 1.0 / (1.0 + np.exp(-30.0 * t))  # noqa: E731
    thrust = channel("thrust", "N", lambda t: 2400.0 * on(t) * np.exp(-np.maximum(t, 0.0) / 9.0))
    thrust = Channel(**{**vars(thrust), "raw": thrust.values + 40.0, "zero": 40.0, "zero_std": 1.0, "drift": 12.0})
    made = [
        channel("p_tank", "Pa", lambda t: 6.5e6 * np.exp(-np.maximum(t, 0.0) / 14.0), label),
        channel("p_run", "Pa", lambda t: 1e5 + 4.2e6 * on(t) * np.exp(-np.maximum(t, 0.0) / 13.0)),
        channel("p_chamber", "Pa", lambda t: 1e5 + 1.3e6 * on(t) * np.exp(-np.maximum(t, 0.0) / 9.0)),
        channel("p_purge", "Pa", lambda t: 3.9e6 - 1e4 * t),
        thrust,
        channel("m_tank", "kg", lambda t: 8.35 - np.clip(t, 0.0, 6.0) * 1.3),
    ]
    return TestLog({item.name: item for item in made}, ("channel p_run: 10 of 4600 samples flagged dropout",))


SEGMENTS: dict[str, Any] = {
    "kind": "hot_fire",
    "t_open": quantity(100.0, "s", 0.002),
    "t_feed": quantity(0.87, "s", 0.02),
    "t_v": quantity(5.271, "s", 0.006),
    "t_purge": quantity(5.99, "s", 0.011, why="slope of the purge line"),
    "t_fuel_out": {"value": None, "reason": "no common fall of chamber pressure and thrust"},
    "t_fuel_gone": {"value": None, "reason": "no common fall of chamber pressure and thrust"},
    "firings": [],
    "t_end": quantity(17.0, "s", 0.05),
    "engineer": ["t_end"],
    "notes": [],
    "warnings": [],
    "provenance": {"hfanalysis": "0.1.0", "raw": {"log.csv": "ab" * 32}},
}

_TIME = np.linspace(0.9, 5.2, 120)

CALIBRATION: dict[str, Any] = {
    "C_i": quantity(0.2931, "", 0.0034, verdict="identified"),
    "m": quantity(-3.1, "", 0.4, verdict="unphysical", why="needs 14 kW of heat"),
    "Z": {"value": None, "reason": "the vapor phase lasts 0.05 s", "verdict": "not identifiable"},
    "a": quantity(1.32e-4, "m/s (kg/m^2/s)^-n", 3e-5, verdict="not identifiable", why="only with n"),
    "n": quantity(0.55, "", 0.12, verdict="not identifiable", why="only with a"),
    "regression_rate_reference": quantity(1.05e-3, "m/s", 2e-5, verdict="identified"),
    "K_loss": quantity(6.371e8, "1/m^4", 2.1e7, verdict="identified"),
    "p_loss_liquid": quantity(11.43e5, "Pa", 0.12e5, verdict="identified"),
    "rest": {"temperature": quantity(293.4, "K", 0.3), "remarks": ["pressure and mass fit a saturated tank"]},
    "tank_history": {
        "time": list(_TIME),
        "liquid": list(150.0 - 25.0 * _TIME),
        "vapor": list(30.0 + 2.0 * _TIME),
        "flow": list(1.3 - 0.02 * _TIME),
    },
    "C_i_history": {"time": list(_TIME), "value": list(0.29 + 0.002 * _TIME), "std": [0.004] * _TIME.size},
    "inlet": {
        "subcooling": quantity(-11.4, "K", 0.2, verdict="derived"),
        "quality": quantity(0.133, "", 0.002, verdict="derived", why="isenthalpic from the tank's liquid to p_run"),
        "density": quantity(439.0, "kg/m^3", 4.0, verdict="derived"),
    },
    "C_d": {"hem": quantity(0.91, "", 0.05, verdict="derived", why="homogeneous equilibrium")},
    "warnings": ["the purge check valve opens before the liquid is gone"],
    "provenance": {"hfanalysis": "0.1.0", "raw": {"log.csv": "ab" * 32}, "parameters": {}},
}


def _gap(rms: float, unit: str) -> dict[str, Any]:
    return {"rms": rms, "bias": -0.5 * rms, "noise": 0.1 * rms, "samples": 900, "unit": unit}


VALIDATION: dict[str, Any] = {
    "performance": {
        "measured": {
            "burn_time": quantity(12.4, "s", 0.1),
            "total_impulse": quantity(18_340.0, "N s", 60.0),
            "peak_chamber_pressure": quantity(13.2e5, "Pa", 0.1e5),
            "peak_thrust": quantity(2430.0, "N", 15.0),
            "fuel_mass": {"value": None, "reason": "the grain was not weighed after the firing"},
        },
        "model": {"burn_time": quantity(12.9, "s", 0.2), "peak_thrust": quantity(2500.0, "N", 40.0)},
    },
    "gap": {"full": {"thrust": {"liquid": _gap(40.0, "N")}}, "tank_free": {"p_tank": {"liquid": _gap(5e4, "Pa")}}},
    "closure": {"oxidizer_loaded": quantity(8.35, "kg", 0.05), "fuel_burned": quantity(1.6, "kg", 0.02, why="by a, n")},
    "absent": {},
    "warnings": [],
    "provenance": {"hfanalysis": "0.1.0", "parameters": {"modes": "all"}},
}

_SHIFT = {
    "kind": "zero",
    "channels": ["thrust"],
    "verdict": "suspect",
    "evidence": "reads 76 N after the firing and 0 N before it",
    "means": "its zero moved while it fired",
    "cure": None,
}
_SCALE = {
    "kind": "scale",
    "channels": ["thrust", "p_chamber"],
    "verdict": "suspect",
    "evidence": "F/(p_c A_t) is 0.6",
    "means": "thrust or p_chamber is off by a factor of 1.6 to 3.1",
    "cure": None,
}
HEALTH: dict[str, Any] = {
    "channels": {
        "thrust": {"verdict": "suspect", "findings": [_SHIFT, _SCALE]},
        "p_chamber": {"verdict": "suspect", "findings": [_SCALE]},
        "p_tank": {"verdict": "healthy", "findings": []},
    },
    "between": [_SCALE],
    "warnings": [],
    "quoted": {words: {"value": float(words[:-2]), "unit": "N", "std": None} for words in ("76 N", "0 N")},
    "provenance": {"hfanalysis": "0.1.0"},
}
"""A thrust cell that does not come back, and a chamber pressure that does not fit the thrust."""


def _residual(level: float, unit: str) -> dict[str, StoredVariable]:
    """A misfit of one per cent on noise of a tenth of that."""
    time = np.linspace(-1.0, 17.0, 1800)
    model = level * np.exp(-np.maximum(time, 0.0) / 14.0)
    residual = 0.01 * level * np.sin(time)
    noise = np.full(time.size, 0.001 * level)
    named = {"measured": model + residual, "model": model, "residual": residual, "noise_std": noise}
    return {"time": StoredVariable(time, "s"), **{name: StoredVariable(values, unit) for name, values in named.items()}}


def _performance() -> dict[str, StoredVariable]:
    time = np.linspace(0.1, 12.0, 400)
    fall = np.exp(-time / 9.0)
    return {
        "time": StoredVariable(time, "s"),
        "oxidizer_flow": StoredVariable(1.3 * fall, "kg/s"),
        "fuel_flow": StoredVariable(0.2 * fall**0.5, "kg/s"),
        "of_ratio": StoredVariable(6.5 * fall**0.5, ""),
        "regression_rate": StoredVariable(1.1e-3 * fall**0.5, "m/s"),
        "c_star": StoredVariable(1500.0 + 20.0 * time, "m/s"),
        "c_star_efficiency": StoredVariable(0.93 + 0.001 * time, ""),
        "thrust_coefficient_efficiency": StoredVariable(0.97 - 0.001 * time, ""),
    }


FLIGHT: dict[str, Any] = {
    "apogee": quantity(2815.0, "m", 74.0),
    "peak_mach": quantity(0.56, "", 0.004),
    "checks": {
        "rail_departure_velocity": {
            "limit": 30.48,
            "unit": "m/s",
            "is": "at least",
            "result": "failed",
            "why": "20 m/s",
        }
    },
    "rail_departure_velocity": quantity(20.0, "m/s", 0.05),
    "burn_time": quantity(12.4, "s", 0.1),
    "stability": {
        "margin_at_rail_departure": quantity(1.9, "", 0.1),
        "limits": [1.5, 6.0],
        "gust_intensity": 0.1,
        "winds": [{"wind": 2.235, "result": "passed"}, {"wind": 6.706, "result": "failed"}],
    },
    "notes": ["burn from the opening to 17.00 s"],
    "warnings": [],
}


def _flight() -> Store:
    time = np.linspace(0.0, 27.0, 300)
    height = 2815.0 * (1.0 - (time / 27.0 - 1.0) ** 2)
    speed = np.minimum(40.0 * time, 208.0 * (1.0 - time / 27.0))
    ascent = {
        "time": StoredVariable(time, "s"),
        "height": StoredVariable(height, "m"),
        "speed": StoredVariable(speed, "m/s"),
    }
    bands = {
        "time": StoredVariable(time, "s"),
        "height_low": StoredVariable(0.95 * height),
        "height_high": StoredVariable(1.05 * height),
    }
    return {"ascent": ascent, "bands": bands, "stability/0": _margin(1.9), "stability/1": _margin(1.2)}


def _margin(start: float) -> dict[str, StoredVariable]:
    """A margin that grows from the rail's end on, the better known the faster the rocket."""
    time = np.linspace(0.6, 25.0, 300)
    fade = np.exp(-(time - 0.6) / 2.0)
    mean, std = 4.0 + (start - 4.0) * fade, 0.05 + 0.2 * fade
    return {
        "time": StoredVariable(time, "s"),
        "margin_mean": StoredVariable(mean, "1"),
        "margin_std": StoredVariable(std, "1"),
    }


def stores() -> dict[str, Store]:
    """The HDF5 products: residuals of all modes, and the performance over time."""
    groups = {
        "tank_free/p_tank": _residual(6.5e6, "Pa"),
        "chamber_forced/thrust": _residual(2400.0, "N"),
        "full/p_chamber": _residual(1.3e6, "Pa"),
        "full/thrust": _residual(2400.0, "N"),
    }
    return {
        "residuals": groups,
        "performance": {"": _performance()},
        "flight": _flight(),
        "diagnosis": diagnosed_store(),
    }


def material(folder: Path, label: str | None = None, **text: str) -> Material:
    """All of it."""
    made = log(label)
    products = {"segments": SEGMENTS, "calibration": CALIBRATION, "validation": VALIDATION}
    bare = Material(definition(folder, **text), made, {"ingest": summary(made)}, stores())
    return saying(bare, **products, flight=FLIGHT, diagnosis=DIAGNOSIS)


def saying(made: Material, **products: Any) -> Material:
    """The material with other products, by name, as their JSON has them."""
    models = {name: filled(KINDS[f"{name}.json"], data) for name, data in products.items()}
    return replace(made, products={**made.products, **models})


def without(made: Material, *names: str, **reasons: str) -> Material:
    """The material with products left out, for reasons."""
    gone = {*names, *reasons}
    products = {name: product for name, product in made.products.items() if name not in gone}
    kept = {name: store for name, store in made.stores.items() if name not in gone}
    return replace(made, products=products, stores=kept, absent=reasons)
