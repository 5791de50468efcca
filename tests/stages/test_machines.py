"""Machines as they are: full disks, no locks, no home, two users; and a test.toml that is edited while a run waits."""

from __future__ import annotations

import errno
import fcntl
import json
import os
import resource
import stat
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.stages.fake_way import FAULTS, STAGES, ran

from hfanalysis.errors import InputError
from hfanalysis.products import disk, hdf5
from hfanalysis.stages import lock, runner
from hfanalysis.stages.open_test import open_test

LOCKED = lock.locked


def toml(root: Path) -> Path:
    return root / "raw_tests/T1/test.toml"


def edited(root: Path) -> None:
    toml(root).write_text(toml(root).read_text() + "# edited\n")


def test_a_run_that_waited_takes_the_file_as_it_is_then(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    @contextmanager
    def slowly(*args: Any) -> Iterator[None]:
        with LOCKED(*args):
            edited(root)
            yield

    monkeypatch.setattr(runner, "locked", slowly)
    context = runner.run_to("first", open_test(root, "T1"))
    monkeypatch.undo()
    assert context.definition.sha256 == disk.sha256_file(toml(root))
    found = json.loads((root / "processed/T1/first.json").read_text())["provenance"]
    assert found["test_toml"] == disk.sha256_file(toml(root))


def test_a_file_edited_during_the_run_is_not_what_the_products_are_of(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = disk.sha256_file(toml(root))
    first = STAGES["first"].run

    def meanwhile(context: Any) -> None:
        first(context)
        edited(root)

    monkeypatch.setattr(type(STAGES["first"]), "__setattr__", object.__setattr__)
    monkeypatch.setattr(STAGES["first"], "run", meanwhile)
    ran(root, "first")
    product = root / "processed/T1/first.json"
    assert json.loads(product.read_text())["provenance"]["test_toml"] == before
    assert product.stat().st_mtime_ns < toml(root).stat().st_mtime_ns  # so that make asks again
    monkeypatch.undo()


def test_code_that_ends_the_program_is_a_refusal(root: Path) -> None:
    FAULTS["second"] = SystemExit(0)  # type: ignore[assignment]
    with pytest.raises(InputError, match=r"stage second: the code in .*effects ended it"):
        ran(root, "third")
    assert not (root / "processed/T1/second.json").exists()


FILL = """
import resource, sys
from pathlib import Path
import numpy as np
from hfanalysis.products.hdf5 import created
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]),) * 2)
try:
    with created(Path(sys.argv[2]), track_order=False) as file:
        for name in map(str, range(9)):
            data = file.create_dataset(name, data=np.arange(3000.0), track_times=False)
            packed = file.create_dataset(f"{name}_flags", data=np.arange(3000) % 7, compression="gzip")
            data.make_scale(name)
            packed.dims[0].attach_scale(data)
except OSError as error:
    print(error.errno)
"""


@pytest.mark.parametrize("limit", [0, 100, 3000, 30_000, 150_000])
def test_a_disk_that_fills_up_within_an_hdf5_product_is_an_error(tmp_path: Path, limit: int) -> None:
    command = [sys.executable, "-c", FILL, str(limit), str(tmp_path / "x.h5")]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout.strip(), ended.stderr) == (0, str(errno.EFBIG), "")


def test_hdf5_products_are_whole(tmp_path: Path) -> None:
    import h5py

    with hdf5.created(tmp_path / "x.h5", track_order=False) as file:
        file.create_dataset("a", data=np.arange(5000.0), compression="gzip")
    with h5py.File(tmp_path / "x.h5") as file:
        np.testing.assert_array_equal(file["a"][:], np.arange(5000.0))


def test_a_full_disk_ends_with_one_plain_message(root: Path) -> None:
    FAULTS["second"] = OSError(errno.ENOSPC, "No space left on device")
    with pytest.raises(InputError, match="No space left on device; choose another place"):
        ran(root, "second")


@pytest.mark.parametrize("code", [errno.ENOTSUP, errno.ENOLCK, errno.ENOSYS])
def test_without_locks_in_the_folder_one_elsewhere_is_taken(
    root: Path, monkeypatch: pytest.MonkeyPatch, code: int
) -> None:
    flock, asked = fcntl.flock, []

    def refused(descriptor: int, how: int) -> None:
        asked.append(os.readlink(f"/proc/self/fd/{descriptor}"))
        if asked[-1].startswith(str(root)):
            raise OSError(code, os.strerror(code))
        flock(descriptor, how)

    monkeypatch.setattr(fcntl, "flock", refused)
    assert ran(root, "second") == ["first", "second"]
    assert Path(asked[-1]).name.startswith("hfanalysis-")
    Path(asked[-1]).unlink()


def test_without_locks_anywhere_it_is_said(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(descriptor: int, how: int) -> None:
        raise OSError(errno.ENOTSUP, "Operation not supported")

    monkeypatch.setattr(fcntl, "flock", refused)
    with pytest.raises(InputError, match="found no locks"):
        ran(root, "second")


@pytest.fixture
def usual_mask() -> Iterator[None]:
    before = os.umask(0o022)
    yield
    os.umask(before)


@pytest.mark.usefixtures("usual_mask")
@pytest.mark.parametrize("group", [False, True])
def test_products_are_the_groups_where_their_folder_is(root: Path, group: bool) -> None:
    (root / "processed").mkdir()
    (root / "processed").chmod(0o2775 if group else 0o755)
    ran(root, "second")
    found = [path for path in (root / "processed").rglob("*") if path.name != "hashes.json"]
    assert {"first.json", "run.log", ".lock", ".state"} <= {path.name for path in found}
    assert {bool(path.stat().st_mode & stat.S_IWGRP) for path in found} == {group}


def test_products_of_another_user_are_brought_up_to_date(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only a file's owner may set its times."""
    ran(root, "second")
    files = [(root / "processed/T1" / name).open("rb") for name in ("first.bin", "first.json")]
    utime, theirs = os.utime, [os.fstat(file.fileno()).st_ino for file in files]  # open, so that no new file gets them

    def refused(path: Path, *now: Any, **times: Any) -> None:
        if Path(path).stat().st_ino in theirs:
            raise PermissionError(errno.EPERM, "Operation not permitted", str(path))
        utime(path, *now, **times)

    monkeypatch.setattr(os, "utime", refused)
    toml(root).touch()
    assert ran(root, "second") == []
    assert (root / "processed/T1/first.bin").stat().st_mtime_ns >= toml(root).stat().st_mtime_ns
    assert (root / "processed/T1/first.bin").read_text().endswith("end")
    for file in files:
        file.close()


@pytest.mark.parametrize("content", ["[]", "3", '{"products": []}', '{"products": {"first.bin": []}}', "\x00"])
def test_a_note_that_is_damaged_is_none(root: Path, content: str) -> None:
    ran(root, "second")
    (root / "processed/T1/.state/first.json").write_text(content)
    assert ran(root, "second")[:1] == ["first"]


@pytest.mark.parametrize("content", ["[]", '{"NAME": 3}', '{"NAME": {"a": 1}}', '{"NAME": []}', "\x00"])
def test_a_list_of_hashes_that_is_damaged_is_none(root: Path, content: str) -> None:
    ran(root, "second")
    hashes = root / "processed/T1/.state/hashes.json"
    hashes.write_text(content.replace("NAME", str((root / "raw_tests/T1/log.csv").resolve())))
    assert ran(root, "second") == []


def test_output_that_is_full_ends_with_one_plain_message() -> None:
    for what in (["--help"], ["effects", "--json"]):
        with open("/dev/full", "w") as full:
            command = [sys.executable, "-m", "hfanalysis", *what]
            ended = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
        assert (ended.returncode, ended.stderr) == (2, "hfa: No space left on device\n")


def test_what_is_kept_of_compiled_code_is_proved_and_never_in_the_way(tmp_path: Path) -> None:
    """A damaged file, a disk that is full, and nowhere to keep anything: each costs time, nothing else."""
    source = tmp_path / "thrust.py"
    source.write_text(
        "from hfanalysis.compiled import compiled\n@compiled\ndef twice(x):\n    return 2.0 * x\n"
        "if __name__ == '__main__':\n    print(twice(1.5), sum(twice.stats.cache_hits.values()))\n"
    )

    def run(limit: int | None = None, **more: str) -> str:
        def limited() -> None:
            if limit is not None:
                resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

        clean = {name: value for name, value in os.environ.items() if name not in ("NUMBA_CACHE_DIR", "HOME")}
        command = [sys.executable, str(source)]
        return subprocess.run(
            command, env=clean | more, capture_output=True, text=True, check=True, preexec_fn=limited
        ).stdout

    assert run(limit=64) == "3.0 0\n"
    assert [run(), run()] == ["3.0 0\n", "3.0 1\n"]
    (code,) = (tmp_path / "__pycache__").glob("*.nbc")
    whole = code.read_bytes()
    code.write_bytes(whole[:-100] + bytes(100))
    assert [run(), run()] == ["3.0 0\n", "3.0 1\n"]
    (tmp_path / "__pycache__").rename(tmp_path / "kept")
    (tmp_path / "__pycache__").write_text("no folder")
    (tmp_path / "temporary").mkdir()
    nowhere = {"HOME": str(source), "TMPDIR": str(tmp_path / "temporary")}
    assert [run(**nowhere), run(**nowhere)] == ["3.0 0\n", "3.0 1\n"]
    (tmp_path / "temporary" / f"hfanalysis-{os.geteuid()}").chmod(0o777)
    assert run(**nowhere) == "3.0 0\n"
