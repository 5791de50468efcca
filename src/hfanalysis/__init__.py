"""Hot-fire test data analysis for nitrous oxide / paraffin hybrid rocket engines.

What is named in ``__all__`` is the public interface, and follows semantic versions; everything else is private.
"""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hfanalysis.errors import AbsentError, AnalysisError, InputError
from hfanalysis.version import __version__

if TYPE_CHECKING:
    import xarray as xr

    from hfanalysis.archive.reading import Archive
    from hfanalysis.interface.engines import design, next_tests, simulate
    from hfanalysis.interface.firing import Firing, open
    from hfanalysis.interface.made import firing
    from hfanalysis.interface.of_test import engine_file
    from hfanalysis.interface.predicting import predict, score
    from hfanalysis.quantity import Quantity

__all__ = [
    "AbsentError",
    "AnalysisError",
    "Archive",
    "Firing",
    "InputError",
    "Quantity",
    "__version__",
    "design",
    "engine_file",
    "firing",
    "load_residuals",
    "next_tests",
    "open",
    "predict",
    "score",
    "simulate",
]

_PLACES = {
    "Archive": "archive.reading",
    "Firing": "interface.firing",
    "open": "interface.firing",
    "firing": "interface.made",
    "simulate": "interface.engines",
    "design": "interface.engines",
    "next_tests": "interface.engines",
    "engine_file": "interface.of_test",
    "predict": "interface.predicting",
    "score": "interface.predicting",
    "Quantity": "quantity",
}
"""Where in the package the names are that are loaded when they are asked for: importing it takes no time. No module of
the package asks for one, so that none rests on all of them."""


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_PLACES[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted(__all__)


def load_residuals(test: str | Path, root: str | Path = ".") -> xr.DataTree:
    """The residuals of a test, by its name, folder or residuals.h5: ``load_residuals("HF5")["full/p_chamber"]``.

    Datasets have ``measured``, ``model``, ``residual``, ``noise_std`` and ``phase`` over ``time`` [s].
    """
    from hfanalysis.validate.load import load

    return load(test, root)
