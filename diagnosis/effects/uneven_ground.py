"""The effect uneven ground: bumps where the model has a plane."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

from diagnosis.effects.effect import Effect
from diagnosis.effects.ground import has_ground_contact
from diagnosis.effects.parts import EffectWords, Parameter, PlaceKind
from groundwalk.arrays import FloatArray
from groundwalk.errors import BadModelError

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.trace import Trace


class UnevenGround(Effect):
    """Bumps: heights of the ground spread about the plane, 99 % within +-height.

    Where the bumps are cannot be known. A simulation that starts in the middle of a
    recording takes the ground to be where the recorded soles stood at its start, within
    +-height of the plane (`diagnosis.replay.conforming_ground`). So the height found is
    about that of the largest bump stepped on, bumps below 0.6 mm are not seen, and the
    ground is flat where a foot steps later.

    Source: ground profiles as random processes, ISO 8608:2016.
    """

    name = "uneven_ground"
    place_kind: ClassVar[PlaceKind] = "world"
    native = False
    rarity_nats = 10.0
    """Extra log-likelihood [nats] that the effect needs to be accepted: it fits the
    ground to every stand of a sole, which is like one more parameter for each."""
    words = EffectWords(
        "uneven ground",
        "the ground has bumps of {height} {lacking}",
        "The feet meet the ground earlier or later than on a plane.",
    )

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """("world",) if the robot can walk on a ground, else ()."""
        return ("world",) if has_ground_contact(plant) else ()

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The height [m]; 1 mm is tried first, less than most real bumps."""
        return (Parameter("height", "m", 0.0, 0.03, 0.0, 0.001),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Add the height to that of the bumps in one variant of the model."""
        variants.outside.bump_height_m[row] += values[0]

    def apply_to_sim(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Refuse the effect, because it is not known where the bumps are.

        Raises:
          BadModelError: always.
        """
        raise BadModelError(
            "uneven_ground says how high bumps are, not where: give the sim a "
            "terrain with bumps instead"
        )
