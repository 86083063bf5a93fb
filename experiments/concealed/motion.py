"""Motions of a test case with concealed physics: robot, ticks, gains and commands.

With a fixed base two of the four recordings, chirp and ramps, are made with half the
servo gains, as their metadata state. The effect of a wrong gain is proportional to the
gain, that of a payload or of friction is not, so that they can be distinguished.
Because a diagnosis holds out whole recordings, most pairs of motions have both gains.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from experiments.motions import MOTIONS, Excitation, standing_commands, walking_feed
from groundwalk.arrays import BoolArray, FloatArray
from worlds.hidden.plant import HiddenPlant, hidden_plant
from worlds.hidden.run import Clock, Feed

STEP_S = 0.00025
"""Physics step of a robot with a fixed base [s]."""
FLOATING_STEP_S = 0.0005
"""Physics step of a robot that stands or walks [s]: longer than with a fixed base,
because contacts make steps expensive."""
_STANDING = ("squat", "fast_squat", "sway", "squat")
"""Motions of a standing robot, one for each recording."""
_RATES_HZ, _RATE_SHARES = (100.0, 200.0, 50.0), (0.7, 0.15, 0.15)
"""Possible tick rates with a fixed base [Hz], and the probability of each."""
_FLOATING_HZ = 100.0
"""Tick rate of a robot that stands or walks [Hz]: that of the NAO."""
_DURATION_S, _FLOATING_DURATION_S = (8.0, 10.0), (5.0, 6.0)
"""Range of a recording's duration [s], with a fixed base and for a robot that stands or
walks, whose contacts take longer to simulate."""
SOFT_MOTIONS, SOFT = ("chirp", "ramps"), 0.5
"""Motions that are recorded with lower servo gains, and the factor of the gains."""
_MIDDLE = 0.4
"""Width of the interval in which a motion's centre is drawn, around the middle of the
joint's range and as a share of it."""
_WALK_REST_S = 0.8
"""Time for which a robot stands before it walks [s]."""
_BEFORE_S, _STILL_S = (0.3, 1.2), 8.0
"""Range of the simulated time before a recording begins [s], and the time added if a
joint is held still, so that it has sagged under its load by then [s]."""


@dataclass(frozen=True, eq=False)
class CaseMotion:
    """The motions of a test case, one for each of its recordings.

    Attributes:
      plant: the robot's model with its own servo gains.
      plants: for each recording, the model with the servo gains of that recording.
      names: names of the motions.
      places: indices of the joints at which effects may be hidden.
      moves: (j,) whether each joint is excited.
      centre_rad: (j,) start pose of a robot with a fixed base.
      rate_hz: ticks per second.
      spans_s: for each recording, the time before it and its duration.
      jitter_s: largest error of a time stamp.
      seeds: seed of each motion.
    """

    plant: HiddenPlant
    plants: tuple[HiddenPlant, ...]
    names: tuple[str, ...]
    places: tuple[int, ...]
    moves: BoolArray
    centre_rad: FloatArray
    rate_hz: float
    spans_s: tuple[tuple[float, float], ...]
    jitter_s: float
    seeds: tuple[int, ...]

    @classmethod
    def drawn(
        cls, plant_name: str, held: bool, jitter_s: float, rng: np.random.Generator
    ) -> "CaseMotion":
        """Draw tick rate, duration, gains, pose, and the joint that is `held` still."""
        plant, names = _plant(plant_name)
        coupled = plant.description.coupled if plant.description else ()
        tied = {joint for pair in coupled for joint in pair}
        places = tuple(i for i in range(len(plant.joints)) if i not in tied)
        moves = np.ones(len(plant.joints), bool)
        if held:
            places = (int(rng.choice(places)),)
            moves[places[0]] = False
        low, high = plant.range_rad.T
        middle = 0.5 + _MIDDLE * rng.uniform(-0.5, 0.5, len(low))
        for first, second in coupled:
            middle[second] = middle[first]
        lengths_s = _FLOATING_DURATION_S if plant.floating else _DURATION_S
        duration_s = float(rng.uniform(*lengths_s))
        rate_hz = float(rng.choice(_RATES_HZ, p=_RATE_SHARES))
        n = len(names)
        before_s = rng.uniform(*_BEFORE_S, n) + (_STILL_S if held else 0.0)
        return cls(
            plant=plant,
            plants=_gains(plant, names, rng),
            names=names,
            places=places,
            moves=moves,
            centre_rad=low + middle * (high - low),
            rate_hz=_FLOATING_HZ if plant.floating else rate_hz,
            spans_s=tuple((float(before), duration_s) for before in before_s),
            jitter_s=jitter_s,
            seeds=tuple(int(seed) for seed in rng.integers(2**32, size=n)),
        )

    @property
    def duration_s(self) -> float:
        """Duration of each recording [s]."""
        return self.spans_s[0][1]

    def clock(self, number: int, step_s: float | None = None) -> Clock:
        """The times of a recording's ticks and physics steps (None: the usual step)."""
        own = FLOATING_STEP_S if self.plant.floating else STEP_S
        rng = np.random.default_rng([self.seeds[number], 1])
        return Clock.drawn(
            step_s or own, self.rate_hz, self.spans_s[number], self.jitter_s, rng
        )

    def feed(self, number: int) -> tuple[FloatArray, Feed]:
        """Start pose (j,) [rad] and command function of the recording `number`."""
        rng = np.random.default_rng([self.seeds[number], 0])
        rows = sum(round(span * self.rate_hz) for span in self.spans_s[number]) + 1
        time_s = np.arange(rows) / self.rate_hz
        own = self.plant, self.names[number], time_s, self.rate_hz, rng
        return motion_feed(*own, self.centre_rad, self.moves)


def motion_feed(
    plant: HiddenPlant,
    motion: str,
    time_s: FloatArray,
    rate_hz: float,
    rng: np.random.Generator,
    centre_rad: FloatArray,
    moves: BoolArray,
) -> tuple[FloatArray, Feed]:
    """Start pose (j,) [rad] and command function of a motion, for ticks at (T,) [s].

    In the air, the joints that move (j,) do so around their centres (j,) [rad].
    """
    description = plant.description
    if motion == "walk" and description is not None:
        return walking_feed(description, rng, round(_WALK_REST_S * rate_hz))
    if plant.floating and description is not None:
        command_rad = standing_commands(description, motion, time_s, rng)
    else:
        coupled = description.coupled if description else ()
        limits = plant.range_rad, plant.speed_rad_s
        plan = Excitation(centre_rad, *limits, moves, coupled)
        command_rad = plan.commands(motion, time_s, rng)
    return command_rad[0], lambda row, sense: command_rad[row]


def _plant(name: str) -> tuple[HiddenPlant, tuple[str, ...]]:
    if name == "nao_walking":
        return hidden_plant("nao", floating=True), ("walk",) * len(MOTIONS)
    if name == "nao_standing":
        return hidden_plant("nao", floating=True), _STANDING
    return hidden_plant("nao" if name == "nao_air" else name), MOTIONS


def _gains(
    plant: HiddenPlant, names: Sequence[str], rng: np.random.Generator
) -> tuple[HiddenPlant, ...]:
    """The robot with each recording's servo gains; a floating robot keeps its own."""
    if plant.floating:
        return (plant,) * len(names)
    # The servo gains of a robot with a description are known; others' are free.
    own = 1.0 if plant.description is not None else float(rng.uniform(0.8, 1.25))
    given, softer = plant.with_gains(own), plant.with_gains(own * SOFT, SOFT)
    return tuple(softer if name in SOFT_MOTIONS else given for name in names)
