"""Joint commands that excite a robot's physics: in the air, standing and walking."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadValueError, UnknownNameError
from robots import Biped, Description, biped
from walk_engine import Velocity, WalkEngine, gaits
from walk_engine.legs import Legs
from worlds.hidden.engine import BodySense
from worlds.world import TICK_S

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


STANDING_MOTIONS = ("squat", "fast_squat", "sway")
"""Names of all motions in which both feet keep standing on the ground."""

_HIGH, _DEEP = 0.97, 0.80
"""Distance from hip to ankle as a share of the straight leg's length: when standing
upright, and in the deepest squat."""

_SWAY_M, _SLOW_HZ, _FAST_HZ = 0.02, 0.35, 0.9
"""Amplitude of swaying sideways [m]; frequencies of slow and of fast motions [Hz]."""

_ARM_RAD, _ARM_ROLL_RAD, _START_S = 0.3, 0.2, 1.0
"""Amplitude of the arms' swing [rad], their constant angle away from the body [rad],
and the time in which a motion's amplitude grows from zero [s]."""

WALK_SPEEDS = (0.06, 0.16)
"""Range from which the forward speed of a walk is drawn [m/s]."""


def standing_commands(
    description: Description, motion: str, time_s: FloatArray, rng: np.random.Generator
) -> FloatArray:
    """Draw the commands of one of `STANDING_MOTIONS` of a biped at random.

    They are (T, joints) position targets [rad] for times (T,) [s], beginning with 0.

    Raises:
      UnknownNameError: the motion is unknown.
    """
    if motion not in STANDING_MOTIONS:
        raise UnknownNameError("motion on the feet", motion, STANDING_MOTIONS)
    body = biped(description)
    start = 0.5 - 0.5 * np.cos(np.pi * np.minimum(time_s / _START_S, 1.0))
    hertz = (_FAST_HZ if motion == "fast_squat" else _SLOW_HZ) * rng.uniform(0.8, 1.2)
    wave = 2 * np.pi * hertz * time_s
    down, aside = np.zeros_like(time_s), np.zeros_like(time_s)
    if motion == "sway":
        aside = _SWAY_M * rng.uniform(0.6, 1.0) * np.sin(wave)
        down = 0.2 * (1 - np.cos(0.31 * wave))
    else:
        deep = 0.5 if motion == "fast_squat" else 1.0
        down = deep * rng.uniform(0.6, 1.0) * (1 - np.cos(wave)) / 2
    command = _pose(body, start * down, start * aside)
    _swing_arms(body, command, start, time_s, rng)
    low, high = body.joint_range_rad.T
    return np.clip(command, low, high)


def _pose(body: Biped, down: FloatArray, aside_m: FloatArray) -> FloatArray:
    """(T, joints) targets [rad]: squat `down` (T,) of 0 to 1, hips moved aside (T,)."""
    leg = body.leg
    length = (leg.thigh_m + leg.tibia_m) * (_HIGH - (_HIGH - _DEEP) * down)
    hip_x, hip_y, hip_z = leg.hip_m
    low, high = body.joint_range_rad.T
    rest = np.clip(0.0, low, high)
    command = np.repeat(rest[None], len(down), axis=0)
    none = np.zeros_like(down)
    ankle = [
        np.stack([none + hip_x, hip_y + side * aside_m, hip_z - length])
        for side in (-1.0, 1.0)
    ]
    still = np.zeros((2, len(down)))
    left, right = Legs(body).angles(
        np.stack(ankle, axis=1), still, still, np.stack([still, still])
    )
    command[:, list(body.left_leg)] = left.T
    command[:, list(body.right_leg)] = right.T
    return command


def _swing_arms(
    body: Biped,
    command: FloatArray,
    start: FloatArray,
    time_s: FloatArray,
    rng: np.random.Generator,
) -> None:
    for arm, side in ((body.left_arm, 1.0), (body.right_arm, -1.0)):
        if arm is None:
            continue
        turns = 2 * np.pi * rng.uniform(0.2, 0.6) * time_s + rng.uniform(0, 2 * np.pi)
        hanging = body.hanging_rad[0 if side > 0 else 1]
        command[:, arm[0]] = hanging + _ARM_RAD * start * np.sin(turns)
        command[:, list(arm[1:])] = side * _ARM_ROLL_RAD


def walking_feed(
    description: Description, rng: np.random.Generator, rest_rows: int
) -> tuple[FloatArray, Callable[[int, BodySense], FloatArray]]:
    """Make the start pose of a walk, and a function that computes its commands.

    The biped stands for `rest_rows` ticks before it walks, at a random speed. The
    function of the tick's number and of the measurements returns commands (joints,)
    [rad].
    """
    body = biped(description)
    engine = WalkEngine(body, [gaits.get("walk2014")], TICK_S)
    ahead = Velocity(forward_m_s=float(rng.uniform(*WALK_SPEEDS)))

    def feed(row: int, sense: BodySense) -> FloatArray:
        request = Velocity() if row < rest_rows else ahead
        rate, force = sense.gyroscope_rad_s[None], sense.foot_force_n[None]
        return np.asarray(engine.step(request, rate, force)[0])

    return engine.start_pose()[0], feed
