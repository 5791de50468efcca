"""Effects that have been adopted: kept beside the tests, read by every stage whose model they are part of.

``engines/TEST.effects.toml`` holds those of one test, ``engines/STAND.effects.toml`` those of all tests of a stand. A
test's own file takes the place of its stand's, as a whole.
"""

from __future__ import annotations

from pathlib import Path

from hfanalysis.record.definition import TestDefinition

FOLDER, ENDING = "engines", ".effects.toml"


def file_for(root: Path, name: str) -> Path:
    """Where the effects of a test or stand called ``name`` are kept."""
    return root / FOLDER / f"{name}{ENDING}"


def adopted_file(root: Path, definition: TestDefinition) -> Path | None:
    """The file whose effects this test has: its own, else its stand's; None where there is neither."""
    names = (definition.test.id, definition.test.stand)
    return next((path for name in names if name and (path := file_for(root, name)).is_file()), None)
