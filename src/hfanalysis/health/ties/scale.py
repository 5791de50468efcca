"""Scales and units by what an engine can do: thrust over p_c A_t, c*, specific impulse, and who is above whom.

Thrust and chamber pressure, chamber pressure and mass, thrust and mass are three ties between three channels: which of
them are broken says which channel is off. Where it cannot be said, both are named.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import hypot, pi, sqrt

import numpy as np

from hfanalysis.health import performance as engine
from hfanalysis.health.factors import Factor, unit_for
from hfanalysis.health.firing import Burn, burn_of
from hfanalysis.health.seen import Seen, SeenTest
from hfanalysis.products.health import Finding
from hfanalysis.sentences import joined, said, text

DEVIATIONS = 3.0
"""Deviations of stated sizes and of accuracies that count as possible [-]."""
THROAT = 0.03
"""Relative deviation of a throat radius whose error is not stated: turning, and what a burn adds or takes [-]. Source:
HF5's throat grows by less; graphite erodes by 0.1 mm/s at most."""
BURNT = (0.7, 1.0)
"""Part of the oxidizer loaded that flows while the chamber burns [-]: vapor and gas flow after it. Source: HF5 burns
out after three quarters of its load."""
ABOVE = 0.5
"""Part of the burn in which a pressure is above the one that feeds it [-]. Source: definition."""
GREATEST = 1e3
"""A factor beyond which nothing is told from a channel that says nothing [-]: units differ by less."""
COLD_SHARE = 0.18
"""Chamber over run-line pressure, above ambient, below which nothing burns [-]. Source: segment/kind.py."""


@dataclass(frozen=True)
class Throat:
    """Its ``area`` [m^2] and its relative deviation ``error``, the ``exit`` area [m^2] where it is stated, and where
    the throat is from, if not stated."""

    area: float
    error: float
    exit: float | None
    source: str = ""


@dataclass(frozen=True)
class Ties:
    """What thrust has to be multiplied by to fit p_c, and either to fit the mass; None where it cannot be had."""

    thrust_by_pressure: Factor | None
    pressure_by_mass: Factor | None
    thrust_by_mass: Factor | None
    words: tuple[str, ...]


def find(test: SeenTest) -> Iterator[Finding]:
    """Of thrust and chamber pressure, and of pressures above those that feed them."""
    if any(f.kind in ("swapped", "sign", "dead") and not _is_aside(f) for f in test.found):
        return
    ties = _ties(test)
    above = tuple(name for name in ("p_run", "p_tank") if _is_above(test, "p_chamber", name))
    yield from _blame(test, ties, above)
    if not above and _is_above(test, "p_run", "p_tank"):
        yield _order(test, ("p_run", "p_tank"), "p_run", "p_tank")


def _is_aside(finding: Finding) -> bool:
    return not {"thrust", "p_chamber", "p_run", "p_tank"} & set(finding.channels) or not finding.whole


def _blame(test: SeenTest, ties: Ties, above: tuple[str, ...]) -> Iterator[Finding]:
    """The channel that breaks all ties that are broken."""
    f_p, p_m, f_m = ties.thrust_by_pressure, ties.pressure_by_mass, ties.thrust_by_mass
    too_high = p_m is not None and p_m.high < 1.0
    if f_p is not None and f_p.off:
        yield _off(test, _who(test, ties, f_p, above or too_high), f_p, ties)
    elif too_high and p_m is not None:
        yield _off(test, ("p_chamber",), p_m.inverse, ties)
    elif above:
        yield _order(test, ("p_chamber",) if len(above) == 2 else ("p_chamber", above[0]), "p_chamber", above[0])
    elif f_p is None and f_m is not None and f_m.off:
        yield _off(test, ("thrust",), f_m, ties)


def _who(test: SeenTest, ties: Ties, f_p: Factor, pressure_too: object) -> tuple[str, ...]:
    """Thrust or chamber pressure, where the third tie acquits the other; else both."""
    p_m, f_m = ties.pressure_by_mass, ties.thrust_by_mass
    if pressure_too:
        return ("p_chamber",)
    if f_m is not None and f_m.off and (f_m.low > 1.0) == (f_p.low > 1.0):
        return ("thrust",)
    thrust = f_m is None or f_p.both(f_m) is not None
    pressure = (p_m is None or f_p.inverse.both(p_m) is not None) and not _would_be_above(test, f_p.inverse)
    if thrust == pressure:
        return ("thrust", "p_chamber")
    return ("thrust",) if thrust else ("p_chamber",)


def _ties(test: SeenTest) -> Ties:
    both, chamber, alone = burn_of(test, "p_chamber", "thrust"), burn_of(test, "p_chamber"), burn_of(test, "thrust")
    throat, mass = _throat(test), _mass(test)
    words: list[str] = []
    any_throat = throat or (_throat_by_mass(test, chamber) if chamber else None)
    f_p = _by_pressure(test, both, any_throat, words) if both and any_throat else None
    p_m = _velocity(test, chamber, throat, mass, words) if chamber and throat and mass else None
    f_m = _impulse(test, alone, both, mass, words) if alone and mass else None
    return Ties(f_p, p_m, f_m, tuple(words))


def _by_pressure(test: SeenTest, burn: Burn, throat: Throat, words: list[str]) -> Factor | None:
    pressure, thrust = burn.mean("p_chamber"), burn.mean("thrust")
    if pressure < 1.3 * test.ambient or thrust <= 0.0:
        return None
    low, high = engine.thrust_coefficients(pressure, test.ambient, throat.area, throat.exit)
    low = low if engine.choked(pressure, test.ambient) else 1e-3 * high
    value = thrust / (pressure * throat.area)
    words.append(
        text(
            "F/(p_c A_t) is {value:.2g}, a nozzle gives {low:.2f} to {high:.2f} at {pressure}{source}", value=value,
            low=low, high=high, pressure=said(pressure, "bar", ".3g"), source=throat.source,
        )
    )  # fmt: skip
    slack = DEVIATIONS * float(np.hypot(throat.error, _accuracy(test, "p_chamber", pressure)))
    return Factor(low / value / (1.0 + slack), high / value * (1.0 + slack))


def _velocity(test: SeenTest, burn: Burn, throat: Throat, mass: tuple[float, float], words: list[str]) -> Factor | None:
    value = burn.integral("p_chamber") * throat.area
    slack = 1.0 + DEVIATIONS * throat.error
    low, high = value / mass[1], value / mass[0]
    factor = Factor(engine.SLOWEST_COLD / high / slack, engine.FASTEST_FIRE / low * slack)
    if factor.high < 1.0:
        words.append(
            text(
                "c* would be {low}, and the propellants give {most} at most", low=said(low, "m/s", ".0f"),
                most=said(engine.FASTEST_FIRE, "m/s", ".0f"),
            )
        )  # fmt: skip
    return factor


def _impulse(
    test: SeenTest, burn: Burn, both: Burn | None, mass: tuple[float, float], words: list[str]
) -> Factor | None:
    impulse = burn.integral("thrust")
    if impulse <= 0.0:
        return None
    pressure = both.mean("p_chamber") if both else 10.0 * test.ambient
    if not engine.choked(pressure, test.ambient):
        return None
    low, high = engine.thrust_coefficients(pressure, test.ambient)
    # a chamber gauge that reads too little makes a fire look cold: then even that is possible
    least, most = low * (engine.GOOD_FIRE if _burns(test) else engine.SLOWEST_COLD), high * engine.FASTEST_FIRE
    factor = Factor(least * mass[0] / impulse, most * mass[1] / impulse)
    if factor.off:
        words.append(
            text(
                "impulse over propellant would be {a} to {b}, and such an engine gives {least} to {most}",
                a=said(impulse / mass[1], "m/s", ".0f"), b=said(impulse / mass[0], "m/s", ".0f"),
                least=said(least, "m/s", ".0f"), most=said(most, "m/s", ".0f"),
            )
        )  # fmt: skip
    return factor


def _throat(test: SeenTest) -> Throat | None:
    """As stated."""
    nozzle, observed = test.definition.nozzle, test.definition.observed
    if nozzle is None or nozzle.throat_radius is None:
        return None
    radius, after = nozzle.throat_radius, observed.throat_radius_after if observed else None
    error = max(radius.std / radius.value if radius.std is not None else 0.0, THROAT)
    if after is not None:
        error = max(error, abs(after.value / radius.value - 1.0))
    exit_area = pi * nozzle.exit_radius.value**2 if nozzle.exit_radius is not None else None
    return Throat(pi * radius.value**2, 2.0 * error, exit_area)


def _throat_by_mass(test: SeenTest, burn: Burn) -> Throat | None:
    """The throat that propellant, c* and chamber pressure demand, of a fire whose masses are stated."""
    tank, grain, total = test.definition.tank, test.definition.grain, burn.integral("p_chamber")
    if not _burns(test) or not engine.choked(burn.mean("p_chamber"), test.ambient):
        return None
    if tank is None or tank.oxidizer_mass is None or grain is None or grain.mass is None or total <= 0.0:
        return None
    low, high = ((tank.oxidizer_mass.value + grain.mass.value) * c / total for c in engine.BALANCE)
    area = sqrt(low * high)
    source = text(" (throat of {area:.0f} mm^2, not stated: by propellant, c* and p_c)", area=area * 1e6)
    return Throat(area, 0.25 * (high - low) / area, None, source)


def _mass(test: SeenTest) -> tuple[float, float] | None:
    """Propellant that flows in the burn, at least and at most [kg]; None where a stated load may be nothing."""
    tank, grain = test.definition.tank, test.definition.grain
    if tank is None or tank.oxidizer_mass is None:
        return None
    load, std = tank.oxidizer_mass.value, tank.oxidizer_mass.std or 0.05 * tank.oxidizer_mass.value
    least, most = load - DEVIATIONS * std, load + DEVIATIONS * std
    if not least > 0.0:
        return None
    fuel = grain.mass.value if grain is not None and grain.mass is not None else (engine.RICHEST - 1.0) * most
    return BURNT[0] * least, BURNT[1] * most + fuel


def _burns(test: SeenTest) -> bool:
    """Whether something burns: as stated, and not contradicted by a chamber that stays low."""
    burn = burn_of(test, "p_chamber", "p_run")
    if test.definition.test.kind != "hot_fire":
        return False
    if burn is None:
        return True
    return burn.mean("p_chamber") - test.ambient > COLD_SHARE * (burn.mean("p_run") - test.ambient)


def _accuracy(test: SeenTest, name: str, level: float) -> float:
    return test.channels[name].channel.accuracy / level


def _is_above(test: SeenTest, name: str, feeding: str) -> bool:
    """Whether a pressure is above the one that feeds it through half of the burn, by more than both accuracies."""
    burn = burn_of(test, name, feeding)
    if burn is None:
        return False
    sure = DEVIATIONS * hypot(*(test.channels[n].channel.accuracy for n in (name, feeding)))
    above = burn.values[name] - burn.values[feeding] > sure
    return float(np.mean(above[burn.burning])) > ABOVE


def _would_be_above(test: SeenTest, factor: Factor) -> bool:
    """Whether the least factor on p_c would put it above what feeds it."""
    for feeding in ("p_run", "p_tank"):
        burn = burn_of(test, "p_chamber", feeding)
        if burn is not None and factor.low * burn.mean("p_chamber") > burn.mean(feeding):
            return True
    return False


def _off(test: SeenTest, channels: tuple[str, ...], factor: Factor, ties: Ties) -> Finding:
    """``factor``: of the thrust; of the chamber pressure alone its inverse."""
    first, alone = test.channels[channels[0]], len(channels) == 1
    factor = factor.inverse if channels == ("p_chamber",) else factor
    unit = unit_for(factor, first.spec.unit, first.dimension)
    means = text(
        "{who} {verb} off by a factor of {low:.2g} to {high:.2g}{unit}{else_}",
        who=" or ".join(channels), verb="is", low=factor.low, high=factor.high,
        unit=f": it seems to be in {unit}, not {first.spec.unit}" if unit else "",
        else_=_otherwise(channels),
    )  # fmt: skip
    return Finding(
        kind="unit" if unit else "scale", verdict="suspect", channels=channels,
        evidence=joined("; ", ties.words), means=means, cure=_cure(first, factor, unit) if alone else None,
        gain=min(max(factor.middle, 1.0 / max(factor.middle, 1.0 / GREATEST)), GREATEST) - 1.0,
    )  # fmt: skip


def _otherwise(channels: tuple[str, ...]) -> str:
    if channels == ("p_chamber",):
        return "; or the throat is not the stated one: narrowed through the whole burn, or eroded"
    return "; or the stated throat or masses are another engine's"


def _cure(seen: Seen, factor: Factor, unit: str | None) -> str:
    return f'unit = "{unit}"' if unit else f"scale = {seen.spec.scale * factor.middle:.2g}"


def _order(test: SeenTest, channels: tuple[str, ...], name: str, feeding: str) -> Finding:
    burn = burn_of(test, name, feeding)
    assert burn is not None
    upper, lower = burn.mean(name), burn.mean(feeding)
    evidence = text(
        "{name} stands at {upper} in the burn, and {feeding}, which feeds it, at {lower}", name=name,
        upper=said(upper, "bar", ".3g"), feeding=feeding, lower=said(lower, "bar", ".3g"),
    )  # fmt: skip
    means = f"nothing flows uphill: the scale of {' or '.join(channels)} is off"
    gain = 1.0 - 0.75 * lower / upper
    return Finding(
        kind="scale", verdict="suspect", channels=channels, evidence=evidence, means=means, cure=None, gain=gain
    )
