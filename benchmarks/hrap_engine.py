"""One engine in HRAP, timed: run by ``hrap_run.py`` with the Python of an environment that has HRAP.

Reads the engine and the chemistry as JSON from standard input, writes the times as JSON to standard output.
"""

from __future__ import annotations

import json
import sys
from time import perf_counter
from typing import Any


def built(case: dict[str, Any], stepper: str) -> tuple[Any, Any, Any, Any]:
    """Static values, initial state, method and integrator of HRAP's engine."""
    import jax.numpy as jnp
    import numpy as np
    from hrap import core, fluid
    from hrap.chamber import make_chamber
    from hrap.grain import make_circle_shape, make_shiftOF_grain
    from hrap.nozzle import make_cd_nozzle
    from hrap.tank import make_sat_tank
    from jax.scipy.interpolate import RegularGridInterpolator

    properties = fluid.bake_sat_coolprop("NitrousOxide", np.linspace(183.0, 309.0, 20))
    tank = make_sat_tank(
        properties,
        V=case["tank_volume"],
        inj_CdA=case["hole_area"],
        inj_N=case["holes"],
        m_ox=case["oxidizer_mass"],
        T=case["temperature"],
        inj_vap_model=core.StaticVar("Real Gas"),
        inj_liq_model=core.StaticVar("Incompressible"),
    )
    grain = make_shiftOF_grain(
        make_circle_shape(ID=case["port_diameter"]),
        OD=case["grain_diameter"],
        L=case["grain_length"],
        rho=case["fuel_density"],
        Reg=jnp.array([1e3 * case["a"], case["n"], 0.0]),
    )
    nozzle = make_cd_nozzle(thrt=case["throat_diameter"], ER=case["area_ratio"])
    axes = np.array(case["ratios"]), np.array(case["pressures"])
    chemistry = {
        f"chem_interp_{key}": RegularGridInterpolator(axes, np.array(case[key]), fill_value=None) for key in "kMT"
    }
    parts = (tank, grain, make_chamber(V0=case["chamber_volume"]), nozzle)
    s, x, method = core.make_engine(*parts, **chemistry, Pa=case["ambient"])
    return s, x, method, core.make_integrator(getattr(core, stepper), method)


def timed(case: dict[str, Any], stepper: str) -> dict[str, Any]:
    """First call and quickest later one [s], as HRAP's window and examples call it and compiled as one function."""
    import jax
    import numpy as np

    s, x, method, fire = built(case, stepper)
    whole = jax.jit(lambda start: fire(s, start, dt=case["step"], T=case["seconds"])[2])
    found: dict[str, Any] = {"stepper": stepper}
    for name, call in (
        ("called", lambda: fire(s, x, dt=case["step"], T=case["seconds"])[2]),
        ("jit", lambda: whole(x)),
    ):
        times = []
        for _ in range(1 + case["repeats"]):
            start = perf_counter()
            history = np.asarray(jax.block_until_ready(call()))
            times.append(perf_counter() - start)
        found[name] = {"first": times[0], "later": min(times[1:])}
    thrust, mass = history[:, method["xmap"]["noz_thrust"]], history[:, method["xmap"]["tnk_m_ox"]]
    chamber = history[:, method["xmap"]["cmbr_P"]]
    bad = np.flatnonzero(~(np.isfinite(thrust) & np.isfinite(chamber)))
    sound = int(bad[0]) if bad.size else len(history) - 1
    found["steps"], found["sound_until"] = len(history) - 1, sound * case["step"]
    found["impulse"] = float(np.sum(thrust[:sound]) * case["step"])
    found["peak_chamber_pressure"], found["oxidizer_left"] = float(chamber[:sound].max()), float(mass[sound - 1])
    return found


def main() -> None:
    """Time both of HRAP's cheap steppers."""
    import jax

    jax.config.update("jax_enable_x64", True)
    case = json.load(sys.stdin)
    json.dump([timed(case, stepper) for stepper in ("step_fe", "step_heun")], sys.stdout)


if __name__ == "__main__":
    main()
