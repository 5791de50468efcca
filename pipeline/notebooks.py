"""Executes the notebooks: `make notebooks`. They stay without output; what they show is written to site/notebooks/.

The first of them, with what it shows, is docs/walkthrough.md as well.

Runs with the Python of .venv-notebooks, which has Jupyter; the kernel is the project's own Python.
"""

from __future__ import annotations

import base64
import json
import os
import shutil
import sys
import tempfile
import time
from pathlib import Path

import nbformat
from jupyter_client.kernelspec import KernelSpecManager
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

ROOT = Path(__file__).resolve().parent.parent
SHOWN = ROOT / "site" / "notebooks"
PAGE, OF_PAGE = ROOT / "docs" / "walkthrough.md", "from-log-to-verdict.ipynb"
MADE = "<!-- made of notebooks/from-log-to-verdict.ipynb by `make notebooks` -->"
LONGEST = 1200
"""Seconds that a cell may take."""


def kernel(folder: Path, python: str) -> AsyncKernelManager:
    """A kernel of ``python``, which finds Jupyter's packages where this process has them."""
    spec = folder / "kernels" / "project"
    spec.mkdir(parents=True)
    argv = [python, "-m", "ipykernel_launcher", "-f", "{connection_file}", "--log-level=ERROR"]
    own = os.pathsep.join(path for path in sys.path if "site-packages" in path)
    environment = {"PYTHONPATH": own, "MPLBACKEND": "module://matplotlib_inline.backend_inline", "OMP_NUM_THREADS": "1"}
    described = {"argv": argv, "display_name": "project", "language": "python", "env": environment}
    (spec / "kernel.json").write_text(json.dumps(described), encoding="utf-8")
    found = KernelSpecManager(kernel_dirs=[str(folder / "kernels")])
    return AsyncKernelManager(kernel_name="project", kernel_spec_manager=found)


def beside_tests(folder: Path) -> Path:
    """An empty folder that has in the one above it what a checkout has and nobody has worked with."""
    root = folder / "root"
    for name in ("raw_tests", "engines"):
        shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("*.effects.toml"))
    (root / "docs").symlink_to(ROOT / "docs")
    (root / ".venv-rocketpy").symlink_to(ROOT / ".venv-rocketpy")
    (root / "notebooks").mkdir()
    return root / "notebooks"


def as_markdown(notebook: nbformat.NotebookNode, pictures: str) -> tuple[str, dict[str, bytes]]:
    """An executed notebook as a page, and its pictures by their names, which begin with ``pictures``."""
    parts, images = list[str](), dict[str, bytes]()
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        parts.append(f"```python\n{cell.source}\n```")
        for output in cell.outputs:
            data = output.get("data", {})
            if "image/png" in data:
                name = f"{pictures}-{len(images) + 1}.png"
                images[name] = base64.b64decode(data["image/png"])
                parts.append(f"![What the lines above draw]({name})")
            else:
                text = output.get("text") or data.get("text/plain", "")
                parts.append(f"```text\n{text.rstrip()}\n```")
    return "\n\n".join(parts) + "\n", images


def write_page(notebook: nbformat.NotebookNode) -> None:
    """docs/walkthrough.md from the executed notebook that it is."""
    text, images = as_markdown(notebook, "walkthrough")
    for old in PAGE.parent.glob("walkthrough-*.png"):
        old.unlink()
    for name, content in images.items():
        (PAGE.parent / name).write_bytes(content)
    begin, _, rest = text.partition("\n")
    PAGE.write_text(f"{begin}\n\n{MADE}\n{rest}", encoding="utf-8")


def execute(path: Path, python: str) -> str | None:
    """Run a notebook from its first cell; what went wrong, if anything did."""
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        manager = kernel(Path(folder), python)
        where = {"metadata": {"path": str(beside_tests(Path(folder)))}}
        client = NotebookClient(notebook, km=manager, timeout=LONGEST, resources=where)
        try:
            client.execute()
        except CellExecutionError as error:
            return str(error)
    SHOWN.mkdir(parents=True, exist_ok=True)
    nbformat.write(notebook, SHOWN / path.name)
    if path.name == OF_PAGE:
        write_page(notebook)
    return None


def main() -> None:
    """All notebooks, or those named after the project's Python."""
    python, *named = sys.argv[1:]
    paths = [Path(name).resolve() for name in named] or sorted((ROOT / "notebooks").glob("*.ipynb"))
    failed = False
    for path in paths:
        began = time.monotonic()
        wrong = execute(path, python)
        print(f"{path.name}: {wrong or 'executed'} ({time.monotonic() - began:.0f} s)", flush=True)
        failed |= wrong is not None
    sys.exit(failed)


if __name__ == "__main__":
    main()
