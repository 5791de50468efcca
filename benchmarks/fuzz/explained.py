"""Mutations that no log can give away, with the reason: their cases are listed under it, not one by one."""

from __future__ import annotations

EXPLAINED: dict[str, str] = {}
