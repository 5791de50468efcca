"""From a test's product folder to the material of its page."""

from __future__ import annotations

from hfanalysis.products.disk import read_json
from hfanalysis.products.kinds import KINDS
from hfanalysis.record.limits import read_limits
from hfanalysis.record.team_notes import read_notes
from hfanalysis.report.limits import known_quantities
from hfanalysis.report.material import Last, Material, Notes, read_store
from hfanalysis.stages.base import BASE, Context, load_stage
from hfanalysis.stages.stand import before, of_before

_LOG = "ingest.h5"


def load(context: Context) -> Material:
    """Every product of the stages that ran, and why the others have none."""
    products, stores, absent = {}, {}, {}
    page = load_stage("report")
    for stage in map(load_stage, page.upstream):
        for path in map(context.product, stage.products):
            if stage.name in context.absent:
                absent[path.stem] = context.absent[stage.name]
            elif path.suffix == ".json" and not path.name.startswith(BASE):
                products[path.stem] = context.read(KINDS[path.name])
            elif path.suffix == ".h5" and path.name != _LOG:
                stores[path.stem] = read_store(path)
    rules = read_limits(context.root, context.definition.test.stand, known_quantities())
    notes = Notes(*read_notes(context.definition.folder))
    return Material(context.definition, context.marked(), products, stores, absent, _last(context), rules, notes)


def _last(context: Context) -> Last | None:
    """The stand's test before, where it has been analysed."""
    found, paths = before(context), of_before(context)
    if found is None or not paths:
        return None
    read = {path.stem: KINDS[path.name].from_json(read_json(path)) for path in paths}
    return Last(found.test.id, found.test.date, read)
