"""A tank that is hotter above than below: its pressure falls to the bulk's saturation when the valve opens."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from hfanalysis.engine.effect import Believable, Effect, OwnState, Parameter
from hfanalysis.engine.equations import VOLUME
from hfanalysis.engine.sites import AT_TANK, OXIDIZER_FLOW, RATES, RHO_FEED, TANK_PRESSURE, term

if TYPE_CHECKING:
    from hfanalysis.engine.unsteady import Engine

EXCESS, MIXING, SHARPNESS = range(3)


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == AT_TANK:
        site[TANK_PRESSURE] += x[0] * x[1]
    elif hook == RATES:
        spent = env[OXIDIZER_FLOW] / (env[RHO_FEED] * p[MIXING] * c[VOLUME])
        dx[0] = -x[0] / (p[SHARPNESS] * x[0] + 1.0 - p[SHARPNESS]) * spent


def _at_rest(engine: Engine, values: Mapping[str, float]) -> float:
    """The pressure at rest beyond the bulk's saturation [Pa]."""
    return values["excess"] * float(engine.saturation.pressure_slope(engine.temperature))


EFFECT = Effect(
    name="tank_stratification",
    plain_name="warm layers in the tank",
    equation="tank_energy",
    meaning="a hot ullage over a colder bulk: the pressure at rest is above the bulk's saturation and falls to it",
    reference="Clausius-Clapeyron slope of nitrous oxide (report, appendix); temperatures above and below differ in a "
    "tank at rest: Zimmerman, Waxman, Cantwell and Zilliac, AIAA 2013-4045. The layer's pressure is spent as volume "
    "leaves: at a constant rate where it only expands until the bulk boils (s = 1), in e-folds where it mixes (s = 0)",
    formula="p_T = p_sat(T) + u p_sat'(T_0) dT,  u(0) = 1,  du/dt = -u / (s u + 1 - s) (mdot / rho) / (f V_T)",
    sites=("tank_pressure",),
    parameters=(
        Parameter("excess", "K", "ullage above the bulk's temperature at rest", typical=2.0, low=0.0, high=20.0),
        Parameter(
            "mixing",
            "-",
            "share of the tank's volume that the layer's first slope spends it in",
            0.1,
            center=0.05,
            low=2e-3,
            high=0.3,
        ),
        Parameter("sharpness", "-", "how far the layer expands rather than mixes", 0.3, center=0.5, low=0.0, high=0.98),
    ),
    phases=("liquid",),
    term=_term,
    states=(
        OwnState("layer_left", "-", 1e-4, lambda engine, values: 1.0),
        OwnState("excess_at_rest", "Pa", 1e2, _at_rest),
    ),
    twins=("tank_nonequilibrium",),
    decisive="thermocouples at the top and the bottom of the tank, before the valve opens",
    believable=Believable("excess", 10.0, "a tank in the shade is layered by some kelvins", unit="K"),
)
