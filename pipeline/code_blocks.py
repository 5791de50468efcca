"""Tries every code block of the documents: `make code-blocks`; `--quick` without what has to analyse a test.

Python is run, page by page, in a folder of its own with what `hfa demo` writes and a firing to predict. Commands are
held against the options, targets and modules that there are; TOML and JSON are read, what is part of test.toml or of
limits.toml as such. The tutorial, the walkthrough and CONTRIBUTING's examples are run by tests of their own.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from hfanalysis.record.planned import FIRED

ROOT = Path(__file__).resolve().parent.parent
ELSEWHERE = ("docs/tutorial.md", "docs/walkthrough.md")
"""Pages whose blocks tests of their own run in turn."""

BLOCK = re.compile(r"^```(?P<kind>\w*)\n(?P<text>.*?)^```", re.DOTALL | re.MULTILINE)
ROW = "# a row of"
OF_A_FILE = re.compile(rf"# (src|effects)\b|{ROW}|def run\(context")
"""How a block begins that is a row of a table of the package, and one that is a file or part of one."""

NOT_RUN = {"text", "matlab"}
"""Kinds that nothing here reads: what is printed, pictures in letters, another language."""

PREPARED = ("validate HF5", "archive HF5 --write season.h5")
"""What has been done where a page's Python begins."""

Run = subprocess.CompletedProcess[str]


@dataclass(frozen=True)
class Block:
    """A code block: its ``page`` in the repository, the ``line`` that its text begins on, its ``kind``."""

    page: str
    line: int
    kind: str
    text: str

    @property
    def place(self) -> str:
        """Where it stands."""
        return f"{self.page}:{self.line}"


def blocks(root: Path = ROOT) -> Iterator[Block]:
    """Every code block of README, CONTRIBUTING and docs that no test of its own runs."""
    pages = [root / "README.md", root / "CONTRIBUTING.md", *sorted((root / "docs").rglob("*.md"))]
    for path in pages:
        page = path.relative_to(root).as_posix()
        if page not in ELSEWHERE:
            text = path.read_text(encoding="utf-8")
            for found in BLOCK.finditer(text):
                yield Block(page, text.count("\n", 0, found.start()) + 2, found["kind"], found["text"])


def scratch(folder: Path) -> None:
    """What the documents' examples find: the demo's tests and engine, a plan, and the firing of what was planned."""
    _python("-m", "hfanalysis", "demo", ".", folder=folder).check_returncode()
    raw, fired = folder / "raw_tests", "HF6"
    shutil.copytree(raw / "HF5", raw / fired)
    stated = (raw / "HF5" / "test.toml").read_text(encoding="utf-8").replace('id = "HF5"', f'id = "{fired}"')
    (raw / fired / "test.toml").write_text(stated, encoding="utf-8")
    log = raw / fired / "log.csv"
    log.write_bytes(log.read_bytes().rpartition(b"\n")[0].rpartition(b"\n")[0] + b"\n")  # another log than HF5's
    sections = re.split(r"^(?=\[)", stated, flags=re.MULTILINE)
    plan = [s for s in sections if not re.match(rf"\[\[?({'|'.join(FIRED)})\b", s)]
    told = "".join(plan).replace("[tank]\n", '[tank]\ntemperature = "20 degC"\n', 1)
    (folder / f"{fired}.toml").write_text(told, encoding="utf-8")


def python_of(some: Sequence[Block], quick: bool) -> str:
    """The Python of a page's blocks, each statement after a line that says where it stands.

    ``quick``: without those that need a test analysed.
    """
    out, slow = list[str](), set[str]()
    for block in some:
        for statement in ast.parse(block.text).body:
            lines = ast.get_source_segment(block.text, statement)
            words = {n.id for n in ast.walk(statement) if isinstance(n, ast.Name)}
            if quick and (re.search(r"\bHF\d", lines or "") or words & slow):
                slow |= words - {"hfanalysis"}
                continue
            out.append(f"at = {f'{block.page}:{block.line + statement.lineno - 1}'!r}\n{lines}")
    return "\n".join(
        ["import sys", "sys.excepthook = lambda *e: print(at, e[0].__name__, e[1], file=sys.stderr)", *out]
    )


def failures(folder: Path, quick: bool) -> list[str]:
    """What does not do as it stands in the documents, with its place."""
    if not quick:
        for command in PREPARED:
            _python("-m", "hfanalysis", *command.split(), folder=folder).check_returncode()
    of_pages: dict[str, list[Block]] = {}
    out = list[str]()
    for block in blocks():
        if block.kind == "python" and not OF_A_FILE.match(block.text):
            of_pages.setdefault(block.page, []).append(block)
        else:
            out += [f"{block.place}: {why}" for why in wrong_in(block)]
    for some in of_pages.values():
        ended = _python("-W", "error", "-c", python_of(some, quick), folder=folder)
        if ended.returncode or "Error" in ended.stderr:
            out.append(ended.stderr.strip().splitlines()[-1])
    return out


def _python(*arguments: str, folder: Path) -> Run:
    there = {**os.environ, "PYTHONPATH": str(ROOT / "src"), "MPLBACKEND": "Agg"}
    return subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=there, capture_output=True, text=True, check=False
    )


def wrong_in(block: Block) -> Iterator[str]:
    """What is wrong with a block that is read, not run."""
    if block.kind == "sh":
        for line in block.text.replace("\\\n", " ").splitlines():
            yield from _wrong_command(line)
    elif block.kind == "toml":
        yield from _wrong_toml(block.text)
    elif block.kind == "json":
        try:
            json.loads(block.text)
        except ValueError as error:
            yield str(error)
    elif block.kind == "python":
        row = block.text.startswith(ROW)
        try:
            ast.parse(f"{{{block.text}}}" if row else block.text)
        except SyntaxError as error:
            yield str(error)
    elif block.kind not in NOT_RUN:
        yield f"a block of kind {block.kind} is not looked at"


def _wrong_command(line: str) -> Iterator[str]:
    try:
        words = [word for word in shlex.split(line, comments=True) if not re.fullmatch(r"\w+=.*", word)]
    except ValueError as error:
        yield f"{line}: {error}"
        return
    for program in _split(words):
        name, *arguments = program
        if Path(name).name == "hfa":
            yield from _wrong_options(arguments)
        elif name == "make":
            yield from (f"make has no target {t}" for t in arguments if not t.startswith("-") and t not in _targets())
        elif Path(name).name == "python" and arguments[:1] == ["-m"]:
            module = ROOT.joinpath(*arguments[1].split("."))
            if not (module.with_suffix(".py").exists() or (module / "__main__.py").exists()):
                yield f"there is no module {arguments[1]}"


@cache
def _targets() -> frozenset[str]:
    told = subprocess.run(["make", "-pRrq", ":"], cwd=ROOT, capture_output=True, text=True, check=False).stdout
    return frozenset(re.findall(r"^([\w-]+):", told, re.MULTILINE))


def _split(words: list[str]) -> Iterator[list[str]]:
    """The programs of a line."""
    program = list[str]()
    for word in [*words, "&&"]:
        if word in ("&&", "|", ";"):
            if program:
                yield program
            program = []
        else:
            program.append(word)


def _wrong_options(arguments: list[str]) -> Iterator[str]:
    from typer.main import get_command

    from hfanalysis.cli.app import app

    commands: dict[str, Any] = getattr(get_command(app), "commands", {})
    if not arguments or arguments[0].startswith("-"):
        return
    if arguments[0] not in commands:
        yield f"hfa has no command {arguments[0]}"
        return
    known = {o for p in commands[arguments[0]].params for o in (*p.opts, *p.secondary_opts)} | {"--help"}
    options = [word.partition("=")[0] for word in arguments[1:] if word.startswith("--")]
    yield from (f"hfa {arguments[0]} has no option {o}" for o in options if o not in known)


def _wrong_toml(text: str) -> Iterator[str]:
    from hfanalysis.errors import InputError
    from hfanalysis.record.definition import load_definition
    from hfanalysis.record.limits import read_limits

    content = tomllib.loads(text)
    try:
        with tempfile.TemporaryDirectory() as scratched:
            folder = Path(scratched) / "HF5"
            folder.mkdir()
            if "rule" in content:
                (folder / "limits.toml").write_text(text, encoding="utf-8")
                named = [r["quantity"] for r in content["rule"]]
                read_limits(folder, None, named)
            elif "test" in content:
                (folder / "test.toml").write_text(text, encoding="utf-8")
                for log in content["log"]["files"]:
                    (folder / log).write_text("", encoding="utf-8")
                load_definition(folder / "test.toml")
    except InputError as error:
        yield str(error)


def main() -> int:
    """Try them all, and say what does not do as it stands."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="without what has to analyse a test")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scratch(Path(folder))
        found = failures(Path(folder), asked.quick)
    print("\n".join(found) or f"{len(list(blocks()))} code blocks do as they stand")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
