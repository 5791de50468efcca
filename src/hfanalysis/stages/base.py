"""What a stage is, and what it works with.

A stage is a module of this package that says what it needs, what it writes and how::

    # stages/segment.py
    def run(context: Context) -> None:
        log = context.log()                                      # the log of ingest, without what is unusable
        ...
        context.write(find_phases(log, context.definition))      # a product's model; test and provenance are added

    STAGE = Stage(name="segment", needs=("ingest", "health"), products=("segments.json",), run=run)

Products that are not JSON are written to ``context.scratch("residuals.h5")``, a temporary name in the product folder.
Nothing appears under its final name before ``run`` has returned. Optional fields: ``wants`` (stages to run first whose
absence, AbsentError, does not stop this one: ask ``context.absent``), ``parameters`` (settings with their defaults,
read with ``context.parameter("name")``; they are part of what decides whether a product is up to date), ``least`` (the
smallest value of those that have one) and ``adopts``
(False for a stage that adopted effects do not change: neither their file nor products made with them are its input),
``tries_effects`` (True for one that looks through the whole library: a team's own effects are its input), ``runs``
(stages that this one runs itself, on other tests: what their code and that of the stages before them says is part of
what it rests on, as everything is that the module imports) ``others`` (the other tests that this one reads the raw
files of: they are its input, too) and ``beside`` (finished products of other tests, and
what a team has laid there of its own, that it reads where they are there).
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from hfanalysis.errors import InputError
from hfanalysis.products import disk as products
from hfanalysis.progress import Progress, silent
from hfanalysis.record.definition import TestDefinition
from hfanalysis.stages import ORDER
from hfanalysis.units import near

if TYPE_CHECKING:
    from hfanalysis.products.health import Health
    from hfanalysis.products.model import Product
    from hfanalysis.record.log import TestLog

P = TypeVar("P", bound="Product")
HEALTH = "health"
"""The stage that says what of the log can be believed."""
SEGMENT = "segment"
"""The stage that says which of several firings is looked at."""
BASE = "base_"
"""How a product's name begins that is made without adopted effects, by a stage that also makes one with them."""


@dataclass(frozen=True)
class Stage:
    """One step of the way through: what it needs, what it writes, and the function that does it."""

    name: str
    needs: tuple[str, ...]
    products: tuple[str, ...]
    run: Callable[[Context], None]
    wants: tuple[str, ...] = ()
    parameters: Mapping[str, Any] = field(default_factory=dict)
    least: Mapping[str, float] = field(default_factory=dict)
    adopts: bool = True
    tries_effects: bool = False
    runs: tuple[str, ...] = ()
    others: Callable[[Context], Sequence[TestDefinition]] = lambda _: ()
    beside: Callable[[Context], Sequence[Path]] = lambda _: ()

    def reads(self, other: Stage) -> tuple[str, ...]:
        """The products of an upstream stage that this one's products follow from."""
        if self.adopts or not other.adopts:
            return other.products
        return tuple(name for name in other.products if name.startswith(BASE))

    @property
    def upstream(self) -> tuple[str, ...]:
        """The stages to run first, in order."""
        return self.needs + self.wants


def load_stage(name: str) -> Stage:
    """The stage of that name; its module is imported only now, so that starting up stays light."""
    if name not in ORDER:
        raise InputError(f"there is no stage {name!r}{near(name, ORDER)}; expected one of {', '.join(ORDER)}")
    stage = importlib.import_module(f"hfanalysis.stages.{name}").STAGE
    assert isinstance(stage, Stage)
    return stage


@dataclass(frozen=True)
class Context:
    """One test as a stage sees it.

    Attributes:
        root: the folder that holds ``raw_tests/`` and ``processed/``.
        definition: what the engineer knows about the test (``test.toml``).
        out: the product folder of this test.
        progress: called with what is being done.
        settings: parameters set for this run, by ``"stage.parameter"``.
        absent: why a stage that ran before has no products, by stage name.
        record: what the products are made from (the ``provenance`` block); filled in by the runner.
        stage: the stage that is running.
    """

    root: Path
    definition: TestDefinition
    out: Path
    progress: Progress = silent
    settings: Mapping[str, Any] = field(default_factory=dict)
    absent: Mapping[str, str] = field(default_factory=dict)
    record: Mapping[str, Any] = field(default_factory=dict)
    stage: Stage | None = None

    @property
    def id(self) -> str:
        """The test's name: that of its folder."""
        return self.definition.test.id

    @property
    def raw(self) -> Path:
        """The folder of the raw files; only ever read."""
        return self.definition.path.parent

    def product(self, name: str) -> Path:
        """Where a finished product is found; ``{test}`` in its name stands for the test's."""
        return self.out / name.replace("{test}", self.id)

    def read_json(self, name: str) -> dict[str, Any]:
        """The data of a finished JSON product."""
        return products.read_json(self.product(name))

    def scratch(self, name: str) -> Path:
        """Where to write a product of the running stage; it gets its final name when the stage is done."""
        if self.stage is None or name not in self.stage.products:
            raise ValueError(f"{name} is not declared as a product of this stage")
        return products.temporary_path(self.product(name))

    def read(self, product: type[P], name: str = "") -> P:
        """A finished JSON product, of another name than its usual one where that is given."""
        return product.from_json(self.read_json(name or product.file))

    def write(self, product: Product, name: str = "") -> None:
        """Write a JSON product of the running stage, with the test's name first and its provenance last.

        Its quantities that rest on a suspect channel are doubted in it.
        """
        if self._judged:
            from hfanalysis.health.doubts import doubted

            product = doubted(product, self._health())
        self.write_json(name or product.file, product.to_json())

    def log(self, *, widened: bool = True) -> TestLog:
        """The log that a stage works with: that of ingest, without what is unusable, and after the phases are found
        without other firings.

        ``widened``: with the accuracy of suspect channels as wide as what is found may mean.
        """
        from hfanalysis.health import usable
        from hfanalysis.record.log import read_log

        log, health = read_log(self.product("ingest.h5")), self._health()
        used = self._of_firing(usable.usable(log, health, self.definition))
        return usable.widened(used, health) if widened else used

    def _of_firing(self, log: TestLog) -> TestLog:
        """The part of the log in which the phases were looked for, its zeros from the rest before that firing."""
        from hfanalysis.health.usable import of_firing
        from hfanalysis.products.segments import Segments

        if self.stage is None or SEGMENT not in self.stage.upstream:
            return log
        taken = self.read(Segments).taken
        return log if taken is None else of_firing(log, taken.start, taken.end, self.definition)

    def marked(self) -> TestLog:
        """The log of ingest with all that it has, for people to look at; what is unusable is flagged."""
        from hfanalysis.health import usable
        from hfanalysis.record.log import read_log

        return usable.marked(read_log(self.product("ingest.h5")), self._health(), self.definition)

    def believed(self) -> tuple[TestLog, TestDefinition]:
        """That log, and test.toml with its accuracies."""
        from hfanalysis.health.usable import as_accurate

        log = self.log()
        return log, as_accurate(self.definition, log)

    @property
    def _judged(self) -> bool:
        """Whether the running stage comes after the channels' health."""
        return self.stage is not None and HEALTH in self.stage.upstream

    def _health(self) -> Health:
        from hfanalysis.products.health import Health

        return self.read(Health)

    def write_json(self, name: str, data: Mapping[str, Any]) -> None:
        """Write a JSON product of the running stage, with the test's name first and its provenance last."""
        body = {"test": self.id, "source": self.definition.test.source, **data}
        body["provenance"] = {**self.provenance(), **data.get("provenance", {})}
        if name.startswith(BASE):
            body["provenance"]["effects"] = {}
        self.scratch(name).write_text(products.to_json(body), encoding="utf-8")

    def provenance(self) -> dict[str, Any]:
        """What the running stage's products are made from: hashes, versions, parameters."""
        return dict(self.record)

    def parameter(self, name: str) -> Any:
        """A parameter of the running stage: as set for this run, else its default."""
        return self.parameters()[name]

    def parameters(self) -> dict[str, Any]:
        """All parameters of the running stage."""
        if self.stage is None:
            return {}
        defaults = self.stage.parameters
        return {key: self.settings.get(f"{self.stage.name}.{key}", default) for key, default in defaults.items()}

    def at(self, stage: Stage, **changes: Any) -> Context:
        """This context for one stage."""
        return replace(self, stage=stage, **changes)
