"""Tables that take seconds to make, kept under .cache/blind/."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FOLDER = Path(__file__).resolve().parents[2] / ".cache" / "blind"


def kept(name: str, make: Callable[[], Array]) -> Array:
    """The array of that name: read, or made and written whole (another process may be doing the same)."""
    path = FOLDER / f"{name}.npy"
    if path.exists():
        return np.asarray(np.load(path))
    values = make()
    FOLDER.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=FOLDER, suffix=".npy", delete=False) as file:
        np.save(file, values)
    os.replace(file.name, path)
    return values
