"""Joint commands that make a robot in the air show its physics."""

from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadValueError, UnknownNameError

MOTIONS = ("multisine", "chirp", "steps", "ramps")
_RANGE_USED, _MOST_RAD = 0.8, 0.6
_SPEED_USED = 0.8
_START_S = 1.0


@dataclass(frozen=True, eq=False)
class Excitation:
    """Which joints move, about where, and within what.

    Attributes:
      centre_rad: (j,) where each joint starts and rests.
      range_rad: (j, 2) of each joint.
      speed_rad_s: (j,) that commands may reach.
      moves: (j,) joints that move; the others are held at their centre.
      together: pairs of joints that always get one command.
    """

    centre_rad: FloatArray
    range_rad: FloatArray
    speed_rad_s: FloatArray
    moves: BoolArray
    together: tuple[tuple[int, int], ...] = ()

    def __post_init__(self) -> None:
        """Refuse centres out of range."""
        low, high = self.range_rad.T
        if not ((low <= self.centre_rad) & (self.centre_rad <= high)).all():
            raise BadValueError(f"centre {self.centre_rad} lies outside of the range")

    @property
    def amplitude_rad(self) -> FloatArray:
        """(j,) that leaves every joint within most of its range; 0 if it is held."""
        low, high = self.range_rad.T
        room = np.minimum(self.centre_rad - low, high - self.centre_rad)
        return np.where(self.moves, np.minimum(_RANGE_USED * room, _MOST_RAD), 0.0)

    def commands(
        self, motion: str, time_s: FloatArray, rng: np.random.Generator
    ) -> FloatArray:
        """(T, j) position targets.

        Args:
          motion: one of `MOTIONS`.
          time_s: (T,) of the targets, from 0 on.
          rng: draws frequencies, phases, levels.

        Raises:
          UnknownNameError: there is no such motion.
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
    """(T, j) sums of six sines from 0.1 to 2.5 Hz, random in phase."""
    j = len(plan.centre_rad)
    frequency = np.geomspace(0.1, 2.5, 6)[:, None] * rng.uniform(0.85, 1.15, (6, j))
    phase = rng.uniform(0, 2 * np.pi, (6, j))
    weight = rng.uniform(0.5, 1.0, (6, j)) / np.sqrt(frequency)
    turns = 2 * np.pi * frequency * time_s[:, None, None] + phase
    return _within(plan, (weight * np.sin(turns)).sum(axis=1), time_s)


def chirp(plan: Excitation, time_s: FloatArray, rng: np.random.Generator) -> FloatArray:
    """(T, j) sines that get faster from 0.1 to 4 Hz and smaller as they do so."""
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
    """(T, j) levels that last 0.4 to 1.2 s, each joint on its own."""
    shape = np.zeros((len(time_s), len(plan.centre_rad)))
    for joint, amplitude in enumerate(plan.amplitude_rad):
        at = rng.uniform(0.1, 0.6)
        while at < time_s[-1]:
            shape[time_s >= at, joint] = amplitude * rng.uniform(-0.6, 0.6)
            at += rng.uniform(0.4, 1.2)
    return shape


def ramps(plan: Excitation, time_s: FloatArray, rng: np.random.Generator) -> FloatArray:
    """(T, j) slow ramps at several speeds, with reversals and holds."""
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
    """Scale to amplitude and speed, and start smoothly from the centre."""
    start = 0.5 - 0.5 * np.cos(np.pi * np.minimum(time_s / _START_S, 1.0))
    shape = shape * start[:, None]
    scale = plan.amplitude_rad / np.maximum(np.abs(shape).max(axis=0), 1e-9)
    speed = np.abs(np.gradient(shape, time_s, axis=0)).max(axis=0)
    fastest = _SPEED_USED * plan.speed_rad_s / np.maximum(speed, 1e-9)
    return np.asarray(shape * np.minimum(scale, fastest))


_MAKERS = {"multisine": multisine, "chirp": chirp, "steps": steps, "ramps": ramps}
