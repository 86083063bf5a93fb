"""The walk engine: turns velocity requests and sensor readings into joint commands.

Gyroscope feedback to the ankles balances the robots. Turning rates are positive about
the torso's axes (x forward, y left, z up), ankle angles about the same axes when the
leg is straight. A torso that pitches forward has a positive rate about y; a positive
ankle pitch turns the toes down, so that the pressure moves forward under the foot and
pushes back. A torso that rolls to its right has a positive rate about x, and a positive
ankle roll turns the foot's right edge down. Both terms therefore have a positive sign.
"""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadValueError
from robots.leg_geometry import FOOT_SENSORS, Biped
from walk_engine.engine_config import EngineConfig
from walk_engine.feet import resting_feet
from walk_engine.gait import PARAMETERS, Gait, stack
from walk_engine.posture import Limits, Posture
from walk_engine.step_plan import Velocity
from walk_engine.stepper import Progress, Stepper, select
from walk_engine.walk_state import StateArray, WalkState


class _Memory(NamedTuple):
    """State of the walk engine between two ticks; the last axis of arrays is robots."""

    progress: Progress
    rate_rad_s: FloatArray  # (2, n) filtered pitch and roll rate
    command_rad: FloatArray  # (joints, n)


class WalkEngine:
    """Gait generator (rUNSWift Walk2014) for n equal robots, each with its own gait.

    The engine knows no world: call `step` once per tick with the robots' measurements,
    and send the robots the commands that it returns. Robots do not influence each
    other, not even in the last bit. Mirrored input gives mirrored commands.

    Example:
      >>> engine = WalkEngine(robots.biped(robots.get("nao")), [gaits.get("start")])
      >>> engine.start_pose().shape
      (1, 20)
    """

    def __init__(
        self,
        biped: Biped,
        gaits: Sequence[Gait] | FloatArray,
        tick_s: float = 0.01,
        *,
        first_swing: Literal["left", "right"] = "left",
    ) -> None:
        """Make an engine whose robots are crouched and ready to walk.

        Args:
          biped: the robots' legs and joints.
          gaits: n gaits, or an (n, 16) array of their vectors, with values for the NAO;
            they are scaled to the robot's size.
          tick_s: time between two calls of `step` [s].
          first_swing: the foot that swings first.
        """
        if not (np.isfinite(tick_s) and tick_s > 0):
            raise BadValueError(f"the tick is {tick_s} s; it must be positive")
        if first_swing not in ("left", "right"):
            raise BadValueError(
                f"first_swing is {first_swing!r}; use 'left' or 'right'"
            )
        config = EngineConfig().scaled(biped.scale)
        self._gait = {
            parameter.name: values * biped.scale.of(parameter.unit)
            for parameter, values in zip(PARAMETERS, stack(gaits).T.copy(), strict=True)
        }
        self._tick_s = tick_s
        self._left_first = first_swing == "left"
        self._stepper = Stepper(biped, self._gait, tick_s, config)
        self._posture = Posture(biped, self._gait, config)
        self._limits = Limits(biped, tick_s, config.speed_fraction)
        gains_s = self._gait["gyro_sagittal"], self._gait["gyro_coronal"]
        self._gain_s = np.stack(gains_s)
        # The low-pass filter has the same time constant whatever the tick.
        kept = 1.0 - self._gait["gyro_filter"]
        self._new_rate_weight = 1.0 - kept ** (tick_s / config.gyro_filter_tick_s)
        self.reset()

    @property
    def n(self) -> int:
        """Number of robots."""
        return len(self._new_rate_weight)

    @property
    def state(self) -> StateArray:
        """(n,) the `WalkState` of each robot, such as READY or WALKING, as a number."""
        return self._memory.progress.state.copy()

    @property
    def support(self) -> StateArray:
        """(n,) the supporting foot of each robot: 1 left, -1 right, 0 both."""
        return self._memory.progress.support

    @property
    def step_time_s(self) -> FloatArray:
        """(n,) time since the step, crouching or rising began [s]; 0 at rest."""
        return self._memory.progress.ticks * self._tick_s

    def start_pose(self) -> FloatArray:
        """(n, joints) joint angles [rad] of the crouch in which walking starts."""
        feet = resting_feet(self._gait["com_offset"])
        target = self._posture.targets(feet, np.ones(self.n), np.zeros((2, 2, self.n)))
        return self._limits.within_range(target).T.copy()

    def reset(self) -> None:
        """Put each robot back into the state READY, crouched in its `start_pose`."""
        self._memory = _Memory(
            progress=self._stepper.start(self._left_first),
            rate_rad_s=np.zeros((2, self.n)),
            command_rad=self.start_pose().T.copy(),
        )

    def step(
        self,
        request: Velocity,
        gyroscope_rad_s: FloatArray,
        foot_force_n: FloatArray,
        active: BoolArray | None = None,
    ) -> FloatArray:
        """Advance all robots by one tick, and return their joint commands.

        Args:
          request: requested velocities; they are read when a step begins.
          gyroscope_rad_s: (n, 3) turning rates of the torso about its x (forward),
            y (left) and z (up) axes.
          foot_force_n: (n, 8) readings of the force sensors: left foot front left,
            front right, rear left, rear right, then the right foot.
          active: (n,) whether a robot takes part; by default all do. Time stands still
            for the others, whose last command is repeated.

        Returns:
          (n, joints) joint position commands [rad], a new array.
        """
        self._check_shapes(request, gyroscope_rad_s, foot_force_n, active)
        before = self._memory
        progress, feet, down = self._stepper.advance(
            before.progress, request, foot_force_n.T.copy()
        )
        measured = np.stack((gyroscope_rad_s[:, 1], gyroscope_rad_s[:, 0]))
        rate = before.rate_rad_s + self._new_rate_weight * (
            measured - before.rate_rad_s
        )
        ankle_rad = (self._gain_s * rate)[:, None] * _feedback_share(progress)
        target = self._posture.targets(feet, down, ankle_rad)
        command = self._limits.towards(before.command_rad, target)
        now = _Memory(progress, rate, command)
        self._memory = now if active is None else select(active, now, before)
        return self._memory.command_rad.T.copy()

    def _check_shapes(
        self,
        request: Velocity,
        gyroscope_rad_s: FloatArray,
        foot_force_n: FloatArray,
        active: BoolArray | None,
    ) -> None:
        """Refuse arrays whose shapes do not fit the number of robots."""
        robots = (self.n,)
        wanted: list[tuple[str, npt.ArrayLike, tuple[int, ...]]] = [
            ("gyroscope_rad_s", gyroscope_rad_s, (self.n, 3)),
            ("foot_force_n", foot_force_n, (self.n, FOOT_SENSORS)),
            ("active", np.ones(robots) if active is None else active, robots),
        ]
        given = vars(request).items()
        wanted += [(name, value, robots) for name, value in given if np.ndim(value)]
        for name, array, shape in wanted:
            if (found := np.shape(array)) != shape:
                raise BadValueError(f"{name} has shape {found}; it must be {shape}")


def _feedback_share(now: Progress) -> FloatArray:
    """Factor (2, n), 0 or 1, of the gyroscope feedback to each ankle: left, then right.

    During a step only the ankle of the support foot gets feedback, in the state READY
    none, in all other states both.
    """
    both, support = np.where(now.state == WalkState.READY, 0.0, 1.0), now.support
    return np.where(support == 0, both, np.stack((support > 0, support < 0)))
