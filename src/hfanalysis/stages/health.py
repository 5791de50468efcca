"""health: which channels can be believed, before any of them is.

Reads ``ingest.h5`` and, of a stand with other tests, their raw logs; writes ``health.json``. Every stage after it takes
its log from :meth:`hfanalysis.stages.base.Context.log`, without the stretches that are unusable.
"""

from __future__ import annotations

from hfanalysis.stages.base import Context, Stage
from hfanalysis.stages.stand import nearest


def run(context: Context) -> None:
    """Judge every channel by itself, then with each other, last against the other tests of the stand."""
    from hfanalysis.health.judge import judge
    from hfanalysis.record.log import read_log
    from hfanalysis.stages.sisters import sisters

    context.write(judge(read_log(context.product("ingest.h5")), context.definition, sisters(context)))


STAGE = Stage(name="health", needs=("ingest",), products=("health.json",), run=run, adopts=False, others=nearest)
