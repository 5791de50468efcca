"""What the channels of a stand's other tests say by a coarse look.

They are read from their raw logs, so that a test's products do not hang on which of its sisters was processed before
it. What is found in a log is kept in the test's own folder.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from hfanalysis.errors import AnalysisError
from hfanalysis.products import disk
from hfanalysis.record.definition import TestDefinition
from hfanalysis.stages.base import Context
from hfanalysis.stages.stand import nearest

if TYPE_CHECKING:
    from hfanalysis.health.seen import Sister


def sisters(context: Context) -> tuple[Sister, ...]:
    """What the nearest of them say. One whose log cannot be read is left out."""
    folder = context.out / ".state" / "stand"
    found = [_sister(context, other, folder / f"{other.test.id}.json") for other in nearest(context)]
    return tuple(sister for sister in found if sister is not None)


def _sister(context: Context, other: TestDefinition, kept: Path) -> Sister | None:
    from pydantic import TypeAdapter

    from hfanalysis.health.coarse import Coarse
    from hfanalysis.health.seen import Sister

    kind = TypeAdapter(dict[str, Coarse])
    key = {"of": context.record["others"][other.test.id], "code": context.record["code"]}
    found = _kept(kept, key)
    if found is None:
        try:
            found = kind.dump_python(_look(other, kept), mode="json")
        except AnalysisError:
            return None
        disk.write_json(kept, {"key": key, "channels": found})
    return Sister(other, kind.validate_python(found))


def _kept(path: Path, key: dict[str, Any]) -> Any:
    """What was found last time, if it is still so."""
    try:
        data = disk.read_json(path)
    except (OSError, ValueError):
        return None
    return data.get("channels") if data.get("key") == key else None


def _look(other: TestDefinition, beside: Path) -> Any:
    from hfanalysis.health.seen import look
    from hfanalysis.record.ingest import ingest
    from hfanalysis.record.log import read_log

    with_log = disk.temporary_path(beside.with_suffix(".h5"))
    with_log.parent.mkdir(parents=True, exist_ok=True)
    try:
        ingest(other, with_log)
        seen = look(read_log(with_log), other)
    finally:
        with_log.unlink(missing_ok=True)
    return {name: channel.coarse for name, channel in seen.channels.items()}
