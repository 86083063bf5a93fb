"""The state of a walking robot as the models of a grounding see it.

All of it is measured on board. The ground disturbs the torso first, so gyroscope and
tilt belong to what is predicted; the commands of the last ticks carry the latency.
"""

from collections import deque
from collections.abc import Sequence

import numpy as np

from groundwalk.arrays import FloatArray
from robots import Description, biped
from worlds import TICK_S, Observation

HISTORY_TICKS = 5
"""Commands looked at, the newest included: 50 ms, more than the latency of 36 ms."""

ACCELEROMETER_WEIGHT = 0.002
"""Share of the accelerometer in the tilt at every tick: a time constant of 5 s. With
half a second the steps' accelerations leak in: the error is as large as the tilt."""


class WalkSenses:
    """Turns what n robots measure into states, tick by tick.

    A state's columns, for j grounded joints: joint positions (j), gyroscope (3) and
    tilt (2), which a next state has as well; then context: the last change of the
    joints (j), and the HISTORY_TICKS - 1 commands before the newest, the oldest first,
    relative to where the joints are now (j each). An action is the newest command,
    relative to the same.
    """

    def __init__(self, joints: Sequence[int]) -> None:
        """Say which columns of (n, joints) arrays are grounded."""
        self.joints = list(joints)
        self.outcomes = len(self.joints) + 5
        self.sim_columns = self.outcomes + len(self.joints)
        """State columns that matter in a world without latency: no commands."""

    def reset(self, observation: Observation) -> None:
        """Start a rollout: the robots stand upright and still."""
        self._last_rad = observation.position_rad[:, self.joints]
        self._up = np.tile([0.0, 0.0, 1.0], (len(self._last_rad), 1))
        self._past: deque[FloatArray] = deque(maxlen=HISTORY_TICKS - 1)
        self._past.extend([self._last_rad] * (HISTORY_TICKS - 1))
        self.observe(observation)

    def observe(self, observation: Observation) -> None:
        """Take in what was measured at a tick."""
        self._change_rad = observation.position_rad[:, self.joints] - self._last_rad
        self._last_rad = observation.position_rad[:, self.joints]
        self._rate_rad_s = observation.gyroscope_rad_s
        self._up = tilted(
            self._up, observation.gyroscope_rad_s, observation.accelerometer_m_s2
        )

    def state(self) -> FloatArray:
        """(n, s) at the last tick observed."""
        past = [command - self._last_rad for command in self._past]
        return np.hstack([self.outcome(), self._change_rad, *past])

    def outcome(self) -> FloatArray:
        """(n, p) the part of the state that is predicted."""
        return np.hstack([self._last_rad, self._rate_rad_s, self._up[:, :2]])

    def advanced(
        self, state: FloatArray, action: FloatArray, outcome: FloatArray
    ) -> FloatArray:
        """(n, s) the state one tick later, of states, actions and what came of them.

        For predictions of several ticks: what is not predicted follows from the rest.
        """
        j = len(self.joints)
        moved = outcome[:, :j] - state[:, :j]
        past = [state[:, i : i + j] for i in range(self.sim_columns, state.shape[1], j)]
        later = [command - moved for command in (*past[1:], action)]
        return np.hstack([outcome, moved, *later])

    def action(self, command_rad: FloatArray) -> FloatArray:
        """(n, j) what a command (n, joints) asks of the grounded joints."""
        return np.asarray(command_rad[:, self.joints] - self._last_rad)

    def command(self, action: FloatArray, command_rad: FloatArray) -> FloatArray:
        """The command (n, joints) that does an action; other joints as they were."""
        changed = command_rad.copy()
        changed[:, self.joints] = action + self._last_rad
        return changed

    def remember(self, command_rad: FloatArray) -> None:
        """Take in the command that was given at this tick."""
        self._past.append(command_rad[:, self.joints])


def leg_senses(description: Description) -> WalkSenses:
    """Senses that ground the two legs of a robot.

    Arms hardly matter to a walk, and grounding them would need more data.

    Raises:
      BadValueError: the robot has no two legs.
    """
    legs = biped(description)
    return WalkSenses([*legs.left_leg, *legs.right_leg])


def tilted(
    up: FloatArray, rate_rad_s: FloatArray, force_m_s2: FloatArray
) -> FloatArray:
    """The world's up axis in the torso frame one tick on, by a complementary filter.

    d(up)/dt = up x rate, drawn towards the accelerometer's direction where it has one.

    Args:
      up: (n, 3) unit vectors.
      rate_rad_s: (n, 3) gyroscope.
      force_m_s2: (n, 3) accelerometer.
    """
    turned = up + TICK_S * np.cross(up, rate_rad_s)
    length = np.linalg.norm(force_m_s2, axis=1, keepdims=True)
    felt = np.where(length > 1e-6, force_m_s2 / np.maximum(length, 1e-6), turned)
    mixed = (1 - ACCELEROMETER_WEIGHT) * turned + ACCELEROMETER_WEIGHT * felt
    return np.asarray(mixed / np.linalg.norm(mixed, axis=1, keepdims=True))
