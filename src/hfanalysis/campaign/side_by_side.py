"""Every test through all stages, several at a time, each in a process of its own: what ends one ends no other."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass

from hfanalysis.errors import AbsentError, InputError

DONE, INPUT_AT_FAULT, ABSENT = 0, InputError.exit_status, AbsentError.exit_status
"""Exit statuses of a test's run: done, and the two in which an analysis ends early."""

_ADDRESSED = "hfa: "
_WARNING = "hfa: warning: "


@dataclass(frozen=True)
class Ended:
    """How the run of a test ended: its exit status, and what it said of it ("" where all went well)."""

    status: int
    said: str

    @property
    def defect(self) -> bool:
        """Whether it is our fault."""
        return self.status not in (DONE, INPUT_AT_FAULT, ABSENT)


def run_all(
    tests: Sequence[str], arguments: Sequence[str], jobs: int, ended: Callable[[str, Ended], None]
) -> Mapping[str, Ended]:
    """``hfa run TEST`` with these further arguments for every test, ``jobs`` at a time.

    ``ended`` is called, from this thread, as each one ends. An interrupt ends what has not begun; what runs is
    interrupted itself.
    """
    found: dict[str, Ended] = {}
    with ThreadPoolExecutor(jobs) as pool:
        running = {pool.submit(_run, test, arguments): test for test in tests}
        try:
            for future in as_completed(running):
                found[running[future]] = future.result()
                ended(running[future], future.result())
        except KeyboardInterrupt:
            pool.shutdown(cancel_futures=True)
            raise
    return {test: found[test] for test in tests}


def _run(test: str, arguments: Sequence[str]) -> Ended:
    command = [sys.executable, "-m", "hfanalysis", "run", "--quiet", *arguments, "--", test]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return Ended(done.returncode, _said(done.stderr) if done.returncode else "")


def _said(text: str) -> str:
    """The message among what a command prints for people; all of it (a traceback) where there is none."""
    lines = [line for line in text.splitlines() if line and not line.startswith(_WARNING)]
    told = [line.removeprefix(_ADDRESSED) for line in lines if line.startswith(_ADDRESSED)]
    return "\n".join(told or lines) or "it ended without a word"
