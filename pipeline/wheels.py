"""Where wheels exist of every locked package that runs need, and how large they are installed: `make wheels`.

Asks the package index that pip is set to for each package's metadata; downloads nothing. Writes docs/machines.md.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "machines.md"
BEGIN, END = "<!-- wheels (written by `make wheels`) -->", "<!-- end of wheels -->"

PLATFORMS = {
    "Windows, x86-64": "x86_64-pc-windows-msvc",
    "macOS, arm64": "aarch64-apple-darwin",
    "Linux, x86-64": "x86_64-manylinux_2_28",
    "Linux, arm64": "aarch64-manylinux_2_28",
}
PYTHONS = ("3.11", "3.12", "3.13")
PROJECT = "hfanalysis"


def core(name: str = PROJECT) -> dict[str, str]:
    """Every distribution that a run needs, with its installed version: what the project asks for, and so on."""
    seen, asked = dict[str, str](), [name]
    while asked:
        found = metadata.distribution(asked.pop())
        if found.metadata["Name"] in seen:
            continue
        seen[found.metadata["Name"]] = found.version
        needs = [Requirement(line) for line in found.requires or []]
        asked += [one.name for one in needs if one.marker is None or one.marker.evaluate({"extra": ""})]
    del seen[metadata.distribution(name).metadata["Name"]]
    return dict(sorted(seen.items(), key=lambda one: one[0].lower()))


def size_of(name: str) -> int:
    """Bytes of a distribution's installed files, without compiled Python."""
    files = metadata.distribution(name).files or []
    paths = {Path(str(file.locate())) for file in files if file.suffix != ".pyc"}
    return sum(path.stat().st_size for path in paths if path.is_file())


def has_wheel(pinned: str, platform: str, python: str) -> bool:
    """Whether the index has a wheel of ``NAME==VERSION`` that such an interpreter on such a platform takes."""
    uv = Path(sys.executable).with_name("uv")
    command = [str(uv), "pip", "compile", "-", "--no-deps", "--no-build", "--quiet", "--no-header"]
    command += ["--python-platform", platform, "--python-version", python]
    ended = subprocess.run(command, input=pinned, capture_output=True, text=True, check=False)
    if ended.returncode and "no usable wheels" not in ended.stderr and "no wheels" not in ended.stderr:
        raise RuntimeError(f"{pinned}, {platform}: {ended.stderr.strip()}")
    return ended.returncode == 0


def rows(packages: dict[str, str]) -> Iterator[str]:
    """A line per platform: for how many packages there is a wheel by each Python, and which have none."""
    pins = [f"{name}=={version}" for name, version in packages.items()]
    for platform, triple in PLATFORMS.items():
        cells, without = [], set[str]()
        for python in PYTHONS:
            with ThreadPoolExecutor(8) as pool:
                there = list(pool.map(lambda pin: has_wheel(pin, triple, python), pins))  # noqa: B023
            cells.append(f"{sum(there)} of {len(pins)}")
            without |= {pin for pin, has in zip(pins, there, strict=True) if not has}
        yield f"| {platform} | {' | '.join(cells)} | {', '.join(sorted(without)) or '-'} |"


def section() -> str:
    """What docs/machines.md says of wheels and sizes."""
    packages = core()
    sizes = {name: size_of(name) for name in packages}
    own = sum(path.stat().st_size for path in (ROOT / "src").rglob("*") if path.is_file() and path.suffix in SOURCES)
    largest = sorted(sizes, key=lambda name: -sizes[name])[:6]
    heads = " | ".join(f"Python {python}" for python in PYTHONS)
    megabytes = sum(sizes.values()) / 1e6
    return "\n".join(
        [
            BEGIN,
            "",
            f"The package needs {len(packages)} others to run, itself counted out. Of the versions in",
            "`requirements.lock` there is a wheel for:",
            "",
            f"| platform | {heads} | no wheel of |",
            f"|---|{'---|' * len(PYTHONS)}---|",
            *rows(packages),
            "",
            f"Installed they take {megabytes:.0f} MB without compiled Python, on {sys.platform}; the largest: "
            + ", ".join(f"{name} {sizes[name] / 1e6:.0f} MB" for name in largest)
            + f". The package itself takes {own / 1e6:.1f} MB.",
            "",
            END,
        ]
    )


SOURCES = (".py", ".js", ".css", ".j2", ".json", ".toml", ".svg")


def main() -> None:
    """Write the section anew."""
    text = PAGE.read_text(encoding="utf-8")
    wanted = re.compile(re.escape(BEGIN) + ".*?" + re.escape(END), re.S)
    if not wanted.search(text):
        sys.exit(f"{PAGE.name} has no {BEGIN}")
    PAGE.write_text(wanted.sub(lambda _: section(), text), encoding="utf-8")


if __name__ == "__main__":
    main()
