"""The record of predictions that were frozen before their tests: how many bands held, and how far they were off."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from hfanalysis.campaign.side_by_side import Ended
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.interface import predicting
from hfanalysis.products.campaign import Predicted
from hfanalysis.products.disk import read_json
from hfanalysis.products.prediction import Prediction
from hfanalysis.progress import Progress


def record(root: Path, tests: Mapping[str, Ended], out: Path | None, progress: Progress) -> dict[str, Predicted]:
    """Every prediction in ``root`` of one of the ``tests``, laid over it, by its name; with the reason where that
    cannot be. A test that ended with a defect of ours is not touched again."""
    found = {}
    for path in sorted((root / predicting.FOLDER).glob("*.json")):
        try:
            frozen = Prediction.from_json(read_json(path))
            if frozen.name not in tests:
                continue
            if tests[frozen.name].defect:
                found[path.stem] = Predicted(test=frozen.name, reason="the run of its test ended with a defect")
                continue
            score = predicting.score(path.stem, root, out=out, progress=progress)
        except (AbsentError, InputError, ValueError) as error:
            found[path.stem] = Predicted(test=path.stem, reason=str(error))
            continue
        found[path.stem] = Predicted(test=score.test, held=score.held, of=score.of, mean_error=score.mean_error)
    return found


def skill_sentence(found: Mapping[str, Predicted]) -> str:
    """All predictions in one sentence; "" where there is none."""
    scored = [one for one in found.values() if one.of]
    if not scored:
        return ""
    names = {"predicted": "", "as_last_time": "as last time", "without_effects": "without effects"}
    means = {
        words: np.mean([value for one in scored if (value := one.mean_error.get(name)) is not None] or [np.nan])
        for name, words in names.items()
    }
    rivals = ", ".join(f"{100.0 * mean:.1f} % {words}" for words, mean in means.items() if words and np.isfinite(mean))
    own = means[""]
    said = f": mean error {100.0 * own:.1f} %, and {rivals}" if np.isfinite(own) and rivals else ""
    count, of = sum(one.held or 0 for one in scored), sum(one.of or 0 for one in scored)
    many = "1 prediction" if len(scored) == 1 else f"{len(scored)} predictions"
    return f"Of {many} {count} of {of} bands held{said}."
