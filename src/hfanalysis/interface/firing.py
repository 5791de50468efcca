"""A test as an object: its log, and all that the stages find in it."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from hfanalysis.errors import AbsentError
from hfanalysis.interface.bringing import bring
from hfanalysis.products.model import Product
from hfanalysis.progress import silent
from hfanalysis.stages import ASIDE, ORDER, RUN
from hfanalysis.stages.base import Context, load_stage
from hfanalysis.stages.open_test import open_test

if TYPE_CHECKING:
    import xarray as xr

    from hfanalysis.interface.plots import Plots
    from hfanalysis.products.calibration import Calibration
    from hfanalysis.products.diagnosis import Diagnosis
    from hfanalysis.products.flight import Flight
    from hfanalysis.products.health import Health
    from hfanalysis.products.segments import Segments
    from hfanalysis.products.validation import Validation
    from hfanalysis.progress import Progress
    from hfanalysis.record.definition import TestDefinition

P = TypeVar("P", bound=Product)


class Firing:
    """One test: ``raw_tests/NAME/`` below a root. What is asked for is brought up to date first, from what is kept.

    Records are typed, with every number in SI; arrays are xarray's, with ``units`` and ``long_name``. Times count from
    the valve's opening but in ``log``, whose clock is the logger's.
    """

    def __init__(
        self, name: str, root: str | Path = ".", out: str | Path | None = None, settings: dict[str, Any] | None = None
    ) -> None:
        """Raises :class:`InputError` where there is no such test or its test.toml is at fault."""
        self.root, self.settings = Path(root), dict(settings or {})
        self.out = None if out is None else Path(out)
        self.name = self._opened(name).id

    def run(self, to: str = RUN, *, force: bool = False, progress: Progress = silent, **settings: Any) -> Firing:
        """Bring a stage up to date, and what it needs first; by default all. Returns this firing.

        ``settings``: parameters of that stage, as ``run("calibrate", samples=2000)``, for this run and what is asked
        of this object from then on. Raises :class:`InputError` or :class:`AbsentError`.
        """
        self.settings |= {f"{to}.{name}": value for name, value in settings.items()}
        bring(to, self.root, self.name, self.out, force=force, settings=self.settings, progress=progress)
        return self

    @property
    def definition(self) -> TestDefinition:
        """What test.toml states, in SI."""
        return self._opened(self.name).definition

    @property
    def folder(self) -> Path:
        """Where its products are."""
        return self._opened(self.name).out

    @property
    def log(self) -> xr.Dataset:
        """The channels over the logger's time [s], with ``CHANNEL_flags``; 0 where a sample is good."""
        from hfanalysis.interface.trees import dataset

        return dataset(self._made("ingest", "ingest.h5"))

    @property
    def health(self) -> Health:
        """Which channels can be believed."""
        from hfanalysis.products.health import Health

        return self._record("health", Health)

    @property
    def segments(self) -> Segments:
        """When what happens."""
        from hfanalysis.products.segments import Segments

        return self._record("segment", Segments)

    @property
    def calibration(self) -> Calibration:
        """The constants of tank, feed line, injector and fuel."""
        from hfanalysis.products.calibration import Calibration

        return self._record("calibrate", Calibration)

    @property
    def validation(self) -> Validation:
        """The performance, and the model against the measurement."""
        from hfanalysis.products.validation import Validation

        return self._record("validate", Validation)

    @property
    def residuals(self) -> xr.DataTree:
        """Measured, model and their difference: ``residuals["full/p_chamber"]``."""
        return self._tree("validate", "residuals.h5")

    @property
    def histories(self) -> xr.DataTree:
        """Mixture, flows, regression, efficiencies and thrust over time."""
        return self._tree("validate", "performance.h5")

    @property
    def diagnosis(self) -> Diagnosis:
        """What the model lacks. It takes minutes, so it is not made unasked: ``run("diagnose")`` makes it."""
        from hfanalysis.products.diagnosis import Diagnosis

        return self._record("diagnose", Diagnosis)

    @property
    def sources(self) -> xr.DataTree:
        """Of the diagnosis: what acts over time, and residuals without and with it."""
        return self._tree("diagnose", "diagnosis.h5")

    @property
    def flight(self) -> Flight:
        """The rocket's flight on the measured thrust."""
        from hfanalysis.products.flight import Flight

        return self._record("flight", Flight)

    @property
    def trajectory(self) -> xr.DataTree:
        """That flight over time, with bands and the ways down."""
        return self._tree("flight", "flight.h5")

    @cached_property
    def plot(self) -> Plots:
        """Figures of matplotlib: ``plot.pressures()``."""
        from hfanalysis.interface.plots import Plots

        return Plots(self)

    def table(self) -> list[dict[str, Any]]:
        """Every quantity of the products that are there, a row each: ``pandas.DataFrame(firing.table())``."""
        from hfanalysis.products.tidy import rows_of_test

        return rows_of_test(self.folder)

    def __repr__(self) -> str:
        from hfanalysis.interface.shown import text

        return text(self)

    def _repr_html_(self) -> str:
        from hfanalysis.interface.shown import html

        return html(self)

    def _opened(self, name: str) -> Context:
        return open_test(self.root, name, self.out, settings=self.settings)

    def _made(self, stage: str, product: str) -> Path:
        """A product that is up to date. One that takes minutes is taken as it is."""
        if stage in ASIDE:
            path = self._opened(self.name).product(product)
            if not path.is_file():
                raise AbsentError(f'{self.name}: not diagnosed yet; .run("{stage}") does it, and takes minutes')
            return path
        return bring(stage, self.root, self.name, self.out, settings=self.settings).product(product)

    def _record(self, stage: str, kind: type[P]) -> P:
        from hfanalysis.products.disk import read_json

        return kind.from_json(read_json(self._made(stage, kind.file)))

    def _tree(self, stage: str, product: str) -> xr.DataTree:
        from hfanalysis.interface.trees import tree

        return tree(self._made(stage, product))

    def made(self) -> tuple[str, ...]:
        """The stages whose products are there, whether up to date or not; nothing is run."""
        context = self._opened(self.name)
        return tuple(
            name for name in ORDER if all(context.product(file).is_file() for file in load_stage(name).products)
        )


def open(test: str | Path, root: str | Path = ".", out: str | Path | None = None) -> Firing:
    """A test by its name below ``root/raw_tests``, or by its folder.

    Raises :class:`InputError` where there is none or its test.toml is at fault.
    """
    path = Path(test)
    if (path / "test.toml").is_file() and path.resolve().parent.name == "raw_tests":
        return Firing(path.resolve().name, path.resolve().parents[1], out)
    return Firing(str(test), root, out)


__all__ = ["Firing", "open"]
