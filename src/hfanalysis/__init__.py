"""Hot-fire test data analysis for nitrous oxide / paraffin hybrid rocket engines."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from hfanalysis.version import __version__

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["__version__", "load_residuals"]


def load_residuals(test: str | Path, root: str | Path = ".") -> xr.DataTree:
    """The residuals of a test, by its name, folder or residuals.h5: ``load_residuals("HF5")["full/p_chamber"]``.

    Datasets have ``measured``, ``model``, ``residual``, ``noise_std`` and ``phase`` over ``time`` [s].
    """
    from hfanalysis.validate.load import load

    return load(test, root)
