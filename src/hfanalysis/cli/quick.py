"""hfa run ID --quick: what can be said at the stand, within seconds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hfanalysis.cli.exit_status import put, tell
from hfanalysis.cli.perform import bring
from hfanalysis.cli.request import Request
from hfanalysis.errors import AbsentError
from hfanalysis.products.quick import QuickLook
from hfanalysis.stages.base import Context, load_stage

if TYPE_CHECKING:
    from hfanalysis.performance.quick import Facts


def quick(request: Request, facts: Facts | None = None) -> None:
    """Bring ingest, health and segment up to date, look, and show it; ``facts`` says whose test.toml is taken.

    Their products are those of the full run; what else is found is shown and never written. Raises AbsentError, after
    what its sensors say, for a log without a firing.
    """
    from hfanalysis.performance.quick import OWN

    facts = facts or OWN
    try:
        found = _look(bring("segment", request), facts)
    except AbsentError as missing:
        _show(_of_sensors(bring("health", request), str(missing), facts), request)
        raise
    _show(found, request)


def _look(context: Context, facts: Facts) -> QuickLook:
    from hfanalysis.inference.adopted.effects import read_adopted
    from hfanalysis.performance.quick import quick_look
    from hfanalysis.products.health import Health
    from hfanalysis.products.segments import Segments

    at = context.at(load_stage("calibrate"))
    log, definition = at.believed()
    effects = read_adopted(context.root, context.definition).acting
    samples = int(at.parameter("samples"))
    return quick_look(log, context.read(Segments), definition, context.read(Health), effects, samples, facts)


def _of_sensors(context: Context, why: str, facts: Facts) -> QuickLook:
    from hfanalysis.performance.quick import nothing_happened
    from hfanalysis.products.health import Health

    return nothing_happened(context.definition, context.read(Health), why, facts)


def _show(found: QuickLook, request: Request) -> None:
    if request.as_json:
        from hfanalysis.products.disk import to_json

        put(to_json(found.to_json()))
    elif not request.quiet:
        from hfanalysis.cli.tables import show_quick

        show_quick(found)
    for warning in found.warnings:
        tell(f"warning: {warning}")
