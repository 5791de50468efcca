"""Equilibrium combustion as a smooth table over pressure, mixture, oxidizer enthalpy and nitrogen, for compiled code.

Tabulated are ln(R T), gamma and ln(T) of the chamber gas. Two kinks are kept where they belong: the carbon edge, richer
than which condensed carbon exists, and stoichiometry, which heavy dilution sharpens from a hilltop into a kink. Both
lie on nodes of the grid, for mixtures are counted between them:

    x = ln(nitrous oxide / fuel by mass),   E(ln p, h, share): the carbon edge,   S: stoichiometry

    zone 0: rich of E     zone 1: E to midway     zone 2: midway to S     zone 3: lean of S

Each zone has the same number of nodes, spaced quadratically away from its kink. Cubic Hermite polynomials run along x
and ln p, and along the nitrogen share in a stretched coordinate; their slopes are those of cubic splines, one-sided at
the kinks. The oxidizer's enthalpy enters by a cubic through four levels: away from the kinks' own motion, which E
holds, its effect is nearly linear.

Beyond the table the nearest mixture, pressure and share are held; mixtures richer than ``MIXTURES`` (cold fuel vapor,
hardly any oxidizer) have no equilibrium in CEA's range of temperatures.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled, inlined
from hfanalysis.errors import AbsentError
from hfanalysis.thermo import combustion
from hfanalysis.thermo.cache import cached
from hfanalysis.thermo.combustion import PROPEP_OXIDIZER_ENTHALPY, equilibrium
from hfanalysis.thermo.fuels import PARAFFIN, Fuel

Four = tuple[float, float, float, float]
Shares = tuple[int, int, Four]
Place = tuple[int, Four, Four, Four, Four, float]
Grid = tuple[Array, Array, Array, float]
"""Nodes (see :func:`_place`), their slopes along the share, the carbon edge, and what mixtures are shifted by."""

PRESSURES = (0.2e5, 120e5)
"""Range in p [Pa]. Evidence: random mixtures from 0.3 to 100 bar, inside it, are checked against direct equilibria
(docs/combustion.md)."""

MIXTURES = (0.1, 1000.0)
"""Range in nitrous oxide over fuel [-]. Evidence: richer mixtures (cold fuel vapor, hardly any oxidizer) have no
equilibrium in CEA's range of temperatures."""

ENTHALPIES = (1.40e6, 1.53e6, 1.71e6, PROPEP_OXIDIZER_ENTHALPY)
"""Levels of the entering nitrous oxide on the formation scale [J/kg]: liquid at 188 K to PROPEP's gas. Evidence: a
cubic through four of them is as good as docs/combustion.md says, against direct equilibria at any enthalpy between."""

SHARE = 0.98
"""Highest mass fraction of nitrogen in what comes through the injector [-]. Evidence: up to it the table errs by 1.1e-3
at most (docs/combustion.md)."""

STRETCH = 0.25
"""Shares are spaced evenly in -ln(1 - share + STRETCH) [-]: the temperature falls as 1 - share. Evidence:
docs/combustion.md has what the table errs by at every share of nitrogen."""

STOICHIOMETRIC = PARAFFIN.stoichiometric
"""Nitrous oxide over paraffin by mass [-]. Source: C20H42 + 61 N2O -> 20 CO2 + 21 H2O + 61 N2. The mixtures of another
fuel are shifted until its stoichiometry lies there."""

NUDGES = (0.0, 1e-7, -1e-7, 1e-5, -1e-5)
"""Steps in x tried where CEA does not converge."""

ROWS = 3
"""How many numbers a node has."""

LN_RT, GAMMA, LN_T = 0, 1, 2
"""Rows of a node: ln(R T), R T in J/kg; gamma; ln(T), T in K."""

ZONES = 4
"""Zones of the mixture between the kinks."""

LEVELS = len(ENTHALPIES)

_P0, _P1 = float(np.log(PRESSURES[0])), float(np.log(PRESSURES[1]))
_X0, _X1 = float(np.log(MIXTURES[0])), float(np.log(MIXTURES[1]))
_S = float(np.log(STOICHIOMETRIC))
_H0, _H1, _H2, _H3 = ENTHALPIES
_L0 = 1.0 / ((_H0 - _H1) * (_H0 - _H2) * (_H0 - _H3))
_L1 = 1.0 / ((_H1 - _H0) * (_H1 - _H2) * (_H1 - _H3))
_L2 = 1.0 / ((_H2 - _H0) * (_H2 - _H1) * (_H2 - _H3))
_L3 = 1.0 / ((_H3 - _H0) * (_H3 - _H1) * (_H3 - _H2))
_Z1 = float(np.log((1.0 + STRETCH) / (1.0 - SHARE + STRETCH)))


@dataclass(frozen=True)
class Nodes:
    """How many nodes: in ln p, in each zone of the mixture, and in the nitrogen share."""

    pressures: int = 10
    mixtures: int = 28
    shares: int = 18

    @property
    def shape(self) -> tuple[int, ...]:
        """(shares, pressures, levels, ZONES * mixtures + 1, ROWS): in the last place of the mixtures, the edge."""
        return self.shares, self.pressures, LEVELS, ZONES * self.mixtures + 1, ROWS


@dataclass(frozen=True)
class CombustionTable:
    """The table of all mixtures of nitrous oxide and a ``fuel``; ``kernel`` is what :func:`gas_at` reads."""

    kernel: Grid
    fuel: Fuel = PARAFFIN


def build(nodes: Nodes = Nodes(), fuel: Fuel = PARAFFIN) -> CombustionTable:
    """The table, from the cache where it is there, else from CEA (some seconds, once for each fuel).

    Raises AbsentError where CEA is not installed.
    """
    samples = cached(_name(nodes, fuel), nodes.shape, lambda: sample(nodes, fuel))
    return CombustionTable((*_with_slopes(samples, nodes), shift_of(fuel)), fuel)


def _name(nodes: Nodes, fuel: Fuel) -> str:
    return f"combustion-cea-{made_by()}-{fuel.key}-{nodes.pressures}-{nodes.mixtures}-{nodes.shares}"


def shift_of(fuel: Fuel) -> float:
    """What is added to ln(nitrous oxide / fuel) so that stoichiometry lies where the table has it [-]."""
    return _S - float(np.log(fuel.stoichiometric))


def made_by() -> str:
    """The version of CEA's package. Raises AbsentError where it is not installed."""
    try:
        return version("cea")
    except PackageNotFoundError:
        raise AbsentError(
            "the chamber's gas is NASA's CEA's: its package (cea) is not installed, for Linux on ARM there is none"
        ) from None


def sample(nodes: Nodes, fuel: Fuel = PARAFFIN) -> Array:
    """All nodes straight from CEA, shape ``nodes.shape``: ln(R T [J/kg]), gamma, ln(T [K]); one that does not converge
    takes the previous one's values.

    CEA's own messages about that are kept from the terminal.
    """
    combustion.restart()
    with quietly():
        out = _sampled(nodes, fuel)
    combustion.restart()
    return out


def _sampled(nodes: Nodes, fuel: Fuel) -> Array:
    out = np.empty(nodes.shape)
    for k, share in enumerate(_shares(nodes.shares)):
        for level, enthalpy in enumerate(ENTHALPIES):
            edge = float(out[k - 1, 0, level, -1, 0]) if k else _S
            for i, p in enumerate(np.exp(np.linspace(_P0, _P1, nodes.pressures))):
                edge = carbon_edge(float(p), enthalpy, float(share), edge, fuel)
                out[k, i, level, :-1] = _column(float(p), edge, enthalpy, float(share), nodes.mixtures, fuel)
                out[k, i, level, -1] = edge
    return out


@contextmanager
def quietly() -> Iterator[None]:
    """Send what compiled code prints to nowhere; where there is no terminal to speak of, do nothing."""
    sys.stdout.flush()
    try:
        kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    except OSError:
        yield
        return
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def _shares(count: int) -> Array:
    shares = (1.0 + STRETCH) * -np.expm1(-np.linspace(0.0, _Z1, count))
    shares[0] = 0.0
    return np.asarray(shares)


def _column(pressure: float, edge: float, enthalpy: float, share: float, count: int, fuel: Fuel) -> Array:
    rows: list[tuple[float, ...]] = []
    for x in _mixtures(edge, count):
        try:
            rows.append(_node(pressure, float(x), enthalpy, share, fuel))
        except ArithmeticError:
            rows.append(rows[-1])
    return np.array(rows)


def _node(pressure: float, x: float, enthalpy: float, share: float, fuel: Fuel) -> tuple[float, float, float]:
    """A column's rows, if need be of a mixture a hair's breadth away: single points do not converge."""
    for aside in NUDGES:
        with suppress(ArithmeticError):
            gas = equilibrium(pressure, _ratio(x + aside, share, fuel), enthalpy, share, fuel)
            ln_t = float(np.log(gas.temperature))
            return float(np.log(gas.gas_constant)) + ln_t, gas.gamma, ln_t
    raise ArithmeticError(f"no equilibrium near {pressure / 1e5:.3g} bar and {np.exp(x):.3g} of oxidizer over fuel")


def _ratio(x: float, share: float, fuel: Fuel) -> float:
    """All that comes through the injector over fuel [-]."""
    return float(np.exp(x - shift_of(fuel))) / (1.0 - share)


def _mixtures(edge: float, count: int) -> Array:
    """x of every node: in each zone outwards from its kink."""
    graded, half = np.linspace(0.0, 1.0, count) ** 2, 0.5 * (_S - edge)
    zones = (edge - (edge - _X0) * graded, edge + half * graded, _S - half * graded, _S + (_X1 - _S) * graded)
    return np.concatenate(zones)


def carbon_edge(pressure: float, enthalpy: float, share: float, guess: float = _S, fuel: Fuel = PARAFFIN) -> float:
    """x [-] of the leanest mixture with condensed carbon: where its mass fraction, from the rich side, comes to
    nothing.

    At a ``pressure`` [Pa], ``enthalpy`` of the nitrous oxide [J/kg] and nitrogen ``share`` by mass. Two mixtures richer
    than the edge give the next guess, ever closer to it. Raises ArithmeticError where none is.
    """

    def carbon(x: float) -> float:
        return combustion.condensed_carbon(pressure, _ratio(x, share, fuel), enthalpy, share, fuel)

    for apart in (3e-2, 1e-3, 3e-5):
        while (near := carbon(guess - apart)) <= 0.0:
            guess -= 2.0 * apart
            if guess < _X0:
                raise ArithmeticError(f"no carbon edge at {pressure / 1e5:.3g} bar")
        guess += apart * (near / (carbon(guess - 2.0 * apart) - near) - 1.0)
    return guess


def _with_slopes(samples: Array, nodes: Nodes) -> tuple[Array, Array, Array]:
    """Spline slopes at the nodes, laid out as :func:`_place` reads them."""
    values, edges = samples[:, :, :, :-1], samples[:, :, :, -1, 0]
    along_p = _spline_slopes(np.linspace(0.0, nodes.pressures - 1.0, nodes.pressures))
    along_share = _spline_slopes(np.linspace(0.0, nodes.shares - 1.0, nodes.shares))
    tilted = _mixture_slopes(values, edges, nodes.mixtures)
    surface = np.stack([values, tilted], axis=-1)
    surface = np.concatenate([surface, np.einsum("ij,kjhxrc->kihxrc", along_p, surface)], axis=-1)
    # (share, pressure, x, level, row, coefficient): what one cell needs lies together
    surface = np.ascontiguousarray(surface.transpose(0, 1, 3, 2, 4, 5))
    drift = np.einsum("ij,jpxhrc->ipxhrc", along_share, surface)
    curve = np.stack([edges, np.einsum("ij,kjh->kih", along_p, edges)], axis=-1)
    curve = np.concatenate([curve, np.einsum("ij,jphc->iphc", along_share, curve)], axis=-1)
    flat = (-1, LEVELS * ROWS * 4)
    return surface.reshape(flat), np.ascontiguousarray(drift).reshape(flat), np.ascontiguousarray(curve)


def _mixture_slopes(values: Array, edges: Array, n: int) -> Array:
    """Along each zone's own coordinate, 0 at its kink and 1 at its far end; zones 1 and 2 are one curve."""
    graded = np.linspace(0.0, 1.0, n) ** 2
    outer = _spline_slopes(graded)
    inner = _spline_slopes(np.concatenate([graded, 2.0 - graded[-2::-1]]))
    out = np.empty_like(values)
    out[..., :n, :] = np.einsum("ij,...jr->...ir", outer, values[..., :n, :])
    between = np.concatenate([values[..., n : 2 * n, :], values[..., 3 * n - 2 : 2 * n - 1 : -1, :]], axis=-2)
    between = np.einsum("ij,...jr->...ir", inner, between)
    out[..., n : 2 * n, :] = between[..., :n, :]
    out[..., 2 * n : 3 * n, :] = -between[..., : n - 2 : -1, :]
    out[..., 3 * n :, :] = np.einsum("ij,...jr->...ir", outer, values[..., 3 * n :, :])
    _smooth_hilltop(out, edges, n)
    return out


def _smooth_hilltop(slopes: Array, edges: Array, n: int) -> None:
    """One slope at stoichiometry where both sides' splines agree; where dilution makes a kink of it, both stay."""
    half, whole = 0.5 * (_S - edges)[..., None], _X1 - _S
    left, right = -slopes[..., 2 * n, :] / half, slopes[..., 3 * n, :] / whole
    mean = np.where(abs(right - left) < SMOOTH, 0.5 * (left + right), np.nan)
    slopes[..., 2 * n, :] = np.where(np.isnan(mean), slopes[..., 2 * n, :], -mean * half)
    slopes[..., 3 * n, :] = np.where(np.isnan(mean), slopes[..., 3 * n, :], mean * whole)


SMOOTH = 0.01
"""Difference of slopes, d(ln R T)/dx and the like, up to which two splines describe one smooth curve."""


def _spline_slopes(x: Array) -> Array:
    """The matrix that turns values at ``x`` into slopes of their cubic spline (not-a-knot ends)."""
    n, h = x.size, np.diff(x)
    differences = (np.eye(n)[1:] - np.eye(n)[:-1]) / h[:, None]
    left, right = np.zeros((n, n)), np.zeros((n, n))
    for i in range(1, n - 1):
        left[i, i - 1 : i + 2] = h[i], 2.0 * (h[i - 1] + h[i]), h[i - 1]
        right[i] = 3.0 * (h[i] * differences[i - 1] + h[i - 1] * differences[i])
    for end, inner, a, b, da, db in (
        (0, 1, h[0], h[1], differences[0], differences[1]),
        (n - 1, n - 2, h[-1], h[-2], differences[-1], differences[-2]),
    ):
        left[end, end], left[end, inner] = b, a + b
        right[end] = ((a + 2.0 * (a + b)) * b * da + a * a * db) / (a + b)
    return np.asarray(np.linalg.solve(left, right))


@inlined
def _cell(x: float, count: int) -> tuple[int, float]:
    """Cell and position within it for ``x`` in units of nodes; ends held, and no number stays none."""
    x = min(max(x, 0.0), count - 1.0)
    i = min(int(x), count - 2) if x > 0.0 else 0
    return i, x - i


@inlined
def _hermite(t: float, width: float) -> Four:
    """Weights of value and slope at the near node of a cell and at the far one."""
    s = 1.0 - t
    return s * s * (1.0 + 2.0 * t), width * t * s * s, t * t * (3.0 - 2.0 * t), -width * t * t * s


@inlined
def _hermite_slope(t: float, width: float) -> Four:
    """Derivatives of :func:`_hermite` with the coordinate."""
    s = 1.0 - t
    return -6.0 * t * s / width, s * (1.0 - 3.0 * t), 6.0 * t * s / width, t * (3.0 * t - 2.0)


@inlined
def _levels(h: float) -> Four:
    """Weights of the cubic through the four levels of enthalpy."""
    a, b, c, d = h - _H0, h - _H1, h - _H2, h - _H3
    return _L0 * b * c * d, _L1 * a * c * d, _L2 * a * b * d, _L3 * a * b * c


@inlined
def _share_cell(share: float, count: int) -> Shares:
    """First level of the share, how many levels count, their weights; without nitrogen there is but the first."""
    if share <= 0.0:
        return 0, 1, (1.0, 0.0, 0.0, 0.0)
    stretched = np.log((1.0 + STRETCH) / (1.0 - min(share, SHARE) + STRETCH))
    k, t = _cell(stretched * ((count - 1) / _Z1), count)
    return k, 2, _hermite(t, 1.0)


@inlined
def _pressure_cell(ln_pressure: float, count: int) -> tuple[int, Four, Four]:
    """Cell, weights and their derivatives with ln p (none where the end is held)."""
    scale = (count - 1) / (_P1 - _P0)
    i, t = _cell((ln_pressure - _P0) * scale, count)
    if ln_pressure < _P0 or ln_pressure > _P1:
        return i, _hermite(t, 1.0), (0.0, 0.0, 0.0, 0.0)
    a, b, c, d = _hermite_slope(t, 1.0)
    return i, _hermite(t, 1.0), (scale * a, scale * b, scale * c, scale * d)


@inlined
def _zone(x: float, edge: float) -> tuple[int, float, float]:
    """Zone, coordinate from 0 at its kink to 1 at its far end, and the coordinate's derivative with the edge."""
    if x < edge:
        span = edge - _X0
        here = min((edge - x) / span, 1.0)
        return 0, here, (1.0 - here) / span
    if x >= _S:
        return 3, min((x - _S) / (_X1 - _S), 1.0), 0.0
    half = 0.5 * (_S - edge)
    here = (x - edge) / half
    if here < 1.0:
        return 1, here, (0.5 * here - 1.0) / half
    here = (_S - x) / half
    return 2, here, 0.5 * here / half


@inlined
def _mixture_cell(here: float, count: int) -> tuple[int, Four, Four]:
    """Cell of a zone, weights and their derivatives with the zone's coordinate."""
    j = min(int(np.sqrt(here) * (count - 1)), count - 2) if here > 0.0 else 0
    unit = 1.0 / ((count - 1) * (count - 1))
    width = (2 * j + 1) * unit
    t = (here - j * j * unit) / width
    return j, _hermite(t, width), _hermite_slope(t, width)


@inlined
def _edge(curve: Array, k: int, many: int, shares: Four, i: int, levels: Four) -> Four:
    """Carbon edge and its slope at the near and the far node of pressure."""
    e0 = e1 = e2 = e3 = 0.0
    for m in range(many):
        v, s = (shares[0], shares[1]) if m == 0 else (shares[2], shares[3])
        for h in range(LEVELS):
            value, slope = levels[h] * v, levels[h] * s
            e0 += value * curve[k + m, i, h, 0] + slope * curve[k + m, i, h, 2]
            e1 += value * curve[k + m, i, h, 1] + slope * curve[k + m, i, h, 3]
            e2 += value * curve[k + m, i + 1, h, 0] + slope * curve[k + m, i + 1, h, 2]
            e3 += value * curve[k + m, i + 1, h, 1] + slope * curve[k + m, i + 1, h, 3]
    return e0, e1, e2, e3


@inlined
def _blend(values: Array, n: int, row: int, levels: Four, weight: float) -> Four:
    """The four coefficients of a node's row at the enthalpy, times ``weight``."""
    a, b, c, d = 4 * row, 4 * (ROWS + row), 4 * (2 * ROWS + row), 4 * (3 * ROWS + row)
    r, u, v, w = weight * levels[0], weight * levels[1], weight * levels[2], weight * levels[3]
    return (
        r * values[n, a] + u * values[n, b] + v * values[n, c] + w * values[n, d],
        r * values[n, a + 1] + u * values[n, b + 1] + v * values[n, c + 1] + w * values[n, d + 1],
        r * values[n, a + 2] + u * values[n, b + 2] + v * values[n, c + 2] + w * values[n, d + 2],
        r * values[n, a + 3] + u * values[n, b + 3] + v * values[n, c + 3] + w * values[n, d + 3],
    )


@inlined
def _corner(nodes: Array, drift: Array, n: int, jump: int, many: int, shares: Four, levels: Four, row: int) -> Four:
    """Value, slopes along mixture and pressure, and the mixed one at a node; ``jump`` nodes on is the next share."""
    f = _blend(nodes, n, row, levels, shares[0])
    if many == 1:
        return f
    g = _blend(drift, n, row, levels, shares[1])
    h = _blend(nodes, n + jump, row, levels, shares[2])
    d = _blend(drift, n + jump, row, levels, shares[3])
    return f[0] + g[0] + h[0] + d[0], f[1] + g[1] + h[1] + d[1], f[2] + g[2] + h[2] + d[2], f[3] + g[3] + h[3] + d[3]


@inlined
def _bicubic(near0: Four, near1: Four, far0: Four, far1: Four, p: Four, x: Four) -> float:
    """Hermite sum over the four corners: near and far in pressure, 0 and 1 in mixture."""
    near = p[0] * (x[0] * near0[0] + x[1] * near0[1] + x[2] * near1[0] + x[3] * near1[1])
    near_slope = p[1] * (x[0] * near0[2] + x[1] * near0[3] + x[2] * near1[2] + x[3] * near1[3])
    far = p[2] * (x[0] * far0[0] + x[1] * far0[1] + x[2] * far1[0] + x[3] * far1[1])
    far_slope = p[3] * (x[0] * far0[2] + x[1] * far0[3] + x[2] * far1[2] + x[3] * far1[3])
    return near + near_slope + far + far_slope


@inlined
def _place(curve: Array, stride: int, ln_pressure: float, x: float, levels: Four, shares: Shares) -> Place:
    """The cell and the weights in it of a pressure and of a mixture ``x``.

    ``stride`` nodes, ZONES of them, follow each other along the mixture, then pressure, then share.
    """
    k, many, share = shares
    pressures, mixtures = curve.shape[1], stride // ZONES
    i, p, p_slope = _pressure_cell(ln_pressure, pressures)
    e = _edge(curve, k, many, share, i, levels)
    edge = p[0] * e[0] + p[1] * e[1] + p[2] * e[2] + p[3] * e[3]
    drifting = p_slope[0] * e[0] + p_slope[1] * e[1] + p_slope[2] * e[2] + p_slope[3] * e[3]
    zone, here, moving = _zone(x, edge)
    j, m, m_slope = _mixture_cell(here, mixtures)
    return (k * pressures + i) * stride + zone * mixtures + j, p, p_slope, m, m_slope, moving * drifting


@inlined
def _row(
    nodes: Array, drift: Array, stride: int, jump: int, place: Place, levels: Four, shares: Shares, row: int
) -> tuple[float, float]:
    """A row's value and its derivative with ln p, the motion of the carbon edge included."""
    n, p, p_slope, m, m_slope, moving = place
    _, many, share = shares
    a = _corner(nodes, drift, n, jump, many, share, levels, row)
    b = _corner(nodes, drift, n + 1, jump, many, share, levels, row)
    c = _corner(nodes, drift, n + stride, jump, many, share, levels, row)
    d = _corner(nodes, drift, n + stride + 1, jump, many, share, levels, row)
    slope = _bicubic(a, b, c, d, p_slope, m) + moving * _bicubic(a, b, c, d, p, m_slope)
    return _bicubic(a, b, c, d, p, m), slope


@inlined
def _oxidizer_to_fuel(ln_ratio: float, share: float, shift: float) -> float:
    """x, of the nitrous oxide alone."""
    return ln_ratio + shift if share <= 0.0 else ln_ratio + shift + np.log1p(-min(share, SHARE))


@compiled
def _at(
    table: Grid, ln_pressure: float, ln_ratio: float, enthalpy: float, share: float, row: int
) -> tuple[float, float]:
    """One row and its derivative with ln p."""
    nodes, drift, curve, shift = table
    stride = nodes.shape[0] // (curve.shape[0] * curve.shape[1])
    levels, shares = _levels(enthalpy), _share_cell(share, curve.shape[0])
    place = _place(curve, stride, ln_pressure, _oxidizer_to_fuel(ln_ratio, share, shift), levels, shares)
    return _row(nodes, drift, stride, stride * curve.shape[1], place, levels, shares, row)


@compiled
def gas_at(table: Grid, ln_pressure: float, ln_ratio: float, enthalpy: float, share: float) -> tuple[float, float]:
    """R T [J/kg] and gamma [-] of the chamber gas at ln p, p in [Pa].

    ``ln_ratio`` is that of all that comes through the injector to fuel, of which ``share`` is nitrogen by mass;
    ``enthalpy`` that of the nitrous oxide entering [J/kg].
    """
    nodes, drift, curve, shift = table
    stride = nodes.shape[0] // (curve.shape[0] * curve.shape[1])
    jump = stride * curve.shape[1]
    levels, shares = _levels(enthalpy), _share_cell(share, curve.shape[0])
    place = _place(curve, stride, ln_pressure, _oxidizer_to_fuel(ln_ratio, share, shift), levels, shares)
    ln_rt, _ = _row(nodes, drift, stride, jump, place, levels, shares, LN_RT)
    gamma, _ = _row(nodes, drift, stride, jump, place, levels, shares, GAMMA)
    return np.exp(ln_rt), gamma


@compiled
def temperatures(table: Grid, ln_pressure: Array, ln_ratio: Array, enthalpy: Array, share: Array) -> Array:
    """Temperature [K] of the chamber gas along a history, (n,); the solver itself only needs R T.

    The arguments are those of :func:`gas_at`, (n,) each.
    """
    out = np.empty(ln_pressure.size)
    for n in range(out.size):
        out[n] = np.exp(_at(table, ln_pressure[n], ln_ratio[n], enthalpy[n], share[n], LN_T)[0])
    return out


@compiled
def chamber_pressure(
    table: Grid, mass: float, volume: float, ln_ratio: float, enthalpy: float, share: float, guess: float
) -> tuple[float, float, float]:
    """p [Pa], R T [J/kg] and gamma [-] of a chamber of ``volume`` [m^3] holding ``mass`` [kg]: p V = m R T(p).

    The mixture's arguments are those of :func:`gas_at`, ``guess`` [Pa]. Newton's steps in ln p: R T hardly depends on p
    and its curvature in ln p is below 0.1, so that what follows a step of 1e-6 is round-off.
    """
    nodes, drift, curve, shift = table
    stride = nodes.shape[0] // (curve.shape[0] * curve.shape[1])
    jump = stride * curve.shape[1]
    levels, shares = _levels(enthalpy), _share_cell(share, curve.shape[0])
    x, here, target = _oxidizer_to_fuel(ln_ratio, share, shift), np.log(guess), np.log(mass / volume)
    place = _place(curve, stride, here, x, levels, shares)
    ln_rt, slope = _row(nodes, drift, stride, jump, place, levels, shares, LN_RT)
    step = (target + ln_rt - here) / (1.0 - slope)
    for _ in range(25):
        if abs(step) < 1e-6:
            break
        here += step
        place = _place(curve, stride, here, x, levels, shares)
        ln_rt, slope = _row(nodes, drift, stride, jump, place, levels, shares, LN_RT)
        step = (target + ln_rt - here) / (1.0 - slope)
    gamma, gamma_slope = _row(nodes, drift, stride, jump, place, levels, shares, GAMMA)
    rt = np.exp(ln_rt + slope * step)
    return mass * rt / volume, rt, gamma + gamma_slope * step
