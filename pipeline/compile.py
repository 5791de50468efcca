"""compile.py: compile the package's numerical code, which the first commands would otherwise wait for, piece by piece.

Two processes, for the compiler uses one core: one runs the reference engine and its sensitivities, the other takes a
test of ``raw_tests/`` (where there is one) through to its page, in a folder of its own. What they compile is kept
beside the sources, where every later run finds it. Nothing depends on it: what is missing is compiled when it is
needed.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ENGINE = ROOT / "engines" / "maelstrom.toml"


def run_engine() -> None:
    """The reference engine and its sensitivities."""
    from hfanalysis.engine.sensitivity import run_with_tangents
    from hfanalysis.record.engine_file import load_engine
    from hfanalysis.simulation.unsteady_run import simulate

    engine = simulate(load_engine(ENGINE)).engine
    run_with_tangents(engine, ("volume",), times=(0.0, 1.0)).output("impulse", (0.5,))


def main() -> None:
    """Both at once. They are quiet: where one fails, so does the command that needs it, and that one says why."""
    print("Compiling (once; takes about a minute) ...", file=sys.stderr)
    with tempfile.TemporaryDirectory() as folder:
        commands = [[sys.executable, __file__, "engine"]]
        tests = sorted(path.parent.name for path in ROOT.glob("raw_tests/*/test.toml"))
        if tests:
            (Path(folder) / "raw_tests").symlink_to(ROOT / "raw_tests", target_is_directory=True)
            commands.append([sys.executable, "-m", "hfanalysis", "report", tests[-1], "--root", folder])
        nowhere = subprocess.DEVNULL
        running = [subprocess.Popen(command, stdout=nowhere, stderr=nowhere) for command in commands]
        for process in running:
            process.wait()


if __name__ == "__main__":
    run_engine() if sys.argv[1:] == ["engine"] else main()
