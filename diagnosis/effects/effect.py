"""What an effect is: physics that a sim may lack, with a place and parameters."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Literal

from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.trace import Trace

PlaceKind = Literal[
    "joint", "body", "feet", "commands", "encoders", "gyroscope", "world"
]


@dataclass(frozen=True)
class Parameter:
    """One number of an effect.

    Attributes:
      name: what it is.
      unit: SI, radians, as it is where joints turn (see `Plant.unit`).
      low: least value that makes sense.
      high: largest value that makes sense.
      neutral: value at which the effect is not there.
      logarithmic: whether sizes are compared by ratio.
      typical: a size worth trying first.
    """

    name: str
    unit: str
    low: float
    high: float
    neutral: float
    typical: float
    logarithmic: bool = False


@dataclass(frozen=True)
class PlacedEffect:
    """An effect at a place, with values of its parameters in their order."""

    name: str
    place: str
    values: tuple[float, ...]

    @property
    def key(self) -> str:
        """Effect and place, for example `backlash@LKneePitch`."""
        return f"{self.name}@{self.place}"


class Effect(ABC):
    """One kind of physics; see `diagnosis.effects.library` for all of them."""

    name: ClassVar[str]
    place_kind: ClassVar[PlaceKind]
    native: ClassVar[bool]
    """Whether MuJoCo has it, so that a corrected MJCF can hold it."""

    @abstractmethod
    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The effect's numbers, bounds and sizes fitted to the place."""

    @abstractmethod
    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """Where the effect may be, given what the plant has and the traces recorded."""

    @abstractmethod
    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Put the effect into one variant of the plant.

        Effects are applied one after another; each adds to what is there.
        """

    def grown_from(self, other: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Where to begin if another effect at the same place was found to help.

        Effects that contain a simpler one say so; a fit that begins anywhere else may
        never get there.
        """
        return ()
