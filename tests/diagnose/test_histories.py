"""What diagnosis.h5 holds."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import h5py
from tests.diagnose.naming.test_naming import catalogue
from tests.inference import made
from tests.products.cf import check

from hfanalysis.diagnose.naming.naming import name_effects
from hfanalysis.diagnose.product_histories import write_histories


def test_an_effect_and_an_unknown_source_beside_it_may_have_the_same_name(tmp_path: Path) -> None:
    """tank_heat is both: with both in the answer the file could not be written, and the diagnosis was lost."""
    naming = name_effects(made.hypothesis(), made.observed(), catalogue(("load_cell_drift",)))
    band = {"unit": "W", "time": [0.0, 1.0], "low90": [0.0, 0.0], "high90": [9.0, 9.0]}
    rows = [
        SimpleNamespace(site="tank_heat", equation="tank_energy", history=SimpleNamespace(**band, mean=[size, size]))
        for size in (5.0, 2.0)
    ]
    found = SimpleNamespace(
        naming=naming, verdict=SimpleNamespace(chosen=naming.base), product=SimpleNamespace(localisation=rows)
    )
    write_histories(tmp_path / "diagnosis.h5", found, {})  # type: ignore[arg-type]
    check(tmp_path / "diagnosis.h5")
    with h5py.File(tmp_path / "diagnosis.h5") as file:
        assert set(file["sources"]) == {"tank_heat", "tank_heat 2"}
        assert [file[f"sources/{name}/mean"][0] for name in ("tank_heat", "tank_heat 2")] == [5.0, 2.0]
        assert set(file["residuals"]) == {channel.name for channel in naming.bench.observed.channels}
