"""Writes the sample output in README.md anew, from what the command really prints: `make readme`."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
WIDTH = 150
"""Columns of the terminal that the output is made for: no name of a quantity breaks."""

BLOCK = re.compile(
    r"(<!-- sample: (?P<command>[^>]*?) \(written by `make readme`\) -->\n).*?(<!-- end of sample -->)", re.S
)


def renewed(text: str, folder: Path) -> tuple[str, int]:
    """The text with what its commands print about the tests in a folder, and the number of its samples."""

    def sample(match: re.Match[str]) -> str:
        arguments = match["command"].split()[1:]
        hfa = [sys.executable, "-m", "hfanalysis", *arguments]
        wide = {**os.environ, "COLUMNS": str(WIDTH)}
        ended = subprocess.run(hfa, cwd=folder, env=wide, capture_output=True, text=True, check=True)
        lines = "\n".join(line.rstrip() for line in ended.stdout.splitlines())
        return f"{match[1]}\n```text\n{lines}\n```\n\n{match[3]}"

    return BLOCK.subn(sample, text)


def main() -> None:
    readme = ROOT / "README.md"
    before = readme.read_text(encoding="utf-8")
    after, count = renewed(before, ROOT)
    if not count:
        sys.exit("README.md has no sample block")
    readme.write_text(after, encoding="utf-8")


if __name__ == "__main__":
    main()
