"""From a test's product folder to the material of its page."""

from __future__ import annotations

from hfanalysis.products.disk import read_json
from hfanalysis.products.kinds import KINDS
from hfanalysis.report.material import Last, Material, read_store
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
    return Material(context.definition, context.marked(), products, stores, absent, last=_last(context))


def _last(context: Context) -> Last | None:
    """The stand's test before, where it has been analysed."""
    found, paths = before(context), of_before(context)
    if found is None or not paths:
        return None
    read = {path.stem: KINDS[path.name].from_json(read_json(path)) for path in paths}
    return Last(found.test.id, found.test.date, read)
