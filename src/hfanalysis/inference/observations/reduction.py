"""The reduction of a log to what is compared: block means with their covariance, events, what was weighed."""

from __future__ import annotations

from dataclasses import replace

from hfanalysis.arrays import Array
from hfanalysis.errors import AbsentError
from hfanalysis.inference.observations.blocks import Blocks, blocks_of
from hfanalysis.inference.observations.burn_out import fade_of
from hfanalysis.inference.observations.burning import as_it_burns
from hfanalysis.inference.observations.channel import ObservedChannel, range_of
from hfanalysis.inference.observations.covariance import (
    channel_of,
    common_of,
    of_the_model,
    oscillations,
    zero_and_span,
)
from hfanalysis.inference.observations.flow_end import noted_flow_end
from hfanalysis.inference.observations.frame import Frame, events_of, frame_of, phases_of
from hfanalysis.inference.observations.observed import FADE, Observed
from hfanalysis.inference.observations.purge_line import PurgeLine, purge_line
from hfanalysis.inference.observations.recorded import ALIKE, recorded
from hfanalysis.inference.unknown import Samples
from hfanalysis.inference.unknowns import in_samples
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal


def observe_test(log: TestLog, segments: Segments, definition: TestDefinition) -> Observed:
    """Reduce a test to what is compared. Raises AbsentError where neither tank, chamber nor thrust is left."""
    origin = segments.t_open.value
    if origin is None:
        raise AbsentError("no opening was found: there is nothing to compare")
    burning = as_it_burns(log, segments, definition, origin)
    segments = burning.segments
    signals = recorded(log, definition, origin)
    frame = frame_of(log, segments, definition, origin, burning.shown)
    unknowns = in_samples(Samples(signals, segments, frame.steady, burning.shown))
    frame = replace(frame, hidden=max((unknown.hides for unknown in unknowns), default=0.0))
    zeros = {name: log[name].zero_std for name in signals}
    reduced = {name: blocks_of(signal, frame, zeros[name] is not None) for name, signal in signals.items()}
    blocks = {name: found for name, found in reduced.items() if found is not None}
    if not {"p_tank", "p_chamber", "thrust"} & set(blocks):
        raise AbsentError("neither tank, chamber nor thrust was recorded: the model cannot be compared")
    shaken = oscillations(blocks, frame)
    channels = {
        name: channel_of(
            means, definition, frame, shaken.get((name, name)), zero_and_span(means, definition, frame, zeros[name])
        )
        for name, means in blocks.items()
    }
    line = purge_line(log, segments, definition, origin, frame.ends["tank"])
    channels, alike = _with_second_look(channels, blocks.get(ALIKE[0]), line, definition, frame)
    end = frame.ends["chamber"]
    return Observed(
        tuple(channels.values()),
        frame.grid,
        frame.resting,
        events_of(segments, frame.ends["tank"]),
        _stated(definition, segments) | _fade(signals, segments),
        phases_of(segments, end),
        end,
        max(frame.ends["tank"], noted_flow_end(definition, end)),
        definition.ambient_pressure.value,
        common_of(blocks, shaken),
        alike,
        line.taken if line is not None and alike is not None else None,
        fuel_out=frame.fuel_out,
        flame_shown=burning.shown,
        unknowns=unknowns,
    )


def _with_second_look(
    channels: dict[str, ObservedChannel],
    of_tank: Blocks | None,
    line: PurgeLine | None,
    definition: TestDefinition,
    frame: Frame,
) -> tuple[dict[str, ObservedChannel], Array | None]:
    """The channels with the purge line behind the tank's pressure, and the covariance of both; as they are where the
    line tells nothing. What the model gets wrong of the tank is the same of the line."""
    means = None if line is None else blocks_of(line.signal, frame, False, line.start)
    if line is None or of_tank is None or means is None:
        return channels, None
    tank = channels[ALIKE[0]]
    errors = line.zero_and_span(means.value) + line.of_the_valve(means.time)
    own = channel_of(means, definition, frame, None, errors)
    own = replace(own, span=range_of(tank.time, tank.value))
    alike = line.with_tank(tank.value, own.value) + of_the_model(of_tank, frame) @ of_the_model(means, frame).T
    return {ALIKE[0]: tank, ALIKE[1]: own, **channels}, alike


def _fade(signals: dict[str, Signal], segments: Segments) -> dict[str, tuple[float, float]]:
    """The time in which the fire went out."""
    found = fade_of(signals, segments)
    return {} if found is None else {FADE: found}


def _stated(definition: TestDefinition, segments: Segments) -> dict[str, tuple[float, float]]:
    """What was seen or weighed after the test [SI], with its standard deviation."""
    seen = definition.observed
    if seen is None:
        return {}
    out = {}
    for name, least in (("throat_radius_after", 2e-5), ("fuel_mass_after", 5e-3)):
        value = getattr(seen, name)
        if name == "fuel_mass_after" and (segments.time("t_fuel_out") is not None or seen.burn_time is None):
            continue  # there is none left, or nobody knows until when it burnt
        if value is not None:
            out[name] = (float(value.value), max(float(value.std or 0.0), least))
    return out
