"""Why errors that no test of their room notices are left as they are, by a part of their names."""

from __future__ import annotations

EXPLAINED: dict[str, str] = {}
