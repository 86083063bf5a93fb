"""The base classes of effects: kinds of physics that a sim may lack."""

import inspect
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from diagnosis.effects.parts import (
    EffectWords,
    JointMotion,
    Parameter,
    PlaceKind,
    Values,
    Variety,
)
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Base, Plant
from diagnosis.traces.trace import Trace
from diagnosis.traces.usage import Usage
from diagnosis.verdict import PlacedEffect, When
from groundwalk.arrays import FloatArray

STRETCHES = (0.4, 1.0, 2.5)
"""Factors on a guessed size of an effect that are tried before the size is fitted."""

LIMITS = (0.6, 0.7, 0.8, 0.9, 1.0, 1.15, 1.3)
"""Factors on a guessed torque or speed limit that are tried before it is fitted. They
are close: where a joint too weak for its load collapses, gradients are useless."""

STIFFNESSES = (0.3, 0.6, 1.0, 1.7, 3.0, 5.0, 8.0)
"""Factors on a guessed stiffness: between resonances the gradient points to none."""

LEAST_STRETCH = 1e-3
"""Smallest factor by which a value is divided, where infinity stands for no effect."""


class Effect(ABC):
    """One kind of physics that a sim may lack.

    A subclass states name, kind of place, parameters, places, and how a copy of a robot
    model gets the effect. All else has a default. Use objects of subclasses of your own
    within `diagnosis.effects.also_known`.

    Example:
      See docs/python.md, "Physics of your own".
    """

    name: ClassVar[str]
    """Name of the effect in verdicts: unique, lower case with underscores."""

    place_kind: ClassVar[PlaceKind]
    """Kind of thing that the effect is attached to, such as "joint"."""

    shown_by: ClassVar[Variety | None] = None
    """What a joint's motion must have to show the effect as itself; None if any does.
    Reports say so where recordings do not tell it from another effect."""

    replayed: ClassVar[bool] = True
    """Whether replays show the effect; False if only compared torques do."""

    native: ClassVar[bool]
    """Whether MuJoCo can simulate the effect, so that an MJCF file can contain it; of
    torques (`TorqueEffect`) those that never change."""

    no_law: ClassVar[str] = ""
    """Why no law for single steps adds the effect to a model that lacks it; "" if one
    does, or if MuJoCo can simulate the effect."""

    words: ClassVar[EffectWords]
    """Words for reports; made from the effect's name and class docstring by default."""

    components: ClassVar[int] = 1
    """Number of first values that form a vector; its parts are tried one by one."""

    only_grown: ClassVar[bool] = False
    """Whether the effect is tried only in place of a simpler one, see `grown_from`."""

    timed: ClassVar[bool] = False
    """Whether the effect's last two values are start [s] and duration [s]. If so, it is
    tried at the times at which the recordings show a short error."""

    lasting: ClassVar[bool] = True
    """Whether a timed effect is also tried as acting all the time."""

    threshold: ClassVar[bool] = False
    """Whether the effect acts only beyond its first value, as a limit or a stop does.
    If so, its size cannot be extrapolated from a first try."""

    stiffens: ClassVar[bool] = False
    """Whether the first value is a factor on the stiffness of servos."""

    scales_servo: ClassVar[bool] = False
    """Whether its torque is a share of its servo's, so that it explains much of what
    other loads do, such as another mass or friction."""

    stiff: ClassVar[bool] = False
    """Whether it is a spring in the drive, whose stiffness is the first value."""

    finer: ClassVar[int] = 1
    """Number of steps, 1, 2 or 4, that simulations with the effect take for one."""

    joint_by_joint: ClassVar[bool] = True
    """Whether one simulation may try the effect at all joints together, because at one
    joint it hardly moves the others."""

    at_tips: ClassVar[bool] = False
    """Whether the effect is first tried at outermost bodies, where it shows most."""

    on_every_servo: ClassVar[bool] = True
    """Whether a simple robot model may lack the effect at all joints; False for faults
    of single joints. Only used where the place is a joint or its signals."""

    of_motor: ClassVar[bool] = True
    """Whether joints with the same motor have about the same values; False for what
    differs from joint to joint. Only used where `on_every_servo` is True."""

    jumps: ClassVar[bool] = False
    """Whether its torque jumps where a joint turns back: long steps distort it most."""

    rarity_nats: ClassVar[float] = 0.0
    """Prior: extra log-likelihood [nats] that a rare effect needs to be accepted."""

    main_parameters: ClassVar[tuple[str, ...]] = ()
    """Names of the parameters that say how large the effect is; empty means all."""

    column_parameter: ClassVar[int] = 0
    """Index of the parameter whose value scales the torque of `torque_column`."""

    by_inverse_dynamics: ClassVar[bool] = False
    """Whether sparse regression computes the effect's torque by inverse dynamics of a
    changed model or pose, instead of by `torque_column`."""

    def __init_subclass__(cls, **options: Any) -> None:
        """Make the report texts `words` of a subclass that has a name but no words."""
        super().__init_subclass__(**options)
        stated = vars(cls)
        if "name" in stated and "words" not in stated:
            label = cls.name.replace("_", " ")
            kind = getattr(cls, "place_kind", "")
            where = f"{{{kind}}}" if kind in ("joint", "body") else "the robot"
            meaning = (inspect.getdoc(cls) or "").partition("\n")[0]
            cls.words = EffectWords(label, f"{where} has {label} {{lacking}}", meaning)

    @abstractmethod
    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The effect's parameters, with bounds and typical values for this place."""

    @abstractmethod
    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of places where the robot may have the effect, given its recordings."""

    @abstractmethod
    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Put the effect into one of n copies (row) of the robot model, in place.

        Each effect adds to those applied before. The values (p,) are in the order of
        `parameters`.
        """

    def apply_to_sim(
        self, copies: Variants, row: int, place: str, values: FloatArray
    ) -> None:
        """Put the effect into a model of a sim world, whose ground is a heightfield.

        The arguments are those of `apply`.

        Raises:
          BadModelError: a sim world cannot have this effect.
        """
        self.apply(copies, row, place, values)

    def tolerance(self, plant: Plant, place: str) -> float:
        """Standard deviation to which a model states this effect's first value.

        In the value's unit, or its logarithm's if logarithmic; of each component of a
        vector. 0 if the effect is no matter of degree, such as a push.
        """
        return 0.0

    def spread(self, plant: Plant, place: str) -> float:
        """Standard deviation, as `tolerance`, on robots with a model of usual care."""
        return self.tolerance(plant, place)

    def faintest(self, plant: Plant, place: str) -> float | None:
        """First value of the least size that can be told; None if any size can.

        Less of it lies within what every model of a robot leaves out.
        """
        return None

    def obstacle(self, recorded: Base, base: Base) -> str:
        """Why a sim with a `base` cannot have the effect; "" if it can."""
        return ""

    def first_tries(self, plant: Plant, place: str, usage: Usage) -> list[Values]:
        """Values to try first; one set is enough where the effect is nearly linear.

        None of an effect that is `only_grown`.
        Start and duration of a timed effect are replaced by those of short errors.
        """
        if self.only_grown:
            return []
        typical = tuple(one.typical for one in self.parameters(plant, place))
        size = self.components
        vectors = [
            tuple(value if i == axis else 0.0 for i, value in enumerate(typical[:size]))
            for axis in range(size)
        ]
        return [vector + typical[size:] for vector in vectors]

    def sizes_to_scan(
        self, plant: Plant, placed: PlacedEffect, traces: Sequence[Trace]
    ) -> list[PlacedEffect]:
        """The effect in several sizes around a guess; the fit starts from the best."""
        if not (self.threshold or self.stiff):
            return [self.stretched(plant, placed, factor) for factor in STRETCHES]
        first, *rest = placed.values
        factors = LIMITS if self.threshold else STIFFNESSES
        return [replace(placed, values=(k * first, *rest)) for k in factors]

    def stretched(
        self, plant: Plant, placed: PlacedEffect, factor: float
    ) -> PlacedEffect:
        """The effect `factor` times as large, within its parameters' bounds.

        Only the first value is scaled, or all components of a vector. An effect with a
        threshold is returned unchanged.
        """
        if self.threshold:
            return placed
        values = list(placed.values)
        every = self.parameters(plant, placed.place)
        for i, one in enumerate(every[: self.components]):
            value = one.neutral + factor * (values[i] - one.neutral)
            if not np.isfinite(one.neutral):
                value = values[i] / max(factor, LEAST_STRETCH)
            values[i] = min(max(value, one.low), one.high)
        return replace(placed, values=tuple(values))

    def neutral_values(self, plant: Plant, placed: PlacedEffect) -> Values:
        """Values at which the effect is absent; some may be infinite."""
        return tuple(one.neutral for one in self.parameters(plant, placed.place))

    def grown_from(self, other: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """The effect, started from a simpler one that it contains; () from others."""
        return ()

    def simpler(self, placed: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Simpler effects that `placed` contains, with start values; () if none."""
        return ()

    def native_part(self, placed: PlacedEffect) -> PlacedEffect | None:
        """What MuJoCo can simulate of the effect, as an effect; None for nothing."""
        return placed if self.native else None

    def softer(self, plant: Plant, placed: PlacedEffect) -> PlacedEffect:
        """The effect where parts that it takes as rigid yield, as far as they may.

        It has further values than `parameters` says, which only `apply` knows: by how
        much the others depend on that rigidity is part of their uncertainty.
        """
        return placed

    def twins(self, plant: Plant, place: str) -> tuple[PlacedEffect, ...]:
        """Effects that recordings of this robot cannot distinguish from this one."""
        return ()

    def acted(self, placed: PlacedEffect, first_s: float, last_s: float) -> When:
        """Whether the effect acted always, during a burst or as a drift.

        The recordings last from `first_s` to `last_s`.
        """
        if self.timed:
            start_s, duration_s = placed.values[-2:]
            end_s = start_s + duration_s
            if first_s < start_s <= last_s or end_s < last_s:
                return When("burst", start_s, max(min(end_s, last_s), start_s))
        return When()

    def torque_column(self, motion: JointMotion) -> FloatArray | None:
        """(rows,) joint torque [N m] if `column_parameter` is 1; None if not linear."""
        return None

    def from_column(
        self, size: float, error: float, damping_nm_s_rad: float
    ) -> tuple[str, float, float]:
        """Effect name, value and standard error from a coefficient of `torque_column`.

        The damping is that of the servo at the joint, plus its motor's back-EMF.
        """
        return self.name, size, error
