"""Why errors that no test of their room notices are left as they are, by a part of their names."""

from __future__ import annotations

FLOOR = "a floor against division by nothing: no engine comes near it, so that nothing changes"
FINER = "how finely something is stepped or tabulated: numbers move by less than they are known to"
ALL_ALIKE = "a size that is known to no better than this factor: the fit finds the same, a little sooner or later"

EXPLAINED: dict[str, str] = {
    "efficiencies: 1e-4": FLOOR,
    "flight/ascent.py: PAD": "a rocket has left its pad at a millimeter or at a tenth of one",
    "IMPULSE_TOLERANCE: 5e-4 x 0.1": "a thinned curve keeps its impulse better than it has to, by more points",
    "flight/pitch.py: MACH_STEP": FINER,
    "flight/pitch.py: _fly: 1.0": "from when on a fall ends the ascent: no rocket falls within two seconds of lighting",
    "flight/pitch.py: _rates: 1e-6": FLOOR,
    "flight/pitch.py: _rates: 1e-9": FLOOR,
}
