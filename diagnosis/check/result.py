"""The result of a check of recordings, as data and as JSON."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from diagnosis.audit.result import Audit
from diagnosis.effects.parts import PlacedEffect
from diagnosis.motions.plan import PlannedMotion
from diagnosis.verdict import Amount
from groundwalk.json_data import to_plain


@dataclass(frozen=True)
class Size:
    """The smallest size of an effect that recordings would tell.

    Attributes:
      name, place: the effect, and the joint or body at which it is.
      told: smallest size at which it is told from all others; None if none is possible.
        Of an effect that is absent at an infinite value, as a limit, the largest value.
      seen: smallest size at which something is seen to be missing, likewise.
      nearest: "effect@place" of the other effect from which it is told last.
      alike: how much of what it changes that one can change as well, from 0 to 1.
      below: whether the effect is the larger, the smaller its value is.
      values: the effect's values, by name, in the smallest size that is told; in the
        largest possible one if none is.
    """

    name: str
    place: str
    told: Amount | None
    seen: Amount | None
    nearest: str | None
    alike: float
    below: bool
    values: Mapping[str, float]

    @property
    def key(self) -> str:
        """The effect as "effect@place"."""
        return f"{self.name}@{self.place}"

    @property
    def placed(self) -> PlacedEffect:
        """The effect at its place, without values."""
        return PlacedEffect(self.name, self.place)


@dataclass(frozen=True)
class Alike:
    """Two effects that the recordings cannot tell apart, and what their motion lacks.

    `why` is the end of a sentence, such as "elbow moved at one speed only"; "" if the
    two look alike in any such motion.
    """

    one: str
    other: str
    why: str


@dataclass(frozen=True, eq=False)
class Proposed:
    """A motion to record next, and what it would change.

    Attributes:
      planned: its commands, which keep the model's limits.
      sizes: the smallest sizes that would be told with this motion in addition, by
        "effect@place"; None where none would.
    """

    planned: PlannedMotion
    sizes: Mapping[str, Amount | None]


@dataclass(frozen=True, eq=False)
class Check:
    """What recordings are good for.

    Attributes:
      audited: rate, noise and defects of the recordings.
      noise: by channel, what the residual of a right model has of noise.
      sizes: the smallest sizes that would be told.
      alike: effects that cannot be told apart.
      proposed: motions to record next, the most useful first.
      gain: what an effect must gain to be reported [nats]; None if not usable.
      off: by channel, the rms error of the sim as it is, in multiples of the noise.
      limits: sentences on what was left out of the recordings, and on what was not
        computed.
    """

    audited: Audit
    noise: Mapping[str, Amount]
    sizes: tuple[Size, ...]
    alike: tuple[Alike, ...]
    proposed: tuple[Proposed, ...]
    gain: float | None
    off: Mapping[str, float] = field(default_factory=dict)
    limits: tuple[str, ...] = ()

    @property
    def usable(self) -> bool:
        """Whether the recordings can be diagnosed."""
        return not self.audited.refused

    def size(self, key: str) -> Size:
        """The smallest size of an "effect@place"; KeyError if it was not computed."""
        return {one.key: one for one in self.sizes}[key]

    def to_plain(self) -> dict[str, object]:
        """The result as plain data for JSON."""
        return {
            "usable": self.usable,
            "gain": self.gain,
            "noise": {name: vars(amount) for name, amount in self.noise.items()},
            "off": dict(self.off),
            "sizes": [to_plain(one) for one in self.sizes],
            "alike": [to_plain(one) for one in self.alike],
            "next": [
                {
                    "motion": one.planned.motion.name,
                    "good_for": one.planned.motion.good_for,
                    "sizes": {
                        key: None if amount is None else vars(amount)
                        for key, amount in one.sizes.items()
                    },
                }
                for one in self.proposed
            ],
            "limits": list(self.limits),
            "audit": self.audited.to_plain(),
        }
