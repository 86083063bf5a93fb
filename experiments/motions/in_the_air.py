"""Joint commands that excite the physics of a robot whose base is fixed in the air."""

from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadValueError, UnknownNameError

MOTIONS = ("multisine", "chirp", "steps", "ramps")
"""Names of all motions of a robot whose base is fixed in the air."""

_RANGE_USED, _MOST_RAD = 0.8, 0.6
"""Limits of a joint's amplitude: share of the distance from its centre to the nearer
end of its range, and an absolute limit [rad]."""

_SPEED_USED = 0.8
"""Largest speed of a joint's commands, as a share of the joint's speed limit."""

_START_S = 1.0
"""Time in which a motion's amplitude grows from zero [s]."""


@dataclass(frozen=True, eq=False)
class Excitation:
    """The joints that move, and the limits of their motion.

    Attributes:
      centre_rad: (j,) angle [rad] around which each joint moves and at which it starts.
      range_rad: (j, 2) lower and upper end of each joint's range [rad].
      speed_rad_s: (j,) speed limit of each joint [rad/s].
      moves: (j,) whether a joint moves; the others are held at their centre.
      together: pairs of joints that always get the same command.
    """

    centre_rad: FloatArray
    range_rad: FloatArray
    speed_rad_s: FloatArray
    moves: BoolArray
    together: tuple[tuple[int, int], ...] = ()

    def __post_init__(self) -> None:
        """Refuse a centre outside of the joint's range."""
        low, high = self.range_rad.T
        if not ((low <= self.centre_rad) & (self.centre_rad <= high)).all():
            raise BadValueError(f"centre {self.centre_rad} lies outside of the range")

    @property
    def amplitude_rad(self) -> FloatArray:
        """(j,) amplitude [rad] within the joint's range; 0 for a joint that is held."""
        low, high = self.range_rad.T
        room = np.minimum(self.centre_rad - low, high - self.centre_rad)
        return np.where(self.moves, np.minimum(_RANGE_USED * room, _MOST_RAD), 0.0)

    def commands(
        self, motion: str, time_s: FloatArray, rng: np.random.Generator
    ) -> FloatArray:
        """Draw the commands of one of `MOTIONS` at random.

        They are (T, j) position targets [rad] for times (T,) [s], beginning with 0.

        Raises:
          UnknownNameError: the motion is unknown.
        """
        if motion not in _MAKERS:
            raise UnknownNameError("motion in the air", motion, _MAKERS)
        shape = _MAKERS[motion](self, time_s, rng)
        for first, second in self.together:
            shape[:, second] = shape[:, first]
        low, high = self.range_rad.T
        return np.clip(self.centre_rad + shape, low, high)


def multisine(
    plan: Excitation, time_s: FloatArray, rng: np.random.Generator
) -> FloatArray:
    """(T, j) angles [rad] from the centre: six sines, 0.1 to 2.5 Hz, random phases."""
    j = len(plan.centre_rad)
    frequency = np.geomspace(0.1, 2.5, 6)[:, None] * rng.uniform(0.85, 1.15, (6, j))
    phase = rng.uniform(0, 2 * np.pi, (6, j))
    weight = rng.uniform(0.5, 1.0, (6, j)) / np.sqrt(frequency)
    turns = 2 * np.pi * frequency * time_s[:, None, None] + phase
    return _within(plan, (weight * np.sin(turns)).sum(axis=1), time_s)


def chirp(plan: Excitation, time_s: FloatArray, rng: np.random.Generator) -> FloatArray:
    """(T, j) angles [rad] from the centre: shrinking sines, from 0.1 up to 4 Hz."""
    j = len(plan.centre_rad)
    low, high = 0.1 * rng.uniform(0.8, 1.2, j), rng.uniform(3.0, 4.0, j)
    end = max(float(time_s[-1]), 1e-9)
    growth = np.log(high / low) / end
    grown = np.exp(growth * time_s[:, None])
    turns = 2 * np.pi * low * (grown - 1) / growth + rng.uniform(0, 2 * np.pi, j)
    speed = 2 * np.pi * low * grown
    most = _SPEED_USED * plan.speed_rad_s / np.maximum(plan.amplitude_rad, 1e-9)
    shape = np.sin(turns) * np.minimum(1.0, most / speed) / (1 + grown * low / 1.5)
    return _within(plan, shape, time_s)


def steps(plan: Excitation, time_s: FloatArray, rng: np.random.Generator) -> FloatArray:
    """(T, j) angles [rad] from the centre: random levels, each for 0.4 to 1.2 s."""
    shape = np.zeros((len(time_s), len(plan.centre_rad)))
    for joint, amplitude in enumerate(plan.amplitude_rad):
        at = rng.uniform(0.1, 0.6)
        while at < time_s[-1]:
            shape[time_s >= at, joint] = amplitude * rng.uniform(-0.6, 0.6)
            at += rng.uniform(0.4, 1.2)
    return shape


def ramps(plan: Excitation, time_s: FloatArray, rng: np.random.Generator) -> FloatArray:
    """(T, j) angles [rad] from the centre: slow ramps with reversals and pauses."""
    shape = np.zeros((len(time_s), len(plan.centre_rad)))
    for joint, amplitude in enumerate(plan.amplitude_rad):
        at, level = rng.uniform(0.0, 0.5), 0.0
        knots = [(0.0, 0.0), (at, 0.0)]
        sign = rng.choice([-1.0, 1.0])
        while at < time_s[-1]:
            target = sign * amplitude * rng.uniform(0.15, 0.8)
            at += abs(target - level) / rng.choice([0.06, 0.15, 0.35])
            knots.append((at, target))
            at += rng.choice([0.0, 0.0, 0.5])
            knots.append((at + 1e-6, target))
            level, sign = target, -sign
        x, y = np.array(knots).T
        shape[:, joint] = np.interp(time_s, x, y)
    return shape


def _within(plan: Excitation, shape: FloatArray, time_s: FloatArray) -> FloatArray:
    """Fade in a motion (T, j), and scale it to amplitude and speed limit [rad]."""
    start = 0.5 - 0.5 * np.cos(np.pi * np.minimum(time_s / _START_S, 1.0))
    shape = shape * start[:, None]
    scale = plan.amplitude_rad / np.maximum(np.abs(shape).max(axis=0), 1e-9)
    speed = np.abs(np.gradient(shape, time_s, axis=0)).max(axis=0)
    fastest = _SPEED_USED * plan.speed_rad_s / np.maximum(speed, 1e-9)
    return np.asarray(shape * np.minimum(scale, fastest))


_MAKERS = {"multisine": multisine, "chirp": chirp, "steps": steps, "ramps": ramps}
