"""Quantities by which engines are compared: regression point, vacuum values, values at sea level, L*."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.engine.grain import oxidizer_flux
from hfanalysis.engine.unsteady import Engine
from hfanalysis.flight.constant_thrust import STANDARD_GRAVITY
from hfanalysis.performance.efficiency import Ideal, Spread, chamber_over_throat
from hfanalysis.performance.flows import Flows
from hfanalysis.performance.measured import Fire
from hfanalysis.products.calibration import UNIT_OF_FLUX
from hfanalysis.products.validation import Standard
from hfanalysis.quantity import Quantity

PUBLISHED = (1.32e-4, 0.555)
"""Regression of paraffin with nitrous oxide: a [m/s (kg/m^2/s)^-n] and n [-]. Source: the technical report,
engine parameters of the steady and the unsteady model, there from the literature."""

SEA_LEVEL = 101325.0
"""Ambient pressure [Pa] at which values of several sites are compared. Source: ISO 2533."""


def standard(
    measured: Mapping[str, Array], flows: Flows, engine: Engine, ambient: float, fire: Fire, found: Ideal | None,
    spread: Spread,
) -> Standard:  # fmt: skip
    """All of them; those that a channel is missing for say so. ``ambient`` [Pa] is the air's."""
    lengths = (engine.port_radius, float(np.interp(fire.end, flows.time, flows.port)))
    names = ("characteristic_length", "characteristic_length_end")
    found_lengths = {
        name: Quantity(chamber_over_throat(engine, port), "m", chamber_over_throat(engine, port) * spread.throat)
        for name, port in zip(names, lengths, strict=True)
    }
    return Standard(
        **_regression(flows, engine, fire, spread), **_vacuum(measured, flows, engine, ambient, found, spread),
        **found_lengths,
    )  # fmt: skip


def _regression(flows: Flows, engine: Engine, fire: Fire, spread: Spread) -> dict[str, Quantity]:
    """Mean rate and mean flux, over length and burn: those that published laws are fitted to."""
    part = (flows.time >= 0.0) & (flows.time <= fire.end)
    end = float(np.interp(fire.end, flows.time, flows.port))
    rate = (end - engine.port_radius) / fire.end
    flow = float(np.trapezoid(flows.oxidizer[part], flows.time[part])) / fire.end
    flux = float(oxidizer_flux(flow, 0.5 * (end + engine.port_radius)))
    by_time, longest = fire.std / fire.end, (fire.latest or fire.end) / fire.end
    a, n = PUBLISHED
    return {
        "mean_regression_rate": Quantity(rate, "m/s", rate * by_time, why="burnt web over burn time").reaching(
            rate / longest
        ),
        "mean_oxidizer_flux": Quantity(flux, UNIT_OF_FLUX, flux * float(np.hypot(by_time, spread.flow))).reaching(
            flux / longest
        ),
        "published_regression_rate": Quantity(
            a * flux**n,
            "m/s",
            why=f"paraffin and nitrous oxide: {a:.3g} G^{n} (the technical report, from the literature)",
        )
        if engine.combustion.fuel.wax
        else Quantity.absent("[fuel] is no paraffin, the only fuel of which a published law is compared"),
    }


_VACUUM = {
    "vacuum_thrust": "N", "vacuum_specific_impulse": "s", "vacuum_thrust_coefficient": "",
    "sea_level_specific_impulse": "s", "sea_level_thrust_coefficient": "",
}  # fmt: skip


def _vacuum(
    measured: Mapping[str, Array], flows: Flows, engine: Engine, ambient: float, found: Ideal | None, spread: Spread
) -> dict[str, Quantity]:
    """While the nozzle flows full: there the air's pressure on the exit is all that the site does to the thrust."""
    if found is None or "thrust_corrected" not in measured:
        return dict.fromkeys(_VACUUM, Quantity.absent("the log has no thrust, or no p_chamber"))
    full = found.counted & np.isfinite(found.vacuum)
    if full.sum() < 2:
        return dict.fromkeys(_VACUUM, Quantity.absent("the nozzle never flows full while no nitrogen flows"))
    thrust, flow, force = (
        float(np.mean(x[full]))
        for x in (measured["thrust_corrected"], flows.total, found.pressure * engine.throat_area)
    )
    vacuum = thrust + ambient * engine.exit_area
    level = vacuum - SEA_LEVEL * engine.exit_area
    low, high = found.before.mean(full)
    by_flow, by_force = np.hypot(spread.thrust, spread.flow), np.hypot(spread.thrust, spread.throat)
    why = f"mean over {_length(flows.time, full):.1f} s in which the nozzle flows full"
    made = {}
    for name, force_of in (("vacuum", vacuum), ("sea_level", level)):
        per = force_of / (flow * STANDARD_GRAVITY)
        made[f"{name}_specific_impulse"] = Quantity(per, "s", abs(per) * float(by_flow), why=why)
        coefficient = force_of / force
        made[f"{name}_thrust_coefficient"] = Quantity(
            coefficient, "", abs(coefficient) * float(by_force), why=why
        ).scaled_to(1.0 / low, 1.0 / high)
    return {"vacuum_thrust": Quantity(vacuum, "N", thrust * spread.thrust, why=why), **made}


def _length(time: Array, part: NDArray[np.bool_]) -> float:
    return float(part.sum() * (time[1] - time[0]))
