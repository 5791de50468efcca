"""What an effect is: a small object that plugs into the engine's sites, and how several are composed.

An effect acts through a compiled ``term`` (:mod:`hfanalysis.engine.sites`), which may have states of its own and a
switch where it has a corner, or through ``distort``, which changes what a sensor reads. At strength 0 an effect is
left out altogether, so that the engine is exactly the base model; active effects act in the order of their names.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.sentences import Text, said

if TYPE_CHECKING:
    from hfanalysis.engine.unsteady import Engine

Channels = Mapping[str, Array]
Distortion = Callable[[Array, Channels, Mapping[str, float]], dict[str, Array]]
FadingWeb = Callable[[Mapping[str, float]], float]

EQUATIONS = (
    "tank_energy", "tank_volume", "injector", "feed", "grain", "chamber_mass", "chamber_energy", "nozzle", "sensor",
)  # fmt: skip
"""The governing equations in which an effect can be missing."""


@dataclass(frozen=True)
class Parameter:
    """A number of an effect, in SI: its name, unit, what it says, and its prior.

    ``typical`` is the physical scale: the prior's standard deviation about ``center`` (a strength's center is 0),
    ``low`` and ``high`` bound it. A ``given`` parameter is stated by the test and not estimated. ``acting``: from when
    to when [s after the opening] it makes a difference at all, whatever its value; slopes cost nothing elsewhere. An
    ``inner`` one says what the effect is, and stands in no file.
    """

    name: str
    unit: str
    meaning: str
    typical: float
    center: float = 0.0
    low: float = -np.inf
    high: float = np.inf
    given: bool = False
    acting: tuple[float, float] = (-np.inf, np.inf)
    inner: bool = False


@dataclass(frozen=True)
class OwnState:
    """A state that an effect brings along: what counts as small of it, and where it starts."""

    name: str
    unit: str
    scale: float
    start: Callable[[Engine, Mapping[str, float]], float]


@dataclass(frozen=True)
class Believable:
    """The largest size of a strength that a careful engineer believes of a small stand, and why no larger.

    ``parameter``: the strength it is of (of all of them where an effect has several of one kind); ``most`` [SI]; shown
    in ``unit``, of which there are ``factor`` to one of SI. Below ``least`` [SI] it cannot be at all, by ``least_why``.
    """

    parameter: str
    most: float
    why: str
    unit: str = ""
    factor: float = 1.0
    least: float = -np.inf
    least_why: str = ""

    def text(self, value: float) -> Text:
        """A size [SI] as people read it."""
        return said(value, self.unit, size=1.0 / self.factor)


@dataclass(frozen=True)
class Effect:
    """A physical or sensor effect that the report's model lacks; the first parameter is its strength.

    ``sites`` are those of :mod:`hfanalysis.engine.sites` that its term sets, or the channels that it distorts. Where
    the first ``strengths`` parameters are strengths of their own kind (one per transducer), it is the base model when
    all of them are 0. ``fading_web``: from its values, the web [m] over which the burning surface goes as the fuel
    ends; how fast the fire goes out is compared beside the channels. ``reads``: sites that others set and its term
    asks for; it comes after them. ``far_starts``: strengths [SI] from which a fit starts besides, where calibrated
    constants take the effect's place so well that a small one leads elsewhere. ``plain_name``: what people call it who
    do not know the code; ``believable``: the largest size that can be on a stand; ``stand_only``: what of the stand it
    is of, where the engine does not have it in flight. An effect of the engine may have a distortion besides, where a
    channel that no equation has shows it.
    """

    name: str
    equation: str
    meaning: str
    reference: str
    parameters: tuple[Parameter, ...]
    phases: tuple[str, ...]
    term: Any = None
    switch: Any = None
    states: tuple[OwnState, ...] = ()
    distort: Distortion | None = None
    twins: tuple[str, ...] = ()
    decisive: str = ""
    formula: str = ""
    sites: tuple[str, ...] = ()
    strengths: int = 1
    fading_web: FadingWeb | None = None
    reads: tuple[str, ...] = ()
    far_starts: tuple[float, ...] = ()
    plain_name: str = ""
    believable: Believable | None = None
    stand_only: str = ""

    def __post_init__(self) -> None:
        if self.equation not in EQUATIONS:
            raise ValueError(f"{self.name}: no governing equation is called {self.equation!r}")
        if self.term is None and self.distort is None:
            raise ValueError(f"{self.name}: an effect has a term or a distortion")

    @property
    def of_sensor(self) -> bool:
        """Whether it acts on what sensors read alone."""
        return self.term is None

    @property
    def strength(self) -> Parameter:
        """The parameter that is 0 in the base model."""
        return self.parameters[0]

    def at(self, **values: float) -> Active:
        """This effect with values [SI]; parameters that are left out have their prior's center."""
        names = [p.name for p in self.parameters]
        if wrong := set(values) - set(names):
            raise ValueError(f"{self.name} has no parameter {sorted(wrong)}; it has {names}")
        return Active(self, tuple(float(values.get(p.name, p.center)) for p in self.parameters))


@dataclass(frozen=True)
class Active:
    """An effect with the values of its parameters [SI]."""

    effect: Effect
    values: tuple[float, ...]

    @property
    def named(self) -> dict[str, float]:
        """Values [SI] by the parameters' names."""
        return {p.name: v for p, v in zip(self.effect.parameters, self.values, strict=True)}

    @property
    def strengths(self) -> dict[str, float]:
        """Values [SI] of its strengths by their names."""
        return dict(list(self.named.items())[: self.effect.strengths])

    @property
    def idle(self) -> bool:
        """Whether every strength is 0."""
        return not any(self.strengths.values())


@dataclass(frozen=True)
class Composition:
    """Active terms as the compiled equations read them.

    ``constants`` are the engine's, followed by the terms' parameters; ``terms`` has a row per term (addresses,
    where its parameters and states begin); ``scales`` of the own states; ``active`` in the order of the rows.
    """

    constants: Array
    terms: NDArray[np.int64]
    scales: Array
    active: tuple[Active, ...]

    def initial(self, engine: Engine) -> Array:
        """Where the own states start [SI], (own states,)."""
        return np.array([s.start(engine, a.named) for a in self.active for s in a.effect.states], dtype=np.float64)


def compose(effects: Sequence[Active], constants: Array, states: int, idle: bool = False) -> Composition:
    """Effects with terms in canonical order; ``constants`` (n,) are the engine's [SI], ``states`` of the engine precede
    their own.

    Idle effects are left out unless they are asked for (their tangents need them). Raises ValueError for an effect that
    is named twice.
    """
    names = [a.effect.name for a in effects]
    if len(set(names)) < len(names):
        raise ValueError(f"an effect is named twice: {sorted(names)}")
    acting = [a for a in effects if a.effect.term is not None and (idle or not a.idle)]
    acting.sort(key=lambda a: (bool(a.effect.reads), a.effect.name))
    rows, values, parameters_at, states_at = [], [constants], constants.size, states
    for a in acting:
        switch = 0 if a.effect.switch is None else a.effect.switch.address
        rows.append((a.effect.term.address, switch, parameters_at, states_at))
        values.append(np.array(a.values))
        parameters_at += len(a.values)
        states_at += len(a.effect.states)
    terms = np.array(rows, dtype=np.int64).reshape(len(rows), 4)
    scales = np.array([s.scale for a in acting for s in a.effect.states], dtype=np.float64)
    return Composition(np.concatenate(values), terms, scales, tuple(acting))
