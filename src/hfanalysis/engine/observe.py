"""What the sensors of a test read of a run: canonical channels, with the distortions of sensor effects.

A distortion takes all channels on common times and gives them back changed; several act in the order of their names,
as terms do.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Active
from hfanalysis.engine.equations import OUTPUTS, STATES
from hfanalysis.engine.sensitivity import SHIFT, Tangents
from hfanalysis.engine.unsteady import Burn

CHANNELS = {
    "p_tank": ("tank_pressure",),
    "p_run": ("run_pressure",),
    "p_chamber": ("chamber_pressure",),
    "thrust": ("thrust",),
    "m_tank": ("tank_mass", "tank_nitrogen"),
}
"""Canonical channels and the outputs or states whose sum they show [Pa, N, kg]; a tank's scale weighs its nitrogen."""

SMALL = 1e-6
"""By how much channels are moved, relative to their span [-], to find a distortion's slope."""


def observe(burn: Burn, times: ArrayLike, effects: Sequence[Active] | None = None) -> dict[str, Array]:
    """Channels [Pa, N, kg], (n,) each, at increasing ``times`` [s], (n,), as sensors read them.

    ``effects`` (default: the engine's own) may be of any kind; those that distort are applied.
    """
    where = np.ascontiguousarray(times, dtype=np.float64)
    return distorted(true_channels(burn, where), where, _chosen(burn, effects))


def true_channels(burn: Burn, times: Array) -> dict[str, Array]:
    """Channels [Pa, N, kg], (n,) each, at ``times`` [s], (n,), without any distortion."""
    states, outputs = burn.steps.at(times)
    values = dict(zip(STATES, states.T, strict=False)) | dict(zip(OUTPUTS, outputs.T, strict=True))
    return {channel: np.sum([values[name] for name in names], axis=0) for channel, names in CHANNELS.items()}


def distorted(channels: Mapping[str, Array], times: Array, effects: Sequence[Active]) -> dict[str, Array]:
    """Channels [Pa, N, kg], (n,) each, as the distorting effects among ``effects`` leave them, in canonical order.

    ``times`` [s], (n,).
    """
    out = dict(channels)
    for active in _distorting(effects):
        if not active.idle and active.effect.distort is not None:
            out = active.effect.distort(times, out, active.named)
    return out


def read_as(
    models: Mapping[str, Array], times: Array, effects: Sequence[Active], beside: Mapping[str, Array] | None = None
) -> dict[str, Array]:
    """Modeled channels [Pa, N, kg], (n,) each, not all of them, as distorting effects let sensors read them.

    ``times`` [s], (n,); ``beside``: other channels that are known.
    """
    full = {**{name: np.zeros(times.size) for name in CHANNELS}, **(beside or {}), **models}
    found = distorted(full, times, effects)
    return {name: found[name] for name in models}


def observe_tangents(tangents: Tangents, times: ArrayLike, effects: Sequence[Active] | None = None) -> dict[str, Array]:
    """Sensitivities (times, parameters) of every channel of :func:`observe` [Pa, N, kg] to ``tangents.parameters``
    [SI].

    ``times`` [s] are increasing. Parameters of distorting effects are among them where ``tangents`` names them
    ("EFFECT.PARAMETER"): a distortion passes on the model's sensitivities and adds those of its own parameters, of
    strength 0 too.
    """
    where = np.ascontiguousarray(times, dtype=np.float64)
    channels, slopes = true_channels(tangents.burn, where), true_tangents(tangents, where)
    return distorted_tangents(channels, slopes, where, _chosen(tangents.burn, effects), tangents.parameters)


def true_tangents(tangents: Tangents, times: Array) -> dict[str, Array]:
    """Sensitivities (times, parameters) of :func:`true_channels` [Pa, N, kg per SI] at ``times`` [s]."""
    return {
        channel: np.sum([tangents.output(name, times) for name in names], axis=0) for channel, names in CHANNELS.items()
    }


def distorted_tangents(
    channels: Mapping[str, Array],
    slopes: dict[str, Array],
    times: Array,
    effects: Sequence[Active],
    names: tuple[str, ...],
) -> dict[str, Array]:
    """Sensitivities (times, parameters) [Pa, N, kg per SI] to the parameters ``names`` behind the distortions.

    ``channels`` (times,) and ``slopes`` (times, parameters) are what comes before them, at ``times`` [s].
    """
    for active in _distorting(effects):
        slopes = _passed_on(active, times, channels, slopes, names)
        channels = distorted(channels, times, [active])
    return slopes


def _passed_on(
    active: Active, times: Array, channels: Mapping[str, Array], slopes: Mapping[str, Array], names: tuple[str, ...]
) -> dict[str, Array]:
    """Slopes behind one distortion: along those before it, and by its own parameters."""
    base = distorted(channels, times, [active])
    out = {channel: np.empty_like(slope) for channel, slope in slopes.items()}
    for column, name in enumerate(names):
        along = {channel: slope[:, column] for channel, slope in slopes.items()}
        step = _step_along(channels, along)
        nudged = {channel: values + step * along[channel] for channel, values in channels.items()}
        moved, own = distorted(nudged, times, [active]), _own(active, name, times, channels, base)
        for channel in out:
            out[channel][:, column] = (moved[channel] - base[channel]) / step + own.get(channel, 0.0)
    return out


def _step_along(channels: Mapping[str, Array], along: Mapping[str, Array]) -> float:
    most = max(float(np.abs(along[name]).max()) / (float(np.ptp(channels[name])) + 1e-300) for name in channels)
    return SMALL / most if most > 0.0 else 1.0


def _own(
    active: Active, name: str, times: Array, channels: Mapping[str, Array], base: Mapping[str, Array]
) -> dict[str, Array]:
    """Slopes of the channels by a parameter of this distortion; none for those of others."""
    effect, _, parameter = name.partition(".")
    names = [p.name for p in active.effect.parameters]
    if effect != active.effect.name or active.effect.distort is None:
        return {}
    where = names.index(parameter)
    step = SHIFT * active.effect.parameters[where].typical
    values = {**active.named, parameter: active.values[where] + step}
    moved = active.effect.distort(times, dict(channels), values)
    return {channel: (moved[channel] - base[channel]) / step for channel in base}


def _distorting(effects: Sequence[Active]) -> list[Active]:
    return sorted((a for a in effects if a.effect.distort is not None), key=lambda a: a.effect.name)


def _chosen(burn: Burn, effects: Sequence[Active] | None) -> Sequence[Active]:
    return burn.steps.engine.effects if effects is None else effects
