"""Which generator it is: cases of one digest come of one generator, whatever became of the scoring since."""

from __future__ import annotations

from functools import lru_cache
from hashlib import sha256
from pathlib import Path

HERE = Path(__file__).parent
SCORING = ("figures", "judged", "outcomes", "score", "targets", "made_up")
GENERATOR = tuple(
    path for path in sorted(HERE.glob("*.py")) if path.stem not in SCORING and not path.stem.startswith(("_", "test_"))
)
"""The modules that make a case."""


@lru_cache
def generator_digest() -> str:
    """SHA-256 over GENERATOR."""
    total = sha256()
    for path in GENERATOR:
        total.update(f"{path.name}\0".encode() + path.read_bytes())
    return total.hexdigest()
