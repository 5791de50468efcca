"""A made-up diagnosis as its stage writes it: tank heat that is named, with every part the page shows."""

from __future__ import annotations

from typing import Any

import numpy as np

from hfanalysis.effects import library
from hfanalysis.report.material import Store, StoredVariable


def _quantity(value: float, unit: str, std: float | None) -> dict[str, Any]:
    return {"value": value, "unit": unit, "std": std, "ci95": [0.0, 2.0 * value]}


def _history(unit: str, mean: Any, std: float) -> dict[str, Any]:
    time = np.linspace(0.0, 16.0, 60)
    values = np.broadcast_to(mean(time), time.shape)
    low, high = values - 1.6449 * std, values + 1.6449 * std
    return {"unit": unit, "time": list(time), "mean": list(values), "low90": list(low), "high90": list(high)}


def _weak(unit: str, level: float, **more: Any) -> dict[str, Any]:
    history = _history(unit, lambda t: level * np.exp(-t / 9.0), 0.1 * abs(level))
    return {
        "unit": unit,
        **{name: history[name] for name in ("time", "low90", "high90")},
        "value": history["mean"],
        "explained": [0.0] * 60,
        "phase": "liquid",
        "t_start": _quantity(0.4, "s", 0.2),
        "t_end": _quantity(5.2, "s", 0.2),
        "mean": _quantity(level, unit, 0.1 * abs(level)),
        "significance": {"chi_square": 166.0, "degrees_of_freedom": 20},
        **more,
    }


_NOWHERE = {"value": None, "reason": "nowhere beyond two standard deviations"}
_SIZE = {"size": "0.9 kW", "plausible": True, "why": "power 0.9 kW (limit 3 kW)"}

DIAGNOSIS: dict[str, Any] = {
    "verdict": "named",
    "effects": [
        {
            "name": "tank_heat",
            "probability": 0.83,
            "equation": "tank_energy",
            "meaning": "heat into the oxidizer",
            "parameters": {"power": _quantity(900.0, "W", 150.0), "lag": _quantity(0.12, "s", 0.1)},
            "plausibility": _SIZE,
        }
    ],
    "set90": ["tank_heat", "tank_wall_heat_capacity"],
    "posterior": {
        "none": 1e-30,
        "tank_heat": 0.83,
        "tank_wall_heat_capacity": 0.15,
        "unknown": 0.02,
        "fuel_sliver": 1e-9,
        "n2_purge": 1e-9,
    },
    "localisation": [
        {
            "equation": "tank_energy",
            "site": "tank_heat",
            "phase": "liquid",
            "t_start": _quantity(0.4, "s", 0.1),
            "t_end": _quantity(6.2, "s", 0.1),
            "source": _quantity(900.0, "W", 150.0),
            "channel": None,
            "significance": 61.7,
            "history": _history("W", lambda t: 900.0 + 0.0 * t, 150.0),
        }
    ],
    "gap": {
        "before": {"p_tank": 9e4, "thrust": 20.0},
        "after": {"p_tank": 1e4, "thrust": 12.0},
        "noise": {"p_tank": 8e3, "thrust": 11.0},
        "by_phase": {
            "before": {"p_tank": {"liquid": 9.1e4}, "thrust": {"liquid": 15.0}},
            "after": {"p_tank": {"liquid": 5e3}, "thrust": {"liquid": 0.0}},
        },
        "closed_fraction": {"same": 0.93, "held_out": 0.88, "other_test": None, "placebo": -0.2},
        "closed_by_free_form": 0.95,
        "other_test": None,
    },
    "upper_limits": {
        "nozzle_throat_erosion": _quantity(7.5e-5, "m/s", None),
        "tank_leak": _quantity(0.003, "kg/s", None),
        "pressure_transducer_offset": _quantity(72936.1, "Pa", None),
        "tank_wall_heat_capacity": _quantity(24521.7, "J/K", None),
    },
    "twins": [["tank_heat", "tank_wall_heat_capacity"]],
    "not_it": ["fuel_sliver", "n2_purge"],
    "decisive_measurements": ["heat into the tank: a thermocouple on the tank's wall"],
    "plausibility": {
        "tank_heat": _SIZE,
        "tank_wall_heat_capacity": {"size": "90 kJ/K", "plausible": False, "why": "that is 100 kg of aluminum"},
    },
    "constants": {
        "without": {"area": _quantity(1.97e-5, "m^2", 1e-7), "m": _quantity(0.746, "", 0.01)},
        "with": {"area": _quantity(1.96e-5, "m^2", 1e-7), "m": _quantity(1.084, "", 0.01)},
    },
    "weak_form": {
        "tank_energy": _weak("W", 900.0),
        "feed": _weak("bar", 0.1, mean=_NOWHERE, t_start=_NOWHERE, t_end=_NOWHERE, phase=None),
        "nozzle": {"unit": "N", "reason": "the log has no thrust"},
    },
    "compared": {"channels": ["p_tank", "thrust"], "start": 0.07, "end": 12.3},
    "probabilities_from": "raw evidences",
    "notes": ["there is no other test of this stand to prove it on"],
    "warnings": [],
    "sentences": [
        "Missing from the model, with probability: heat into the tank (0.83).",
        "From 0.4 s to 6.2 s 0.90 ± 0.15 kW of heat enters the tank that the model does not have.",
        "Run tank pressure misfit: 0.9 bar refitted, 0.1 bar with the effects; noise 0.08 bar.",
    ],
    "quoted": {f"{size} bar": {"value": 1e5 * size, "unit": "Pa", "std": None} for size in (0.9, 0.1, 0.08)},
    "called": {name: effect.plain_name for name, effect in library().items()},
    "provenance": {"hfanalysis": "0.1.0"},
}

NOTHING: dict[str, Any] = {
    **DIAGNOSIS,
    "verdict": "none",
    "effects": [],
    "set90": ["none"],
    "posterior": {"none": 0.97, "tank_heat": 0.02, "unknown": 0.01},
    "localisation": [],
    "gap": {
        **DIAGNOSIS["gap"],
        "after": DIAGNOSIS["gap"]["before"],
        "closed_fraction": {"same": None, "held_out": None, "other_test": None, "placebo": None},
        "closed_by_free_form": None,
    },
    "twins": [],
    "decisive_measurements": [],
    "sentences": ["Nothing is missing from the model that these channels can show (none 0.97)."],
}


def store() -> Store:
    """diagnosis.h5: the residual of every channel, without and with what is named."""
    return {"residuals/p_tank": _left(9e4, "Pa"), "residuals/thrust": _left(20.0, "N")}


def _left(level: float, unit: str) -> dict[str, StoredVariable]:
    time = np.linspace(0.1, 16.0, 200)
    wave = np.sin(time)
    noise = np.full(time.size, 0.1 * level)
    columns = {"before": level * wave, "after": 0.1 * level * wave, "noise_std": noise}
    return {
        "time": StoredVariable(time, "s"),
        **{name: StoredVariable(values, unit) for name, values in columns.items()},
    }
