"""Errors by hand: each is one that a reader of the numbers would not see.

They are named by the symbol in whose definition they are and by its text, so that they follow code that moves.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from benchmarks.mutants.mutant import Edit, Mutant, places, source

BELIEVABLE = re.compile(r'Believable\(\s*"\w+",\s*([\d.e-]+)')
"""The largest size that is believed of an effect, in its definition."""


@dataclass(frozen=True)
class Error:
    """``new`` for ``old`` in the definition of ``symbol``; ``beside``: text of the module, where several define it."""

    name: str
    symbol: str
    old: str
    new: str
    beside: str = ""

    def mutant(self) -> Mutant:
        """Where it is now. Raises LookupError where it is not just once."""
        found = [
            (file, start + source(file)[start:end].index(self.old))
            for file, start, end in places(self.symbol)
            if source(file)[start:end].count(self.old) == 1 and self.beside in source(file)
        ]
        if len(found) != 1:
            raise LookupError(f"{self.name}: {self.old!r} in {self.symbol} is in {len(found)} places, not in one")
        file, at = found[0]
        return Mutant(self.name, "by hand", Edit(file, at, at + len(self.old), self.new))


CATALOGUE = (
    Error("n_std_doubled", "_Told", "return 0.5 *", "return 1.0 *", "judge_regression"),
    Error("span_error_a_fifth", "SPAN_SHARE", "0.7071", "0.14"),
    Error("drift_course_doubled", "ANY_COURSE", "12.0", "3.0"),
    Error("drift_left_in_doubled", "CellError", "0.5 * self.left", "self.left"),
    Error("gain_without_calibration", "GAIN", "0.01", "0.001", "GAIN_IN_PLACE"),
    Error("model_specific_impulse_without_fuel", "_Column", "(oxidizer + fuel)", "oxidizer"),
    Error("peak_smoothed_over_0.3_s", "SMOOTHING", "0.1", "0.3", "_raw_integral"),
    Error("m_shot_to_40_percent", "VAPOR_PRESSURE_SHARE", "0.6", "0.4"),
    Error("nitrogen_cv", "NITROGEN_CV", "2.5", "3.5"),
    Error("purge_heat_by_cv", "CP", "NITROGEN_CV + SPECIFIC_NITROGEN", "NITROGEN_CV"),
    Error("port_radius_power", "opened", "power = 2.0 * n + 1.0", "power = 2.0 * n"),
    Error("port_pace_power", "pace_between", "power = 2.0 * n + 1.0", "power = 2.0 * n"),
    Error("crosswind_scatter_off", "rows", 'std["wind"] * normal[:, 8]', "0.0"),
    Error("wind_scatter_off", "rows", 'std["wind"] * normal[:, 7]', "0.0"),
    Error("dead_volume_twice", "engine_of_test", 'e=stated["pre_volume"] + stated["post_volume"]',
          'e=2.0 * (stated["pre_volume"] + stated["post_volume"])'),
    Error("dead_volume_twice_in_flight", "_gas_mass", "dead = sum", "dead = 2.0 * sum"),
    Error("dead_volume_twice_in_engine_files", "_dead_volume", "return ", "return 2.0 * "),
    Error("claim_threshold_doubled", "CLAIM", "0.15", "0.30"),
    Error("fewer_effects_threshold_doubled", "FEWER", "0.3", "0.6"),
    Error("air_gamma", "AIR_GAMMA", "1.4", "1.3"),
)  # fmt: skip


def catalogue() -> Iterator[Mutant]:
    """All of them. Raises LookupError where one is not in just one place."""
    for error in CATALOGUE:
        yield error.mutant()
    yield from _believed()


def _believed() -> Iterator[Mutant]:
    """Every effect's largest believable size ten times larger."""
    for file, start, end in places("EFFECT"):
        for found in BELIEVABLE.finditer(source(file), start, end):
            yield Mutant(
                f"believable_{file.stem}_ten_times", "by hand", Edit(file, *found.span(1), f"10.0 * {found.group(1)}")
            )
