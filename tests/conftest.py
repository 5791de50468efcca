"""Settings of the whole suite: the same examples in every run, and no clock on a machine that is busy."""

from __future__ import annotations

import gc
from collections.abc import Iterator

import pytest
from hypothesis import settings

from hfanalysis.cli import COLLECTED_AFTER

settings.register_profile("steady", deadline=None, derandomize=True)
settings.load_profile("steady")
gc.set_threshold(COLLECTED_AFTER)

LONGEST = (
    "acceptance/test_diagnosis.py",
    "simulated/test_generator.py",
    "diagnose/naming/test_naming.py",
    "simulated/test_benchmark.py",
    "inference/adopted/test_every_effect.py",
    "inference/adopted/test_way.py",
    "cli/test_commands.py",
    "stages/test_freshness.py",
    "acceptance/test_make.py",
)
"""Files that take ten seconds and more: where one of them is the last, its worker works alone."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """These first, else as they come. Modules and tests stay: no search for circles goes through them any more."""
    items.sort(key=lambda item: not item.path.as_posix().endswith(LONGEST))
    gc.freeze()


@pytest.fixture(autouse=True, scope="session")
def _settings_of_nobody(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """What tests agree to is noted in a folder of theirs, not in the user's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CONFIG_HOME", str(tmp_path_factory.mktemp("settings")))
        yield
