"""What a search for effects has at hand."""

from __future__ import annotations

from dataclasses import dataclass, field

from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.diagnose.naming.variants import Settings
from hfanalysis.inference.candidate import Bench
from hfanalysis.progress import Progress, silent


@dataclass(frozen=True)
class Search:
    """The data at every model-form error, the effects that may be named, the method, and who is told how far it is."""

    bench: Bench
    catalogue: Catalogue
    settings: Settings = field(default_factory=Settings)
    progress: Progress = silent
