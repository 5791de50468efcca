"""What an engineer warns of when numbers of a design, a simulated burn or a test lie beyond what is known to go well.

One small rule per caution: it takes a value, holds it against its limit, and says both with the limit's source. A value
that is within its limit draws nothing. What a rule knows is a number; where it comes from is its caller's.
"""

from __future__ import annotations

from hfanalysis.engine.injector import SMALL_DROP
from hfanalysis.engine.nozzle import mach_at_area, pressure_ratio
from hfanalysis.engine.separation import separation_pressure
from hfanalysis.products.beyond import Beyond
from hfanalysis.quantity import Quantity
from hfanalysis.sentences import said, text

Cautions = tuple[Beyond, ...]

LEAST_STIFFNESS = 0.2
"""Injector pressure drop over chamber pressure [-] from which on the flow hardly follows the chamber. Source: Humble,
Henry and Larson, Space Propulsion Analysis and Design, 1995: 20 % of the chamber pressure, unthrottled; Sutton and
Biblarz, Rocket Propulsion Elements: 15 to 30 %."""

LEAST_RAIL_SPEED = 30.48
"""Least speed at the end of the rail [m/s]. Source: 100 ft/s, Spaceport America Cup, Design, Test and
Evaluation Guide; the report, section 3.2.4, cites it."""

LEAST_THRUST_TO_WEIGHT = 5.0
"""Least thrust over weight on the pad [-]. Source: Spaceport America Cup, Design, Test and Evaluation
Guide, 5.18.2: 5:1."""

TRIPLE_POINT = 182.33
"""Of nitrous oxide [K], below which there is no liquid and vapor turns solid. Source: Lemmon and Span, J. Chem. Eng.
Data 51, 2006, 785-850."""

MOST_LOST = 0.05
"""Share of the best mixture's specific impulse [-] that a mixture may cost. Source: by choice: as much propellant more
for the same impulse."""

MOST_FLUX = 700.0
"""Oxidizer flux [kg/(m^2 s)] beyond which flames of hybrids are blown off or flooded. Source: Humble, Henry and Larson,
Space Propulsion Analysis and Design, 1995: usually at 350 to 700; for hybrids, not for paraffin alone."""

_TEXTBOOK = "Humble, Henry and Larson, Space Propulsion Analysis and Design, 1995"
_GUIDE = "Spaceport America Cup, Design, Test and Evaluation Guide"


def stiffness(ratio: float) -> Cautions:
    """Injector pressure drop over chamber pressure, ``ratio`` [-]."""
    if not ratio < LEAST_STIFFNESS:
        return ()
    words = (
        f"the injector's pressure drop is down to {ratio:.2f} of the chamber pressure, below {LEAST_STIFFNESS:g} "
        f"({_TEXTBOOK}): the flow follows the chamber's pressure, and both may swing together"
    )
    return (_caution("injector_stiffness", ratio, LEAST_STIFFNESS, "", _TEXTBOOK, words),)


def beyond_tank(chamber: float, held: float) -> Cautions:
    """``chamber`` pressure [Pa] that is asked for; ``held`` [Pa]: what the tank has left behind its feed line."""
    if chamber < held:
        return ()
    source = "saturation pressure at the tank's temperature, less the feed line's loss"
    words = text(
        "the chamber is to have {chamber}, no less than the {held} that the tank holds before the injector ({source}): "
        "nothing flows",
        chamber=said(chamber, "bar", ".1f"), held=said(held, "bar", ".1f"), source=source,
    )  # fmt: skip
    return (_caution("chamber_above_tank", chamber, held, "Pa", source, words),)


def rail_speed(speed: float) -> Cautions:
    """``speed`` [m/s] at the end of the rail."""
    if not speed < LEAST_RAIL_SPEED:
        return ()
    words = text(
        "the rocket leaves its rail at {speed}, below {limit} (100 ft/s, {source}): its fins may not hold it straight",
        speed=said(speed, "m/s", ".1f"), limit=said(LEAST_RAIL_SPEED, "m/s", ".1f"), source=_GUIDE,
    )  # fmt: skip
    return (_caution("rail_speed", speed, LEAST_RAIL_SPEED, "m/s", _GUIDE, words),)


def thrust_to_weight(ratio: float) -> Cautions:
    """Thrust over the weight on the pad, ``ratio`` [-]."""
    if not ratio < LEAST_THRUST_TO_WEIGHT:
        return ()
    source = f"{_GUIDE}, 5.18.2"
    words = f"the thrust is {ratio:.1f} times the weight on the pad, below {LEAST_THRUST_TO_WEIGHT:g} ({source})"
    return (_caution("thrust_to_weight", ratio, LEAST_THRUST_TO_WEIGHT, "", source, words),)


def separation(chamber: float, ambient: float, gamma: float, expansion: float) -> Cautions:
    """Pressures of ``chamber`` and ``ambient`` [Pa], heat capacity ratio [-], exit over throat area [-]."""
    mach = float(mach_at_area(expansion, gamma, True))
    ratio, limit = chamber * pressure_ratio(mach, gamma) / ambient, separation_pressure(mach)
    if not ratio < limit:
        return ()
    source = "Schmucker, NASA TM-77396, 1984"
    words = text(
        "with {chamber} in the chamber the nozzle's exit would be at {ratio:.2f} of the ambient pressure, below "
        "{limit:.2f} at Mach {mach:.1f} ({source}): the flow separates from the wall, and may do so on one side",
        chamber=said(chamber, "bar", ".1f"), ratio=ratio, limit=limit, mach=mach, source=source,
    )  # fmt: skip
    return (_caution("nozzle_separation", ratio, limit, "", source, words),)


def static_margin(least: float, largest: float, limits: tuple[float, float], wind: float) -> Cautions:
    """``least`` and ``largest`` margin [calibers] in a ``wind`` [m/s], two deviations over gusts included."""
    low, high = limits
    if low <= least and largest <= high:
        return ()
    margin, limit, way, means = (
        (least, low, "down to {margin:.1f} calibers, below", "a gust may turn the rocket over")
        if least < low
        else (largest, high, "up to {margin:.1f} calibers, above", "the rocket turns far into the wind")
    )
    words = text(
        f"in a wind of {{wind}} the static margin comes {way} {{limit:g}} ({{source}}): {means}",
        wind=said(wind, "m/s", ".1f"), margin=margin, limit=limit, source=_GUIDE,
    )  # fmt: skip
    return (_caution("static_margin", margin, limit, "", _GUIDE, words),)


def frozen_tank(temperature: float) -> Cautions:
    """Lowest ``temperature`` [K] in the tank."""
    if not temperature < TRIPLE_POINT:
        return ()
    source = "Lemmon and Span, J. Chem. Eng. Data 51, 2006"
    words = text(
        "the tank's gas cools to {temperature}, below the triple point of nitrous oxide at {limit} ({source}): it "
        "would turn solid, or the wall would heat it; what the model says of the vapor from there on is no forecast",
        temperature=said(temperature, "K", ".0f"), limit=said(TRIPLE_POINT, "K", ".1f"), source=source,
    )  # fmt: skip
    return (_caution("tank_below_triple_point", temperature, TRIPLE_POINT, "K", source, words),)


def mixture(of_ratio: float, best: float, lost: float, of_what: str) -> Cautions:
    """Mean ``of_ratio`` [-], the ``best`` one [-], and the share [-] ``lost`` ``of_what`` the best one has."""
    if not lost > MOST_LOST:
        return ()
    side = "fuel" if of_ratio < best else "oxidizer"
    source = "chemical equilibrium at the chamber's pressure; the limit by choice"
    words = (
        f"O/F is {of_ratio:.2f} where {best:.2f} is best: {100.0 * lost:.0f} % of its {of_what} are lost, more than "
        f"{100.0 * MOST_LOST:g} % ({source}); there is too much {side}"
    )
    return (_caution("of_ratio", lost, MOST_LOST, "", source, words),)


def left_over(left: float, vapor: float) -> Cautions:
    """Oxidizer [kg] ``left`` when the fuel is gone, and the ``vapor`` [kg] that the tank would hold without liquid."""
    if not left > vapor:
        return ()
    source = "saturated vapor that fills the tank at its temperature"
    words = text(
        "{left} of oxidizer are left when the fuel is gone, more than {vapor} ({source}): there is liquid among it "
        "that nothing was loaded to burn with, and it goes on through a hot chamber without fuel",
        left=said(left, "kg", ".2f"), vapor=said(vapor, "kg", ".2f"), source=source,
    )  # fmt: skip
    return (_caution("oxidizer_left", left, vapor, "kg", source, words),)


def reversed_flow(drop: float) -> Cautions:
    """Lowest pressure ``drop`` [Pa] from before the injector into the chamber while liquid flows."""
    if not drop < SMALL_DROP:
        return ()
    source = "by definition: flow goes where the pressure is lower; the model's own tends to none from there on"
    words = text(
        "the pressure before the injector comes to {drop} above the chamber's while liquid flows, below {limit} "
        "({source}): whatever swings sends burnt gas back into the oxidizer's line",
        drop=said(drop, "Pa", ".3g"), limit=said(SMALL_DROP, "Pa", ".0f"), source=source,
    )  # fmt: skip
    return (_caution("reversed_flow", drop, SMALL_DROP, "Pa", source, words),)


def oxidizer_flux(flux: float) -> Cautions:
    """Highest oxidizer ``flux`` [kg/(m^2 s)] in the port."""
    if not flux > MOST_FLUX:
        return ()
    words = text(
        "the oxidizer's flux in the port comes to {flux}, above {limit} ({source}; of hybrids, not of paraffin alone): "
        "the flame may be blown off, and no law of regression is known there",
        flux=said(flux, "kg/(m^2 s)", ".0f"), limit=said(MOST_FLUX, "kg/(m^2 s)", ".0f"), source=_TEXTBOOK,
    )  # fmt: skip
    return (_caution("oxidizer_flux", flux, MOST_FLUX, "kg/(m^2 s)", _TEXTBOOK, words),)


def _caution(name: str, value: float, limit: float, unit: str, source: str, words: str) -> Beyond:
    return Beyond(name=name, value=Quantity(float(value), unit), limit=float(limit), source=source, text=words)
