"""Where wheels exist of every locked package that runs need, and how large they are installed: `make wheels`.

Asks the package index that pip is set to for each package's metadata; downloads nothing. Writes docs/machines.md.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "machines.md"
BEGIN, END = "<!-- wheels (written by `make wheels`) -->", "<!-- end of wheels -->"

PLATFORMS = {
    "Windows, x86-64": ("x86_64-pc-windows-msvc", ""),
    "macOS 13, arm64": ("aarch64-apple-darwin", "13.0"),
    "macOS 14, arm64": ("aarch64-apple-darwin", "14.0"),
    "macOS 15, x86-64": ("x86_64-apple-darwin", "15.0"),
    "Linux, x86-64": ("x86_64-manylinux_2_28", ""),
    "Linux, arm64": ("aarch64-manylinux_2_28", ""),
}
"""By name the platform that uv is asked for, and the version of macOS."""

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


def without_wheel(pins: list[str], platform: str, macos: str, python: str) -> list[str]:
    """Those of ``NAME==VERSION`` of which the index has no wheel that such an interpreter on such a platform takes."""
    uv = Path(sys.executable).with_name("uv")
    command = [str(uv), "pip", "compile", "-", "--no-deps", "--no-build", "--quiet", "--no-header"]
    command += ["--python-platform", platform, "--python-version", python]
    of_macos = {**os.environ, "MACOSX_DEPLOYMENT_TARGET": macos} if macos else None
    missing = list[str]()
    while True:
        left = [pin for pin in pins if pin not in missing]
        ended = subprocess.run(
            command, env=of_macos, input="\n".join(left), capture_output=True, text=True, check=False
        )
        named = [f"{name}=={version}" for name, version in NO_WHEEL.findall(" ".join(ended.stderr.split()))]
        found = [pin for pin in left if pin.lower() in {one.lower() for one in named}]
        if not ended.returncode:
            return missing
        if not found:
            raise RuntimeError(f"{platform}, Python {python}: {ended.stderr.strip()}")
        missing += found


NO_WHEEL = re.compile(r"([\w.-]+)==([\w.]+) has no (?:usable )?wheels")


def rows(packages: dict[str, str]) -> Iterator[str]:
    """A line per platform: for how many packages there is a wheel by each Python, and which have none."""
    pins = [f"{name}=={version}" for name, version in packages.items()]
    for platform, (triple, macos) in PLATFORMS.items():
        missing = [without_wheel(pins, triple, macos, python) for python in PYTHONS]
        cells = [f"{len(pins) - len(some)} of {len(pins)}" for some in missing]
        named = sorted({pin for some in missing for pin in some})
        yield f"| {platform} | {' | '.join(cells)} | {', '.join(named) or '-'} |"


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
            f"The package needs {len(packages)} others to run. Of the versions in `requirements.lock` there is a",
            "wheel for:",
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
