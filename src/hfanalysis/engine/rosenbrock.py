"""Rodas5P, the linearly implicit method that integrates the engine, and the small linear algebra it needs.

Order 5, eight stages, stiffly accurate, with an embedded error estimate and a fourth-order interpolant.
Coefficients: G. Steinebach, Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks within the
Julia Differential Equations package, BIT Numerical Mathematics 63 (2023) 27, in the transformed form of Hairer and
Wanner, Solving Ordinary Differential Equations II, section IV.7: every stage solves (1/(h gamma) - J) u_i = f(y +
sum a_ij u_j) + sum c_ij u_j / h + h d_i f_t.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.compiled import inner

STAGES = 8
"""Of Rodas5P. Source: Steinebach 2023."""

GAMMA = 0.21193756319429014
"""Diagonal coefficient of Rodas5P [-]. Source: Steinebach 2023."""


def _lower(rows: list[list[float]]) -> Array:
    out = np.zeros((STAGES, STAGES))
    for i, row in enumerate(rows):
        out[i, : len(row)] = row
    return out


_LAST = [-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946]
"""Row of a_ij that the last three stages share [-]. Source: Steinebach 2023, transformed."""

A = _lower(
    [
        [],
        [3.0],
        [2.849394379747939, 0.45842242204463923],
        [-6.954028509809101, 2.489845061869568, -10.358996098473584],
        [2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641],
        _LAST,
        [*_LAST, 1.0],
        [*_LAST, 1.0, 1.0],
    ]
)
"""Coefficients a_ij [-]. Source: Steinebach 2023, transformed."""

C = _lower(
    [
        [],
        [-14.155112264123755],
        [-17.97296035885952, -2.859693295451294],
        [147.12150275711716, -1.41221402718213, 71.68940251302358],
        [165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306],
        [24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471],
        [30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783, -19.097331116725623,
         -28.087943162872662],
        [37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047, -40.06618937091002,
         -54.66780262877968, -9.48861652309627],
    ]
)  # fmt: skip
"""Coefficients c_ij [-]. Source: Steinebach 2023, transformed."""

TIME = np.array([0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0, 1.0])
"""Where in a step its stages lie [-]. Source: Steinebach 2023."""

TIME_SLOPE = np.array(
    [
        0.21193756319429014,
        -0.42387512638858027,
        -0.3384627126235924,
        1.8046452872882734,
        2.325825639765069,
        0.0,
        0.0,
        0.0,
    ]
)
"""Coefficients d_i of f_t [-]. Source: Steinebach 2023."""

DENSE = np.array(
    [
        [25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204, 0.524948541321073,
         1.1241088310450404, 0.4272876194431874, -0.17202221070155493],
        [-9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796, 20.176138334709044,
         15.98066361424651, -6.789040303419874, -6.710236069923372],
        [11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643, -52.072871366152654,
         -59.78993625266729, -0.15582684282751913, 4.883087185713722],
    ]
)  # fmt: skip
"""Interpolant: y(theta) = (1-theta) y_0 + theta (y_1 + (1-theta)(d_0 + theta (d_1 + theta d_2))), d_k = sum DENSE_ki
u_i. Source: Steinebach 2023."""


@inner
def copy(source: Array, target: Array, count: int) -> None:
    """The first ``count`` numbers of an array into another (numba takes seconds to compile assignments of slices)."""
    a, b = source.reshape(-1), target.reshape(-1)
    for i in range(count):
        b[i] = a[i]


@inner
def factorize(a: Array, pivots: NDArray[np.int64]) -> bool:
    """LU factors of ``a`` (n, n) with partial pivoting in place, ``pivots`` (n,) the row swaps; False for a singular
    matrix."""
    n = a.shape[0]
    for k in range(n):
        best, row = abs(a[k, k]), k
        for i in range(k + 1, n):
            if abs(a[i, k]) > best:
                best, row = abs(a[i, k]), i
        if not best > 0.0:
            return False
        pivots[k] = row
        if row != k:
            for j in range(n):
                a[k, j], a[row, j] = a[row, j], a[k, j]
        inverse = 1.0 / a[k, k]
        for i in range(k + 1, n):
            factor = a[i, k] * inverse
            a[i, k] = factor
            if factor != 0.0:
                for j in range(k + 1, n):
                    a[i, j] -= factor * a[k, j]
    return True


@inner
def substitute(lu: Array, pivots: NDArray[np.int64], b: Array) -> None:
    """Solve for ``b`` (n,) with the factors ``lu`` (n, n) of :func:`factorize`, in place."""
    n = lu.shape[0]
    for k in range(n):
        if pivots[k] != k:
            b[k], b[pivots[k]] = b[pivots[k]], b[k]
    for i in range(1, n):
        total = b[i]
        for j in range(i):
            total -= lu[i, j] * b[j]
        b[i] = total
    for i in range(n - 1, -1, -1):
        total = b[i]
        for j in range(i + 1, n):
            total -= lu[i, j] * b[j]
        b[i] = total / lu[i, i]


@inner
def interpolate(theta: float, y0: Array, y1: Array, dense: Array, y: Array) -> None:
    """The state at a fraction ``theta`` of a step, into ``y`` (states,); ``dense`` has the shape (3, states)."""
    rest = 1.0 - theta
    for i in range(y.size):
        inner = y1[i] + rest * (dense[0, i] + theta * (dense[1, i] + theta * dense[2, i]))
        y[i] = rest * y0[i] + theta * inner
