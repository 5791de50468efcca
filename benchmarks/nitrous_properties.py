"""Compare the two property sources of saturated nitrous oxide and write docs/properties.md.

python -m benchmarks.nitrous_properties
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from benchmarks.other_tables import enthalpies, liquid_density, pressure, vapor_density

from hfanalysis.engine.blowdown import blow_down
from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.engine.tank import split
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.thermo.saturation import Property, Saturation

PAGE = Path(__file__).resolve().parent.parent / "docs" / "properties.md"

INTRODUCTION = """# Nitrous oxide: two property sources

Written by `python -m benchmarks.nitrous_properties`.

`[model] properties` chooses where the saturated properties of nitrous oxide come from:

- `coolprop` (default): CoolProp's reference equation of state (Lemmon and Span 2006), tabulated once.
- `report`: the correlations and the table of the technical report's appendix, with its two slips corrected: the liquid
  expands on heating (the printed derivative of its molar volume has the wrong sign), and c_v of the vapor at 250 K is
  0.034798, not 0.043798 kJ/(mol K).

Both are C2 splines over theta = (1 - T/T_c)^(1/3), in which densities stay smooth up to the critical point; all
derivatives are those of the splines, so that mass and energy equations see one consistent surface.

**Why CoolProp is the default.** The report takes pressure and liquid volume from correlations and everything else from
a table that follows an equation of state. Both run a tank whose energy balance closes (second table), but the two
halves do not describe one fluid: where h - u should be p v they differ by 1 to 5 % (last column of the first table),
and a gauge pressure is read as a temperature that is 0.3 to 1.4 K too low (third column). With one equation of state
the temperature read off the gauge is that of the energy balance. For reproducing the report's numbers, and only for
that, take `report`.
"""


DEPARTURES = """## Two independent sources

The correlations of ESDU 91022 against CoolProp: what is known of nitrous oxide is known to half of that. A diagnosis
takes it as unknown: errors of pressure, liquid, vapor and latent heat, each as a level and as what changes over 25 K
(`hfanalysis.thermo.departures`), are constants of every hypothesis.
"""


def differences() -> str:
    """Report against CoolProp, in percent, over the range of a tank."""
    a, b = saturation("report"), saturation("coolprop")
    rows = [
        "| T, K | p_sat, bar | T read off that pressure | p_sat | liquid density | vapor density "
        "| p v_v / (h_v - u_v) of the report |",
        "|---|---|---|---|---|---|---|",
    ]
    for t in (240.0, 260.0, 273.15, 283.15, 293.15, 298.15, 303.15, 307.0):
        h, u = (a.energy(p, t)[0] for p in (Property.VAPOR_ENTHALPY, Property.VAPOR_ENERGY))
        closure = a.pressure(t) * a.vapor_volume(t)[0] / (h - u)
        values = [(f(a) / f(b) - 1.0) * 100.0 for f in _functions(t)]
        read = float(a.temperature(b.pressure(t))) - t
        differ = " | ".join(f"{v:+.2f} %" for v in values)
        rows.append(f"| {t:.2f} | {float(b.pressure(t)) / 1e5:.2f} | {read:+.2f} K | {differ} | {closure:.4f} |")
    return "\n".join(rows)


def departures() -> str:
    """ESDU 91022 against CoolProp, in percent."""
    source = saturation("coolprop")
    rows = ["| T, K | p_sat | liquid density | vapor density | latent heat |", "|---|---|---|---|---|"]
    for t in (245.0, 255.0, 265.0, 275.0, 285.0, 295.0, 300.0):
        latent = [float(source.energy(p, t)[0]) for p in (Property.LIQUID_ENTHALPY, Property.VAPOR_ENTHALPY)]
        liquid, vapor = (float(h) for h in enthalpies(np.array(t)))
        pairs = (
            (pressure(np.array(t)), source.pressure(t)),
            (liquid_density(np.array(t)), source.liquid_density(t)),
            (vapor_density(np.array(t)), source.vapor_density(t)),
            (vapor - liquid, latent[1] - latent[0]),
        )
        differ = " | ".join(f"{100.0 * (float(a) / float(b) - 1.0):+.2f} %" for a, b in pairs)
        rows.append(f"| {t:.0f} | {differ} |")
    return "\n".join(rows)


def _functions(t: float) -> list:
    return [lambda s: float(s.pressure(t)), lambda s: float(s.liquid_density(t)), lambda s: float(s.vapor_density(t))]


def energy(source: Saturation, mass: float, t: float, volume: float) -> float:
    """Internal energy of a saturated tank [J]."""
    parts = split(source, volume, mass, t)
    u_l, u_v = (float(source.energy(p, t)[0]) for p in (Property.LIQUID_ENERGY, Property.VAPOR_ENERGY))
    return parts.liquid * u_l + parts.vapor * u_v


def closure() -> str:
    """A liquid blowdown from 54.8 bar with either source: when it ends, where the pressure is then."""
    rows = ["| source | liquid out | pressure then | energy left over of that which left |", "|---|---|---|---|"]
    volume, mass = 16.5e-3, 8.0
    time = np.arange(0.0, 6.0, 1e-3)
    for name in ("coolprop", "report"):
        source = saturation(name)
        t0 = float(source.temperature(54.8e5))
        run = blow_down(source, FeedSystem(volume, 2.02e-5, 6e8), mass, t0, time, np.full(time.size, 11e5), 1.1)
        wet = time < run.t_v
        t, m = run.temperature[wet], run.mass[wet]
        h = source.energy(Property.LIQUID_ENTHALPY, t)[0]
        left = float(np.sum(0.5 * (h[1:] + h[:-1]) * -np.diff(m)))
        error = energy(source, m[-1], t[-1], volume) - energy(source, m[0], t[0], volume) + left
        rows.append(f"| {name} | {run.t_v:.3f} s | {run.pressure[wet][-1] / 1e5:.2f} bar | {error / left:+.1e} |")
    return "\n".join(rows)


def main() -> None:
    """Write the page."""
    tables = f"## Report against CoolProp\n\n{differences()}\n\n## The same tank with either\n\n{closure()}\n"
    tables += f"\n{DEPARTURES}\n{departures()}\n"
    text = f"{INTRODUCTION}\n{tables}"
    PAGE.write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
