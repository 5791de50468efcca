"""Settings of the whole suite: the same examples in every run, and no clock on a machine that is busy."""

from __future__ import annotations

from hypothesis import settings

settings.register_profile("steady", deadline=None, derandomize=True)
settings.load_profile("steady")
