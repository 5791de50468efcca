"""Which instants of a model correspond to measured ones: those of its phases to those of the measurement's.

Between two instants of t_v the one is liquid and the other vapor, and no slope tells how to bring them together; how
far apart they are is an observation of its own. So the model is laid over the measurement from knee to knee. The end
of the fuel, where what follows it is compared, is the measured one in both.
"""

from __future__ import annotations

import numpy as np

from hfanalysis.arrays import Array

MOST_MOVED = 0.5
"""Part of the time between the ends of liquid and fuel by which the one may be off and the other still stay."""


def model_times(times: Array, seen: float, gone: float, fuel_out: float | None = None) -> Array:
    """Instants (n,) [s] of a model whose liquid is ``gone`` that correspond to measured ``times`` (n,), whose liquid
    was ``seen`` to end; all [s after the opening].

    Stretched up to there and shifted from there on; with ``fuel_out`` [s] that instant stays where it is and the times
    between it and the end of the liquid are stretched.

    >>> model_times(np.array([1.0, 4.0, 6.0]), seen=4.0, gone=4.2).round(9).tolist()
    [1.05, 4.2, 6.2]
    """
    if fuel_out is None or not stays(seen, gone, fuel_out):
        return np.where(times < seen, times * gone / seen, times + gone - seen)
    return np.asarray(times + (gone - seen) * share(times, seen, gone, fuel_out))


def share(times: Array, seen: float, gone: float, fuel_out: float | None = None) -> Array:
    """Derivative (n,) [-] of :func:`model_times` with ``gone``; arguments [s after the opening] as there.

    >>> share(np.array([1.0, 4.0, 6.0]), seen=4.0, gone=4.2).tolist()
    [0.25, 1.0, 1.0]
    """
    if fuel_out is None or not stays(seen, gone, fuel_out):
        return np.asarray(np.clip(times / seen, 0.0, 1.0))
    knots = np.array(sorted([(0.0, 0.0), (seen, 1.0), (fuel_out, 0.0)]))
    return np.asarray(np.interp(times, knots[:, 0], knots[:, 1]))


def stays(seen: float, gone: float, fuel_out: float) -> bool:
    """Whether the end of the fuel can stay: the model's liquid ends on the same side of it, and well apart; all [s
    after the opening]."""
    return abs(gone - seen) < MOST_MOVED * abs(fuel_out - seen)
