"""Whose process this is."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path


def user() -> int | None:
    """The number of the user; None on Windows, which has none."""
    return os.geteuid() if hasattr(os, "geteuid") else None


def own_temporary() -> Path:
    """The user's own folder among the temporary ones, which may not be there yet; Windows' are the user's already."""
    number = user()
    return Path(tempfile.gettempdir()) / ("hfanalysis" if number is None else f"hfanalysis-{number}")
