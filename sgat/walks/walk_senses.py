"""States and actions of a walking robot, as the models of a grounding see them.

All columns come from sensors on board. Joint positions, gyroscope and tilt are
predicted, since the ground disturbs the torso first. The commands of the last ticks are
inputs as well: from them a model learns the latency.
"""

from collections import deque
from collections.abc import Sequence

import numpy as np

from groundwalk.arrays import FloatArray
from robots import Description, biped
from worlds import TICK_S, Observation

HISTORY_TICKS = 5
"""Number of past commands that a model sees, one a tick, the newest included. They
span 50 ms, more than the real world's latency of 36 ms."""

ACCELEROMETER_WEIGHT = 0.002
"""Weight of the accelerometer at every tick of the filter that estimates the tilt. At
10 ms a tick it gives a time constant of 5 s; with 0.5 s, the accelerations of the steps
would cause errors as large as the tilt."""


class WalkSenses:
    """Turns the measurements of n robots into states and actions, tick by tick.

    Only j of the robot's joints are grounded: those whose commands are transformed.
    The first `outcomes` columns of a state are those that a next state has, too: joint
    positions (j) [rad], gyroscope (3) [rad/s] and tilt (2), the first two components of
    the world's up axis in the torso frame. Then follow the last change of the joint
    positions (j) [rad] (up to here are the `sim_columns`, which matter in a world
    without latency), and the HISTORY_TICKS - 1 commands before the newest, oldest
    first, relative to the present joint positions (j each) [rad]. An action is the
    newest command, relative to the present joint positions (j) [rad].
    """

    def __init__(self, joints: Sequence[int]) -> None:
        """Choose the grounded joints, by their indices among all joints."""
        self.joints = list(joints)
        self.outcomes = len(self.joints) + 5
        self.sim_columns = self.outcomes + len(self.joints)

    def reset(self, observation: Observation) -> None:
        """Start a rollout with robots that stand upright and still."""
        self._last_rad = observation.position_rad[:, self.joints]
        self._up = np.tile([0.0, 0.0, 1.0], (len(self._last_rad), 1))
        self._past: deque[FloatArray] = deque(maxlen=HISTORY_TICKS - 1)
        self._past.extend([self._last_rad] * (HISTORY_TICKS - 1))
        self.observe(observation)

    def observe(self, observation: Observation) -> None:
        """Update the states with the measurements of a tick."""
        self._change_rad = observation.position_rad[:, self.joints] - self._last_rad
        self._last_rad = observation.position_rad[:, self.joints]
        self._rate_rad_s = observation.gyroscope_rad_s
        self._up = tilted(
            self._up, observation.gyroscope_rad_s, observation.accelerometer_m_s2
        )

    def state(self) -> FloatArray:
        """(n, s) states at the last observed tick; `WalkSenses` lists the columns."""
        past = [command - self._last_rad for command in self._past]
        return np.hstack([self.outcome(), self._change_rad, *past])

    def outcome(self) -> FloatArray:
        """(n, p) joint positions, gyroscope and tilt at the last observed tick.

        They are the first columns of a state, and all columns of a next state.
        """
        return np.hstack([self._last_rad, self._rate_rad_s, self._up[:, :2]])

    def advanced(
        self, state: FloatArray, action: FloatArray, outcome: FloatArray
    ) -> FloatArray:
        """(n, s) states one tick later, for predictions of several ticks.

        `outcome` (n, p) is the predicted next state after states (n, s) and actions (n,
        j); the other columns follow from them.
        """
        j = len(self.joints)
        moved = outcome[:, :j] - state[:, :j]
        past = [state[:, i : i + j] for i in range(self.sim_columns, state.shape[1], j)]
        later = [command - moved for command in (*past[1:], action)]
        return np.hstack([outcome, moved, *later])

    def action(self, command_rad: FloatArray) -> FloatArray:
        """(n, j) actions [rad]: commands (n, joints) [rad] minus joint positions."""
        return np.asarray(command_rad[:, self.joints] - self._last_rad)

    def command(self, action: FloatArray, command_rad: FloatArray) -> FloatArray:
        """(n, joints) commands [rad]: as given, but grounded joints follow the action.

        Actions (n, j) [rad] are relative to the present joint positions.
        """
        changed = command_rad.copy()
        changed[:, self.joints] = action + self._last_rad
        return changed

    def remember(self, command_rad: FloatArray) -> None:
        """Add the commands (n, joints) [rad] of this tick to the history."""
        self._past.append(command_rad[:, self.joints])


def leg_senses(description: Description) -> WalkSenses:
    """States and actions that ground the joints of a biped's two legs.

    Arms hardly matter to a walk, and grounding them would need more data.

    Example:
      >>> len(leg_senses(robots.get("nao")).joints)
      12
    """
    legs = biped(description)
    return WalkSenses([*legs.left_leg, *legs.right_leg])


def tilted(
    up: FloatArray, rate_rad_s: FloatArray, force_m_s2: FloatArray
) -> FloatArray:
    """(n, 3) estimates of the world's up axis in the torso frame, one tick later.

    A complementary filter of unit vectors `up` (n, 3): d(up)/dt = up x rate, with the
    gyroscope's rate (n, 3) [rad/s], corrected towards the direction of the
    accelerometer (n, 3) [m/s^2] unless that is almost zero.
    """
    turned = up + TICK_S * np.cross(up, rate_rad_s)
    length = np.linalg.norm(force_m_s2, axis=1, keepdims=True)
    felt = np.where(length > 1e-6, force_m_s2 / np.maximum(length, 1e-6), turned)
    mixed = (1 - ACCELEROMETER_WEIGHT) * turned + ACCELEROMETER_WEIGHT * felt
    return np.asarray(mixed / np.linalg.norm(mixed, axis=1, keepdims=True))
