"""What a feed line loses whose pressure before the injector was not logged: estimated, and said so."""

from __future__ import annotations

import numpy as np

from hfanalysis.calibrate.loaded_mass import load_cell_mass
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.thermo.saturation import Saturation
from hfanalysis.units import Value

USUAL_SHARE = Value(0.25, 0.12)
"""Part [-] of p_tank - p_chamber that a line with its valves loses, and its standard deviation. Evidence: 0.20 of HF4,
0.33 of HF5; two deviations leave room for next to none and for half."""

LEAST_SHARE = 0.02
"""Standard deviation [-] at least: the loss that a stated K_loss makes goes by a mean flow."""


def estimated_share(
    log: TestLog, segments: Segments, definition: TestDefinition, saturation: Saturation
) -> tuple[Value, str]:
    """Which part [-] of p_tank - p_chamber the feed line loses in the liquid phase, and in words where that is from."""
    by_loss = _by_loss(log, segments, definition, saturation)
    share, source = (by_loss, "from [feed] K_loss and the mean flow") if by_loss else (USUAL_SHARE, "as feed lines do")
    percent, spread = 100.0 * share.value, 100.0 * (share.std or 0.0)
    lost = f"{percent:.0f} +/- {spread:.0f} % of p_tank - p_chamber, {source}"
    return share, f"p_run is not logged: the feed line is taken to lose {lost}"


def _by_loss(log: TestLog, segments: Segments, definition: TestDefinition, saturation: Saturation) -> Value | None:
    """By the stated K_loss, at the mean flow of a liquid phase that ends with vapor alone; None without it."""
    t_v, feed, tank = segments.time("t_v"), definition.feed, definition.tank
    if feed is None or feed.K_loss is None or tank is None or tank.volume is None or not t_v:
        return None
    cell = load_cell_mass(log, segments)
    mass = tank.oxidizer_mass.value if tank.oxidizer_mass is not None else cell[0] if cell is not None else None
    origin = segments.t_open.value or 0.0
    pressure = Signal.of(log["p_tank"]).shifted(origin)
    chamber = Signal.of(log["p_chamber"]).shifted(origin).mean(0.0, t_v) if "p_chamber" in log else 1e5
    middle = pressure.mean(0.0, t_v)
    warm, dry = (float(saturation.temperature(p)) for p in (middle, pressure.around(t_v, 0.1)))
    if mass is None or not np.isfinite([warm, dry, chamber]).all():
        return None
    flow = (mass - tank.volume.value * float(saturation.vapor_density(dry))) / t_v
    loss = feed.K_loss.value * flow**2 / float(saturation.liquid_density(warm))
    share = loss / (middle - chamber)
    if not 0.0 <= share < 0.95:
        return None
    relative = (feed.K_loss.std or 0.0) / max(feed.K_loss.value, 1e-9)
    return Value(share, max(share * relative, LEAST_SHARE))
