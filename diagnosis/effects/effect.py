"""The base class of all effects: kinds of physics that a sim may lack."""

import inspect
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from diagnosis.effects.parts import (
    EffectWords,
    Interval,
    JointMotion,
    Parameter,
    PlacedEffect,
    PlaceKind,
    Values,
)
from diagnosis.verdict.verdict import When
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Base, Plant
    from diagnosis.traces.trace import Trace
    from diagnosis.traces.usage import Usage

STRETCHES = (0.4, 1.0, 2.5)
"""Multiples of a guessed size that are tried before it is fitted."""

LIMITS = (0.6, 0.7, 0.8, 0.9, 1.0, 1.15, 1.3)
"""Multiples of a guessed limit that are tried. A joint too weak for its load collapses,
so the gradient at the guess is useless."""

STIFFNESSES = (0.3, 0.6, 1.0, 1.7, 3.0, 5.0, 8.0)
"""Multiples of a guessed stiffness that are tried: between two resonances the gradient
points to neither."""

LEAST_STRETCH = 1e-3
"""Smallest divisor of a value whose neutral value is infinite."""


class Effect(ABC):
    """One kind of physics that a sim may lack.

    A subclass states name, kind of place, parameters, places, and how a variant of a
    plant gets the effect. All else has a default. Effects of your own are objects of
    such subclasses within `diagnosis.effects.also_known`.

    Example:
      See docs/python.md, "An effect of your own".
    """

    name: ClassVar[str]
    """Unique, lower case with underscores; what verdicts call it."""

    place_kind: ClassVar[PlaceKind]
    """What it is attached to."""

    native: ClassVar[bool]
    """Whether MuJoCo has it, so that a corrected MJCF can hold it."""

    words: ClassVar[EffectWords]
    """Words for reports; made from the name and the docstring unless stated."""

    components: ClassVar[int] = 1
    """How many of the first values are components of one vector. Each component is
    tried alone, and what they do together is the sum."""

    timed: ClassVar[bool] = False
    """Whether the last two values are start [s] and duration [s]. Such an effect is
    tried at the times at which the recordings show a short error."""

    threshold: ClassVar[bool] = False
    """Whether it acts only beyond its first value, as a limit or a stop does. Its size
    cannot be extrapolated from a first try."""

    stiff: ClassVar[bool] = False
    """Whether it is a spring in the drive, which needs half the time step. Its first
    value is the stiffness."""

    joint_by_joint: ClassVar[bool] = True
    """Whether all joints may be tried in one replay, because the effect at one joint
    hardly moves the others."""

    at_tips: ClassVar[bool] = False
    """Whether it is tried first at the outermost bodies, where it shows most."""

    on_every_servo: ClassVar[bool] = True
    """Whether an incomplete robot model may lack it at all joints; False for faults of
    single joints. Only counts where the place is a joint or its signals."""

    rarity_nats: ClassVar[float] = 0.0
    """Prior: extra log-likelihood [nats] that a rare effect needs."""

    main_parameters: ClassVar[tuple[str, ...]] = ()
    """Names of the parameters that say how large the effect is; all where empty."""

    column_parameter: ClassVar[int] = 0
    """Number of the parameter that `torque_column` is proportional to."""

    by_inverse_dynamics: ClassVar[bool] = False
    """Whether the torque that it adds is that of a changed model or pose, found by
    inverse dynamics instead of `torque_column`."""

    def __init_subclass__(cls, **options: Any) -> None:
        """Make words for an effect that has a name and states no words."""
        super().__init_subclass__(**options)
        stated = vars(cls)
        if "name" in stated and "words" not in stated:
            label = cls.name.replace("_", " ")
            kind = getattr(cls, "place_kind", "")
            where = f"{{{kind}}}" if kind in ("joint", "body") else "the robot"
            meaning = (inspect.getdoc(cls) or "").partition("\n")[0]
            cls.words = EffectWords(label, f"{where} has {label} {{lacking}}", meaning)

    @abstractmethod
    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The effect's parameters, with bounds and sizes that suit the place."""

    @abstractmethod
    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """Where the effect may be, given the robot and what was recorded."""

    @abstractmethod
    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Put the effect into one variant of the plant.

        Effects are applied one after another; each adds to what is there.

        Args:
          variants: of the plant, changed in place.
          row: number of the variant.
          place: one of `places`.
          values: (p,) of the parameters.
        """

    def apply_to_sim(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Put the effect into a corrected sim, whose ground is a terrain of its own.

        Arguments are those of `apply`.

        Raises:
          BadModelError: such a sim cannot have it.
        """
        self.apply(variants, row, place, values)

    def obstacle(self, recorded: "Base", base: "Base") -> str:
        """Why a robot cannot have what recordings showed; "" if it can.

        Args:
          recorded: base of the robot in the recordings.
          base: base of the robot that gets the effect.
        """
        return ""

    def first_tries(
        self,
        plant: "Plant",
        place: str,
        usage: "Usage",
        intervals: Sequence[Interval],
    ) -> list[Values]:
        """Values to begin with; one set will do where an effect is nearly linear.

        Args:
          plant: nominal.
          place: one of `places`.
          usage: how the recordings use each joint.
          intervals: times at which something may have acted for a while.
        """
        typical = tuple(p.typical for p in self.parameters(plant, place))
        if self.components == 1 and not self.timed:
            return [typical]
        vectors, rest = (
            one_by_one(typical[: self.components]),
            typical[self.components :],
        )
        if not self.timed:
            return [vector + rest for vector in vectors]
        between = rest[:-2]
        return [vector + between + when for when in intervals for vector in vectors]

    def sizes_to_scan(
        self, plant: "Plant", placed: PlacedEffect, traces: Sequence["Trace"]
    ) -> list[PlacedEffect]:
        """The effect in several sizes around a guess, of which the best is fitted.

        Args:
          plant: nominal.
          placed: the guess.
          traces: recordings that the fit uses.
        """
        if not (self.threshold or self.stiff):
            return [self.stretched(plant, placed, factor) for factor in STRETCHES]
        first, *rest = placed.values
        factors = LIMITS if self.threshold else STIFFNESSES
        return [replace(placed, values=(k * first, *rest)) for k in factors]

    def stretched(
        self, plant: "Plant", placed: PlacedEffect, factor: float
    ) -> PlacedEffect:
        """The effect `factor` times as large, within its bounds.

        The first value changes, or the components of a vector. An effect with a
        threshold stays as it is.
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

    def neutral_values(self, plant: "Plant", placed: PlacedEffect) -> Values:
        """Values at which the effect is absent; some may be infinite."""
        return tuple(one.neutral for one in self.parameters(plant, placed.place))

    def grown_from(self, other: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Starts of a fit, if a simpler effect at the same place was found to help.

        An effect that contains a simpler one returns itself with values that continue
        the simpler one's; a fit that begins elsewhere may never get there.
        """
        return ()

    def simpler(self, placed: PlacedEffect) -> PlacedEffect:
        """The simpler effect that this one contains, or the effect itself."""
        return placed

    def twins(self, plant: "Plant", place: str) -> tuple[PlacedEffect, ...]:
        """Effects that no recording of this robot can distinguish from this one."""
        return ()

    def acted(self, placed: PlacedEffect, first_s: float, last_s: float) -> When:
        """The time in which the effect acted: always, during a burst, or as a drift.

        Args:
          placed: the effect with its values.
          first_s: time of the first row of all recordings.
          last_s: time of the last row.
        """
        if self.timed:
            start_s, duration_s = placed.values[-2:]
            if start_s > first_s or start_s + duration_s < last_s:
                return When("burst", start_s, start_s + duration_s)
        return When()

    def torque_column(self, motion: JointMotion) -> FloatArray | None:
        """(rows,) torque [N m] that the effect adds at a joint, for a parameter of 1.

        Only for effects that are linear, or nearly so, in the parameter of number
        `column_parameter`; None for all others. Sparse regression uses it.
        """
        return None

    def from_column(
        self, size: float, error: float, damping_nm_s_rad: float
    ) -> tuple[str, float, float]:
        """Name, value and standard error for the size of a `torque_column`.

        Args:
          size: by which the column was multiplied.
          error: standard error of the size.
          damping_nm_s_rad: damping of the servo and back-EMF at the joint.
        """
        return self.name, size, error


def one_by_one(values: Values) -> list[Values]:
    """Vectors with one of some components each, the others being zero."""
    return [
        tuple(value if i == axis else 0.0 for i, value in enumerate(values))
        for axis in range(len(values))
    ]
