"""Where gaits walk: the real world's course, or a sim."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

import terrain
import worlds
from experiments.walking.sims import make_sim
from groundwalk.errors import BadValueError
from robots import Description
from terrain import Heightfield
from worlds import World, WorldOptions
from worlds.hidden.effects import Hidden


@dataclass(frozen=True)
class RealCourse:
    """The real world that a gait is for.

    Attributes:
      terrain: its ground in words, such as "lumps:amplitude_m=0.01".
      hidden: physics that it has and the sim's model lacks.
    """

    terrain: str = worlds.kind("real").terrain
    hidden: tuple[Hidden, ...] = ()

    def __post_init__(self) -> None:
        """Refuse a terrain that is none."""
        terrain.parse(self.terrain)

    @property
    def options(self) -> WorldOptions:
        """The real world's own, with what is hidden."""
        return replace(worlds.kind("real").options, hidden=self.hidden)

    @property
    def flat(self) -> bool:
        """Whether the ground is level and even."""
        return terrain.parse(self.terrain)[0] == "flat"

    def grounds(self, seeds: Sequence[np.random.SeedSequence]) -> list[Heightfield]:
        """One for each seed; flat ones are one object."""
        name, parameters = terrain.parse(self.terrain)
        if self.flat:
            return [terrain.make(name, 0, **parameters)] * len(seeds)
        return [terrain.make(name, seed, **parameters) for seed in seeds]


LUMPS_M = (0.002, 0.005, 0.008, 0.011, 0.014)
"""Amplitudes of an uneven sim's lumps."""

START_M, SHORT_START_M = 0.35, 0.1
"""Flat ground around the start of a course, and of short walks: they shall not spend
half of their time on it."""


@dataclass(frozen=True)
class SimPlace:
    """A sim, flat or as uneven as real.

    Attributes:
      lumps_m: amplitude of the lumps that it has, or several, of which every ground
        has one by chance. Where 0 it is flat, and its sensors have no noise; else they
        are as noisy as the real world's.
      start_m: radius of the flat ground around the start.
      correction: folder or file of a diagnosis, whose effects the sim shall have.
    """

    lumps_m: float | tuple[float, ...] = 0.0
    start_m: float = START_M
    correction: Path | None = None

    def __post_init__(self) -> None:
        """Refuse no lumps at all."""
        if self.lumps_m == ():
            raise BadValueError("lumps_m is empty; give at least one amplitude")

    def grounds(self, seeds: Sequence[np.random.SeedSequence]) -> list[Heightfield]:
        """One for each seed, flat or with lumps as long as the real world's."""
        if not self.lumps_m:
            return [terrain.make("flat", 0)] * len(seeds)
        return [self._lumps(seed) for seed in seeds]

    def _lumps(self, seed: np.random.SeedSequence) -> Heightfield:
        amplitudes = np.atleast_1d(self.lumps_m)
        which = 0
        if len(amplitudes) > 1:
            which = int(np.random.default_rng(seed).integers(len(amplitudes)))
        sizes = {"amplitude_m": amplitudes[which], "start_radius_m": self.start_m}
        return terrain.make("lumps", seed, **sizes)

    @property
    def options(self) -> WorldOptions:
        """Of the world inside."""
        return noisy_sim() if self.lumps_m else worlds.kind("sim").options


def world_at(
    place: RealCourse | SimPlace,
    description: Description,
    grounds: Sequence[Heightfield],
    seeds: Sequence[np.random.SeedSequence],
) -> World:
    """One robot on each ground; the seeds are of the sensors' noise."""
    if isinstance(place, RealCourse):
        return worlds.make("real", description, grounds, seeds, place.options)
    return make_sim(description, grounds, seeds, place.options, place.correction)


def noisy_sim() -> WorldOptions:
    """The sim's options, but with the real world's sensors."""
    noise = worlds.kind("real").options.noise
    return WorldOptions(worlds.kind("sim").options.timestep_s, noise=noise)


@dataclass(frozen=True)
class Places:
    """The two worlds of a grounding.

    Attributes:
      real: where gaits shall walk in the end.
      correction: of the sim; see `SimPlace`.
    """

    real: RealCourse = field(default_factory=RealCourse)
    correction: Path | None = None

    def sim(
        self, lumps_m: float | tuple[float, ...] = 0.0, start_m: float = SHORT_START_M
    ) -> SimPlace:
        """The sim, on the flat or on lumps."""
        return SimPlace(lumps_m, start_m, self.correction)
