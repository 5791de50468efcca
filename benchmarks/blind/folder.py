"""What lies where in a folder of blind cases, and what is noted about every diagnosis.

``raw_tests/`` and ``answers/`` are the generator's; ``processed[-VARIANT]/ID/`` are the products of the stages and
``runs[-VARIANT]/ID.json`` the note on each diagnosis. A note is written last and whole: it says that the case is done.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Any

REPOSITORY = Path(__file__).resolve().parents[2]
PACKAGE = REPOSITORY / "src" / "hfanalysis"
PROBABILITIES = PACKAGE / "diagnose" / "answer" / "probabilities.json"
"""The constants that ``calibrate`` fits and the diagnosis reads."""
ABSENT = "none"

DONE, FAILED, DIED, LATE, UNWRITTEN = "done", "failed", "died", "time limit", "not written"


def digest(folder: Path, *without: Path) -> str:
    """SHA-256 over names and contents of all files below a folder but some; byte code does not count."""
    total = sha256()
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path not in without and "__pycache__" not in path.parts:
            total.update(f"{path.relative_to(folder).as_posix()}\0{sha256(path.read_bytes()).hexdigest()}\n".encode())
    return total.hexdigest()


def code_digest() -> str:
    """The package's sources, but for the fitted constants: the evidences do not depend on them."""
    return digest(PACKAGE, PROBABILITIES)


def probabilities_digest() -> str:
    """The fitted constants, or that there are none."""
    return sha256(PROBABILITIES.read_bytes()).hexdigest() if PROBABILITIES.exists() else ABSENT


def scoring_digest() -> str:
    """The scorer; the generator's own is in its answers."""
    from simulated.blind.version import GENERATOR  # workers, which load this module, load nothing of the generator's

    return digest(REPOSITORY / "simulated" / "blind", *GENERATOR)


@dataclass(frozen=True)
class Note:
    """What became of one case.

    Attributes:
        id: the case.
        status: one of done, failed, died, time limit, not written.
        message: why, where it is not done.
        seconds: from the log to the diagnosis [s].
        diagnosis_seconds: of these, in the last stage [s].
        processor_seconds: processor time of all of it [s]; unlike the others it knows nothing of a busy machine.
        first: whether it was the first of its process, which loads and compiles.
        code: digest of the package's sources.
        probabilities: digest of the fitted constants.
        settings: parameters of the stages that were set.
    """

    id: str
    status: str
    message: str = ""
    seconds: float | None = None
    diagnosis_seconds: float | None = None
    first: bool = False
    code: str = ""
    probabilities: str = ABSENT
    settings: dict[str, Any] = field(default_factory=dict)
    processor_seconds: float | None = None


@dataclass(frozen=True)
class Folder:
    """A folder of cases and the products of one method (variant None: the full one)."""

    root: Path
    variant: str | None = None

    def _named(self, name: str) -> Path:
        return self.root / (f"{name}-{self.variant}" if self.variant else name)

    @property
    def answers(self) -> Path:
        """What is hidden."""
        return self.root / "answers"

    @property
    def processed(self) -> Path:
        """Products, a folder per case."""
        return self._named("processed")

    @property
    def runs(self) -> Path:
        """Notes, a file per case."""
        return self._named("runs")

    @property
    def plan_file(self) -> Path:
        """Which plan the last run went by."""
        return self.runs / "plan" / "plan.json"

    def product(self, case: str) -> Path:
        """The diagnosis of a case."""
        return self.processed / case / "diagnosis.json"

    def note(self, case: str) -> Note | None:
        """What is noted about a case, if anything that can be read."""
        try:
            return Note(**json.loads((self.runs / f"{case}.json").read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError):
            return None

    def notes(self) -> dict[str, Note]:
        """All notes by case."""
        found = (self.note(path.stem) for path in sorted(self.runs.glob("*.json")))
        return {note.id: note for note in found if note is not None}

    def write_note(self, note: Note) -> None:
        """Write a note whole."""
        write_json(self.runs / f"{note.id}.json", asdict(note))

    def variants(self) -> list[str]:
        """The variants that were run beside the full method."""
        prefix = "runs-"
        return sorted(path.name.removeprefix(prefix) for path in self.root.glob(f"{prefix}*") if path.is_dir())


def write_json(path: Path, data: Mapping[str, Any]) -> None:
    """Write a file whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(f".part-{os.getpid()}")
    part.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    os.replace(part, path)
