"""Many runs at once: threads, for the compiled equations hold no lock."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.processors import processors


def burn_many(engines: Sequence[Engine], *, workers: int | None = None, **options: Any) -> list[Burn | str]:
    """Every engine as by :func:`hfanalysis.engine.unsteady.burn` with ``options`` [s, SI], in order.

    An engine that is refused has its reason in place of a run. ``workers``: default one for each core this process may
    use.
    """

    def attempt(engine: Engine) -> Burn | str:
        try:
            return burn(engine, **options)
        except (ValueError, ArithmeticError) as error:
            return str(error)

    with ThreadPoolExecutor(workers or processors()) as pool:
        return list(pool.map(attempt, engines))
