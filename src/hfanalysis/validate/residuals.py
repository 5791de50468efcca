"""Residuals of a model run: per sample with noise level and phase, on disk and in figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.products.segments import Segments
from hfanalysis.products.validation import PhaseGap
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal

PHASES = ("before", "filling", "liquid", "vapor", "nitrogen")
"""Phases by their number in ``residuals.h5``: before the opening, line filling, liquid, pure vapor, with nitrogen."""

LONG_NAMES = {
    "measured": "measured",
    "model": "model",
    "residual": "measured minus model",
    "noise_std": "standard deviation of a sample's noise",
}


@dataclass(frozen=True)
class Residual:
    """One channel in one mode: arrays of one length; ``unit`` of all but ``time`` [s]; ``phase`` indexes PHASES."""

    channel: str
    unit: str
    time: Array
    measured: Array
    model: Array
    noise_std: Array
    phase: NDArray[np.int8]
    notes: tuple[str, ...] = ()

    @property
    def residual(self) -> Array:
        """Measured minus model, (n,) [``unit``]."""
        return self.measured - self.model


def compared(
    log: TestLog, segments: Segments, name: str, time: Array, model: Array, notes: tuple[str, ...] = ()
) -> Residual:
    """A channel's good samples between the first and the last of ``time`` (n,) [s], against a ``model`` (n,) given
    there.

    ``model`` is in the channel's unit [SI]; times count from the opening. Raises :class:`AbsentError` without the
    channel.
    """
    origin = segments.t_open.value or 0.0
    signal = Signal.of(log[name]).shifted(origin)
    part = signal.between(time[0], time[-1] + 1e-9)
    phase = phases_of(part.time, segments.time("t_feed") or 0.0, segments.time("t_v"), segments.time("t_purge"))
    at = np.interp(part.time, time, model)
    noise = np.full(part.time.size, signal.noise)
    return Residual(name, log[name].unit, part.time, part.value, at, noise, phase, notes)


def phases_of(time: Array, t_feed: float, t_v: float | None, t_purge: float | None) -> NDArray[np.int8]:
    """The phase (n,) of each sample at ``time`` (n,) [s]; nitrogen counts from ``t_purge`` [s], also where liquid is
    left.

    >>> phases_of(np.array([-1.0, 0.1, 2.0, 6.0, 9.0]), 0.5, 5.0, 8.0).tolist()
    [0, 1, 2, 3, 4]
    """
    phase = np.where(time < 0.0, 0, np.where(time < t_feed, 1, 2))
    if t_v is not None:
        phase = np.where(time >= t_v, 3, phase)
    if t_purge is not None:
        phase = np.where(time >= t_purge, 4, phase)
    return phase.astype(np.int8)


def gaps(residuals: Sequence[Residual]) -> dict[str, dict[str, PhaseGap]]:
    """Per channel and phase: root mean square, bias and noise floor of the residual, in the channel's unit."""
    out = {}
    for r in residuals:
        phases = {}
        for number, name in enumerate(PHASES):
            part = (r.phase == number) & np.isfinite(r.residual)
            if not part.any():
                continue
            x = r.residual[part]
            phases[name] = PhaseGap(
                rms=float(np.sqrt(np.mean(x**2))),
                bias=float(x.mean()),
                noise=float(np.sqrt(np.mean(r.noise_std[part] ** 2))),
                samples=int(part.sum()),
                unit=r.unit,
            )
        out[r.channel] = phases
    return out


def write_residuals(path: Path, modes: Mapping[str, Sequence[Residual]], provenance: Mapping[str, Any]) -> None:
    """Write residuals.h5: a group per mode and channel, for h5py, xarray and MATLAB; byte-identical each time."""
    from hfanalysis.products import netcdf

    with netcdf.product(path, "residuals: measured minus model", provenance) as file:
        for mode, residuals in modes.items():
            for residual in residuals:
                _write_channel(file.create_group(f"{mode}/{residual.channel}"), residual)


def _write_channel(group: Any, residual: Residual) -> None:
    from hfanalysis.products import netcdf

    netcdf.axis(group, "time", residual.time)
    for name, words in LONG_NAMES.items():
        netcdf.variable(group, name, getattr(residual, name), (residual.unit, f"{residual.channel}: {words}"))
    phase = netcdf.variable(group, "phase", residual.phase, ("1", "phase of the test"))
    phase.attrs.update(flag_values=np.arange(len(PHASES), dtype=np.int8), flag_meanings=" ".join(PHASES))
