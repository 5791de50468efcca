"""What the samples show without a model, as an unknown of the model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hfanalysis.inference.candidate import SHORT, Bench, Candidate, attempted, candidate
from hfanalysis.inference.unknown import Unknown


def plain_sources(parent: Candidate, named: Candidate, bench: Bench) -> list[Candidate]:
    """The parent with each unknown that the samples show; ``named`` is the best that has names.

    What the raw samples tell counts besides, for most of it lies where no blocks are compared; but not where it speaks
    for a name as well.
    """
    tried = [_with(parent, named, source, bench) for source in bench.observed.unknowns]
    return [found for found in tried if found is not None]


def _with(parent: Candidate, named: Candidate, source: Unknown, bench: Bench) -> Candidate | None:
    if source.also_by in parent.names:
        return None
    made, own = source.added_to(parent.fit)
    found = attempted(made, bench.at(parent.form), np.concatenate([parent.fit.x, own]), SHORT)
    if found is None:
        return None
    told = bench.told(bench.judged(candidate((*parent.names, source.place.name), found, parent.form, source)))
    if source.also_by in named.names:
        return told
    return replace(told, log_evidence=told.log_evidence + source.log_evidence)
