"""What is off in the same way in every repetition of a test, and by how much it moves each constant.

Each such error is one more reduction with it in: what that differs by is one standard deviation. The repeated
reductions are moved by it, each constant by its factor and all together, so that their correlations are kept.

- ``volume`` and ``area``, where test.toml states no deviation: the default of their kind.
- ``properties``: the other table of nitrous oxide. The truth may lie anywhere up to it, to either side, and it may well
  be the other one: the deviation of a uniform one, but normal, so that 95 % hold the other table.
- ``line``: t_v is when the liquid is gone at the injector. The tank is dry earlier, by the time that the line's content
  lasts; its vapor expands meanwhile, and is less than the saturated vapor of the whole volume. Uniform, too.
- ``gamma``: isentropic exponent of the vapor, for what chokes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, fields, replace
from math import sqrt

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.calibrate.blowdown import Inputs, Reduction, Shift, Tables, VaporPhase, expansion, reduce
from hfanalysis.calibrate.choked_vapor import VAPOR_M
from hfanalysis.calibrate.measured_pressures import MeasuredPressures
from hfanalysis.calibrate.uncertainty import SEED, Draws
from hfanalysis.engine.injector import mass_flow
from hfanalysis.record.definition import TestDefinition
from hfanalysis.thermo.nitrous import saturation as saturation_of
from hfanalysis.thermo.saturation import Saturation
from hfanalysis.thermo.two_phase import throttled

GAMMA_KNOWN = 0.1
"""Standard deviation of the vapor's isentropic exponent [-] in what chokes. Source: as of the effect
injector_choked_vapor; equilibrium flow from saturated vapor has 1.05, the frozen gas 1.2 to 1.3 (CoolProp)."""

FALL_OVER = 0.5
"""Seconds before t_v over which the fall of the tank's pressure is taken."""

UNIFORM = sqrt(3.0)
"""A bound over the standard deviation of what lies anywhere within it [-]. Source: GUM, 4.3.7."""


@dataclass(frozen=True)
class Systematic:
    """An error of all repetitions alike: ``factors`` [-] on the constants for one standard deviation.

    ``uniform``: anywhere within a bound, else normal; ``inputs``: the factors on inputs of the reduction.
    """

    name: str
    factors: dict[str, float]
    uniform: bool = False
    inputs: dict[str, float] = field(default_factory=dict)

    def drawn(self, generator: np.random.Generator, samples: int) -> Array:
        """Multiples of the deviation, (samples,)."""
        bound = UNIFORM if self.uniform else 0.0
        return generator.uniform(-bound, bound, samples) if bound else generator.standard_normal(samples)


def other_table(saturation: Saturation) -> Saturation:
    """The other source of nitrous oxide's properties."""
    return saturation_of("report" if saturation.source == "coolprop" else "coolprop")


def systematic_errors(
    definition: TestDefinition, histories: MeasuredPressures, saturation: Saturation, inputs: Inputs
) -> tuple[Systematic, ...]:
    """All that act on a test's reduction, effects left out."""
    tables = Tables.of(histories, saturation)
    plain = reduce(tables, saturation, inputs)
    found = dict(_shifted(definition, histories, saturation, tables, inputs, plain))
    bounds, own = {"properties": definition.deviations.properties.share, "line": 1.0}, ("volume", "area")
    out = []
    for name, other in found.items():
        factors = _factors(plain, other, bounds[name] / UNIFORM if name in bounds else 1.0)
        own_input = {name: 1.0 + _unstated(definition, name) / getattr(inputs, name)} if name in own else {}
        out.append(Systematic(name, factors, name == "line", own_input))
    return tuple(out)


def with_systematic(draws: Draws, errors: tuple[Systematic, ...]) -> Draws:
    """The repetitions with these errors in; ``inputs`` have them by their names, in standard deviations."""
    generator = np.random.default_rng(SEED + 1)
    values, inputs = dict(draws.values), dict(draws.inputs)
    size = next(iter(values.values())).size
    for error in errors:
        z = error.drawn(generator, size)
        values |= {name: values[name] * factor**z for name, factor in error.factors.items()}
        inputs |= {name: inputs[name] * factor**z for name, factor in error.inputs.items()}
        inputs[f"systematic {error.name}"] = z
    return Draws(values, inputs)


def _shifted(
    definition: TestDefinition, histories: MeasuredPressures, saturation: Saturation, tables: Tables, inputs: Inputs,
    plain: Reduction,
) -> Iterator[tuple[str, Reduction]]:  # fmt: skip
    """The reduction with each error in, by one standard deviation or at its bound."""
    for name in ("volume", "area"):
        std = _unstated(definition, name)
        if std > 0.0:
            yield name, reduce(tables, saturation, replace(inputs, **{name: getattr(inputs, name) + std}))
    other = other_table(saturation)
    yield "properties", reduce(Tables.of(histories, other), other, inputs)
    dry = _vapor_with_line(definition, histories, saturation, inputs, plain)
    if np.isfinite(dry) and plain.vapor_mass > 0.0:
        yield "line", _with_vapor(tables, saturation, inputs, plain, dry)
    choked = expansion(tables, saturation, inputs)
    if choked is not None:
        wider = replace(choked, gamma=choked.gamma + GAMMA_KNOWN)
        yield "gamma", replace(plain, m_choked=wider.exponent(plain.C_i), vapor_C_d=wider.coefficient(VAPOR_M))


def _unstated(definition: TestDefinition, name: str) -> float:
    """The default deviation [SI] of volume or area; 0 where one is stated, which the repetitions draw."""
    if name == "area":
        area = definition.injector.area if definition.injector is not None else None
        found = definition.injector_area
        return 0.0 if area is None or area.std is not None or found is None else found.std or 0.0
    tank = definition.tank
    if tank is None or tank.volume is None or tank.volume.std is not None:
        return 0.0
    return definition.known_std("tank.volume")


def _vapor_with_line(
    definition: TestDefinition, histories: MeasuredPressures, saturation: Saturation, inputs: Inputs, r: Reduction
) -> float:
    """Vapor [kg] at t_v where the line's content, flashed to p_run, kept the injector wet after the tank was dry."""
    line = definition.deviations.line_volume.of(inputs.volume)
    h, span = histories, min(FALL_OVER, 0.25 * inputs.t_v)
    early, late = (h.mean(h.tank, inputs.t_v - back, inputs.t_v - back + 0.2 * span) for back in (span, 0.2 * span))
    p_run, p_c = (h.mean(x, inputs.t_v - 0.2 * span, inputs.t_v) for x in (h.run, h.chamber))
    warm = saturation.temperature(np.array([late]))
    flow = mass_flow(r.C_i * inputs.area, float(saturation.liquid_density(warm)[0]), p_run - p_c)
    if not (line > 0.0 and flow > 0.0 and r.C_i > 0.0):
        return float("nan")
    lasts = line * float(throttled(saturation, warm, np.array([p_run])).density[0]) / flow
    dry = saturation.temperature(inputs.p_v + (early - late) / (0.8 * span) * lasts)
    return (inputs.volume - line) * float(saturation.vapor_density(dry))


def _with_vapor(tables: Tables, saturation: Saturation, inputs: Inputs, r: Reduction, vapor: float) -> Reduction:
    """The reduction with another mass of ``vapor`` [kg] left at t_v, in the same volume at the same pressure.

    d ln M/dt goes with A (p_run - p_c)^(1/2) M_v^(-1/2): less vapor acts as a wider injector does.
    """
    more = (inputs.mass - vapor) / (inputs.mass - r.vapor_mass) if not np.isfinite(inputs.C_i) else 1.0
    K_loss = r.K_loss / more**2 if not np.isfinite(inputs.K_loss) else r.K_loss
    wider, choked = more / sqrt(vapor / r.vapor_mass), expansion(tables, saturation, inputs)
    m, _ = VaporPhase.plain(saturation, inputs).shoot(tables, inputs, Shift(), wider * r.C_i * inputs.area)
    return replace(
        r, C_i=r.C_i * more, K_loss=K_loss, vapor_mass=vapor, Z=r.Z * r.vapor_mass / vapor, m=m,
        m_choked=choked.exponent(wider * r.C_i) if choked is not None else np.nan,
        vapor_C_d=r.vapor_C_d * sqrt(vapor / r.vapor_mass),
    )  # fmt: skip


def _factors(plain: Reduction, other: Reduction, power: float) -> dict[str, float]:
    """What of the constants moves, and by which factor; what one of both does not have is left as it is."""
    pairs = {f.name: (getattr(plain, f.name), getattr(other, f.name)) for f in fields(Reduction)}
    return {n: (b / a) ** power for n, (a, b) in pairs.items() if a * b > 0.0 and a != b}
