"""hfa demo and hfa docs: examples and pages that come with the package."""

from __future__ import annotations

import shutil
from pathlib import Path

from hfanalysis.cli.exit_status import put, tell
from hfanalysis.errors import InputError
from hfanalysis.products.disk import atomic

PACKAGE = Path(__file__).parents[1]
"""Where the package is installed."""
REPOSITORY = PACKAGE.parents[1]
"""Of a checkout; of an installed package it is some folder without these files."""

TESTS, ENGINE, PUBLISHED = ("HF5", "HF4"), "maelstrom.toml", "maelstrom.published.toml"

NEXT = """\
{where}: HF5 and HF4 (REPLICAS: generated, not measured) and the report's engine. Next:
  {cd}hfa run HF5 --quick     what can be said at the stand, in seconds (the first command compiles for a minute or so)
  hfa report HF5              the page: processed/HF5/report.html
  hfa simulate engines/{engine} --out maelstrom   the report's engine, its rocket's flight, and a page
"""


def demo(folder: Path) -> None:
    """Write the examples into ``folder``; what is there already and is the same stays, what differs is refused."""
    source = _data()
    names = [f"raw_tests/{test}/{file}" for test in TESTS for file in ("test.toml", "log.csv")]
    names += [f"engines/{ENGINE}", f"engines/{PUBLISHED}"]
    wanted = {folder / name: source / name for name in names}
    for target, origin in wanted.items():
        if target.exists() and target.read_bytes() != origin.read_bytes():
            raise InputError(f"{target}: is there already, and not as in the examples; expected another folder")
    for target, origin in wanted.items():
        if not target.exists():
            with atomic(target) as scratch:
                shutil.copyfile(origin, scratch)
    here = folder.resolve() == Path.cwd()
    put(NEXT.format(where=folder.resolve(), cd="" if here else f"cd {folder} && ", engine=ENGINE))


def docs(page: str | None) -> None:
    """Show a page at the terminal; without one the list of them, and where they are."""
    folder = _pages()
    there = {path.stem: path for path in sorted(folder.rglob("*.md"))}
    if page is None:
        tell(f"pages are in {folder}; hfa docs NAME shows one")
        put("".join(f"{name:<18} {_title(path)}\n" for name, path in there.items()))
        return
    if page.removesuffix(".md") not in there:
        raise InputError(f"page {page!r}: not among {', '.join(there)}")
    put(there[page.removesuffix(".md")].read_text(encoding="utf-8"))


def _title(path: Path) -> str:
    first = next((line for line in path.read_text(encoding="utf-8").splitlines() if line.startswith("# ")), "")
    return first.removeprefix("# ")


def _data() -> Path:
    return _either(PACKAGE / "demo", REPOSITORY, "raw_tests/HF5/test.toml")


def _pages() -> Path:
    return _either(PACKAGE / "pages", REPOSITORY / "docs", "tutorial.md")


def _either(installed: Path, checkout: Path, has: str) -> Path:
    for folder in (installed, checkout):
        if (folder / has).is_file():
            return folder
    raise InputError(f"{installed}: is missing; expected an installation with its examples (pip install hfanalysis)")
