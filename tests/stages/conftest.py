"""A root with one test and the small way through."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.stages import fake_way


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    fake_way.install(monkeypatch)
    fake_way.make_test(tmp_path)
    return tmp_path
