"""Places where gaits walk: a course in the real world, or a flat or uneven sim."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

import terrain
import worlds
from experiments.walking.evaluation import make_sim
from groundwalk.errors import BadValueError
from robots import Description
from terrain import Heightfield
from worlds import World, WorldOptions
from worlds.hidden.effects import Hidden


@dataclass(frozen=True)
class RealCourse:
    """The real world that a gait is tuned for: its ground and its physics.

    Attributes:
      terrain: name and parameters of the ground, such as "lumps:amplitude_m=0.01".
      hidden: physics of the real world that the sim's model lacks.
      length_m: length of the course on which a gait is tried [m].

    Example:
      >>> RealCourse("flat").flat
      True
    """

    terrain: str = worlds.kind("real").terrain
    hidden: tuple[Hidden, ...] = ()
    length_m: float = 3.0

    def __post_init__(self) -> None:
        """Refuse an unknown terrain."""
        terrain.parse(self.terrain)

    @property
    def options(self) -> WorldOptions:
        """Options of the real world, with the hidden physics."""
        return replace(worlds.kind("real").options, hidden=self.hidden)

    @property
    def flat(self) -> bool:
        """Whether the ground is level and even."""
        return terrain.parse(self.terrain)[0] == "flat"

    def grounds(self, seeds: Sequence[np.random.SeedSequence]) -> list[Heightfield]:
        """One ground for each seed; flat grounds are one shared object."""
        name, parameters = terrain.parse(self.terrain)
        if name == "flat":
            return [terrain.make(name, 0, **parameters)] * len(seeds)
        return [terrain.make(name, seed, **parameters) for seed in seeds]


LUMPS_M = (0.002, 0.005, 0.008, 0.011, 0.014)
"""Amplitudes [m] of lumps with which uneven sims are tried."""

START_M, SHORT_START_M = 0.35, 0.1
"""Radius [m] of the flat ground around the start: for a course, and for walks of a few
seconds, which would spend half of their time within 0.35 m."""


@dataclass(frozen=True)
class SimPlace:
    """A sim, flat or with lumps.

    Attributes:
      lumps_m: amplitude of the lumps [m], or several amplitudes, of which each ground
        has a random one. At 0 the ground is flat and the sensors have no noise;
        otherwise they have the real world's.
      start_m: radius of the flat ground around the start [m].
      correction: folder or file of a diagnosis; the effects that it found are added.

    Example:
      >>> place = SimPlace(lumps_m=0.008)
      >>> grounds = place.grounds(np.random.SeedSequence(1).spawn(4))
    """

    lumps_m: float | tuple[float, ...] = 0.0
    start_m: float = START_M
    correction: Path | None = None

    def __post_init__(self) -> None:
        """Refuse an empty tuple of amplitudes."""
        if self.lumps_m == ():
            raise BadValueError("lumps_m is empty; give at least one amplitude")

    def grounds(self, seeds: Sequence[np.random.SeedSequence]) -> list[Heightfield]:
        """One ground for each seed: flat, or lumps of the real world's wavelength."""
        if not self.lumps_m:
            return [terrain.make("flat", 0)] * len(seeds)
        amplitudes = np.atleast_1d(self.lumps_m)
        grounds = []
        for seed in seeds:
            which = np.random.default_rng(seed).integers(len(amplitudes))
            sizes = {"amplitude_m": amplitudes[which], "start_radius_m": self.start_m}
            grounds.append(terrain.make("lumps", seed, **sizes))
        return grounds

    @property
    def options(self) -> WorldOptions:
        """Options of the sim; its sensors are noisy if the ground has lumps."""
        return noisy_sim() if self.lumps_m else worlds.kind("sim").options


def world_at(
    place: RealCourse | SimPlace,
    description: Description,
    grounds: Sequence[Heightfield],
    seeds: Sequence[np.random.SeedSequence],
) -> World:
    """The world of a place, a robot on each of n grounds, n seeds of sensor noise."""
    if isinstance(place, RealCourse):
        return worlds.make("real", description, grounds, seeds, place.options)
    return make_sim(description, grounds, seeds, place.options, place.correction)


def noisy_sim() -> WorldOptions:
    """The sim's options, but with the real world's sensor noise.

    Example:
      See docs/python.md, "Learn with Gymnasium".
    """
    noise = worlds.kind("real").options.noise
    return WorldOptions(worlds.kind("sim").options.timestep_s, noise=noise)


@dataclass(frozen=True)
class Places:
    """The real world and the sim of a grounding.

    Attributes:
      real: the world that gaits are tuned for.
      correction: folder or file of a diagnosis that corrects the sim; see `SimPlace`.

    Example:
      >>> Places(RealCourse("lumps:amplitude_m=0.006")).sim().lumps_m
      0.0
    """

    real: RealCourse = field(default_factory=RealCourse)
    correction: Path | None = None

    def sim(
        self, lumps_m: float | tuple[float, ...] = 0.0, start_m: float = SHORT_START_M
    ) -> SimPlace:
        """The sim with lumps of this amplitude [m], flat around the start [m]."""
        return SimPlace(lumps_m, start_m, self.correction)
