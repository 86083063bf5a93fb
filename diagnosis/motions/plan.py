"""Plans motions for a robot model such that a simulation keeps all its limits."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.effects.scales import range_rad, speed_rad_s
from diagnosis.effects.variants import Variants
from diagnosis.motions.shapes import MOTIONS, Motion
from diagnosis.plant.plant import Plant
from diagnosis.replay.replay import replay
from diagnosis.traces.trace import Trace
from diagnosis.traces.usage import Usage
from diagnosis.traces.windows import Run
from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError

RATE_HZ = 100.0
"""Commands a second of planned motions."""

MOST_RAD = 0.6
"""Largest amplitude of a planned motion [rad], [m] at sliding joints with a range."""

RANGE_USED, SPEED_USED, TORQUE_USED = 0.9, 0.5, 0.8
"""Shares of a joint's room to the nearer end of its range, of its speed, and of its
servo's torque that a planned motion may use: the real robot is not the model."""

SMALLER, MOST_TRIES = 0.7, 12
"""Factor by which a motion of joints beyond their limits is made smaller, and most
times that it is: then it has a seventieth of its size, and is of no use."""

STEP_S = 0.002
"""Time step of the simulation that checks a plan [s]."""


@dataclass(frozen=True, eq=False)
class Limits:
    """What joints may do, arrays (j,).

    Attributes:
      centre_rad: where motions begin and end.
      low_rad, high_rad: ends of the range.
      speed_rad_s: highest speed.
      torque_nm: largest torque of the servos.
    """

    centre_rad: FloatArray
    low_rad: FloatArray
    high_rad: FloatArray
    speed_rad_s: FloatArray
    torque_nm: FloatArray

    @classmethod
    def of(
        cls,
        plant: Plant,
        traces: Sequence[Trace] = (),
        most_rad_s: float | None = None,
    ) -> "Limits":
        """The limits of a model; motions begin in the middle of recorded ones, if any.

        Without recordings they begin in the middle of the ranges that the model states,
        or in its reference pose. `most_rad_s` is the highest speed of all joints; by
        default that of the motors, or 5 rad/s (0.5 m/s) where the model states none.

        Raises:
          BadValueError: no joint has a servo whose stiffness is known.
        """
        servo = traces[0].servo if traces else plant.servo
        if not servo.kp_nm_rad.any():
            raise BadValueError(
                "motions are planned as position commands, but no servo's stiffness is "
                "known: give --kp, --kd and --max-torque"
            )
        low, high = np.array([range_rad(plant, joint) for joint in plant.joints]).T
        ranged = plant.model.jnt_limited[
            [int(plant.model.joint(joint).id) for joint in plant.joints]
        ].astype(bool)
        reference = plant.model.qpos0[plant.qpos]
        centre = np.where(ranged, (low + high) / 2, reference)
        if traces:
            used = Usage.of(plant, traces)
            centre = (used.low_rad + used.high_rad) / 2
        speed = np.array([speed_rad_s(plant, joint) for joint in plant.joints])
        speed = speed if most_rad_s is None else np.minimum(speed, most_rad_s)
        return cls(np.clip(centre, low, high), low, high, speed, servo.max_torque_nm)

    @property
    def amplitude_rad(self) -> FloatArray:
        """(j,) largest amplitude of a motion around the centre."""
        room = np.minimum(
            self.centre_rad - self.low_rad, self.high_rad - self.centre_rad
        )
        return np.minimum(RANGE_USED * np.maximum(room, 0.0), MOST_RAD)


@dataclass(frozen=True, eq=False)
class PlannedMotion:
    """Commands of a motion that keep the limits in a simulation of the model.

    Attributes:
      motion: what it is and shows.
      joints: names of the joints, in the order of the trace.
      trace: the commands, with the positions that the model takes under them.
      share: (j,) amplitude of each joint as a share of the largest one that its range
        allows; less where speed or torque would be too high.
    """

    motion: Motion
    joints: tuple[str, ...]
    trace: Trace
    share: FloatArray


def planned(
    plant: Plant, limits: Limits, like: Trace | None = None, rate_hz: float = RATE_HZ
) -> list[PlannedMotion]:
    """All motions that keep the limits; those that cannot are left out.

    Neighbouring joints move in opposite directions. `like` is a trace whose servos are
    taken; None for those of the model. There are `rate_hz` commands a second. What the
    robot may hit, its own links included, no model of joints knows.
    """
    servo = plant.servo if like is None else like.servo
    with np.errstate(divide="ignore"):  # a jump of all the amplitude asks for this
        sudden = limits.torque_nm / (servo.kp_nm_rad * limits.amplitude_rad)
    sudden = np.minimum(TORQUE_USED * sudden, 1.0)
    whole = np.ones(len(plant.joints))
    shares = {motion: sudden if motion.sudden else whole for motion in MOTIONS}
    found: dict[Motion, PlannedMotion] = {}
    for _ in range(MOST_TRIES):
        left = [motion for motion in MOTIONS if motion not in found]
        traces = []
        for motion in left:
            time_s = np.arange(round(motion.duration_s * rate_hz) + 1) / rate_hz
            command = commands(motion, limits, shares[motion], time_s)
            traces.append(
                Trace(motion.name, time_s, command, servo, command_rad=command)
            )
        if not left:
            break
        moved = _replayed(plant, traces)
        for motion, trace, (position, torque_nm) in zip(
            left, traces, moved, strict=True
        ):
            wrong = _beyond(limits, position, torque_nm, trace.time_s)
            if wrong.any():
                shares[motion] = np.where(wrong, SMALLER, 1.0) * shares[motion]
            else:
                own = replace(trace, position_rad=position)
                found[motion] = PlannedMotion(motion, plant.joints, own, shares[motion])
    return [found[motion] for motion in MOTIONS if motion in found]


def commands(
    motion: Motion, limits: Limits, share: FloatArray, time_s: FloatArray
) -> FloatArray:
    """(T, j) position commands of a motion with (j,) shares of the full amplitude.

    No joint is commanded faster than it may move.
    """
    shape = motion.shape(time_s, motion.duration_s)
    way = (-1.0) ** np.arange(len(share))
    size = share * limits.amplitude_rad
    if not motion.sudden:
        fastest = float(np.abs(np.gradient(shape, time_s)).max())
        size = np.minimum(size, SPEED_USED * limits.speed_rad_s / fastest)
    return np.asarray(limits.centre_rad + size * way * shape[:, None])


def _replayed(
    plant: Plant, traces: Sequence[Trace]
) -> list[tuple[FloatArray, FloatArray]]:
    """(T, j) positions and torques [N m] of the model under each trace's commands."""
    still = np.zeros(len(plant.joints))
    runs = [Run(trace, trace.position_rad[0], still) for trace in traces]
    results = replay(runs, Variants(plant, 1), STEP_S)
    return [(one.position_rad[0], one.servo_nm[0]) for one in results]


def _beyond(
    limits: Limits, position_rad: FloatArray, torque_nm: FloatArray, time_s: FloatArray
) -> FloatArray:
    """(j,) whether each joint leaves its range, or is too fast or too strong."""
    if not np.isfinite(position_rad).all():
        return np.ones(position_rad.shape[1], bool)
    speed = np.abs(np.gradient(position_rad, time_s, axis=0)).max(axis=0)
    far = (position_rad < limits.low_rad) | (position_rad > limits.high_rad)
    strong = np.abs(torque_nm).max(axis=0) > TORQUE_USED * limits.torque_nm
    return np.asarray(far.any(axis=0) | (speed > limits.speed_rad_s) | strong)
