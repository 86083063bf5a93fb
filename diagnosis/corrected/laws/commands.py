"""What becomes of a command before the servo gets it: it is late, and slowed down."""

from collections import deque
from collections.abc import Mapping

import mujoco
import numpy as np

from diagnosis.corrected.laws.step import Joint, Law, Step


class LateCommand(Law):
    """A command takes effect `delay_s` later, also within a step, as a mean over it.

    Before the first command is due it counts as always given.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        joints: Mapping[str, Joint],
        joint: str,
        delay_s: float,
    ) -> None:
        """Take over the delay of a joint's actuator.

        There it would come after all else that happens to the command.
        """
        self.joint, self.delay_s = joints[joint], delay_s
        model.actuator_delay[self.joint.actuator] = 0.0
        self.given: deque[float] = deque()

    def before_step(self, step: Step) -> None:
        """Act on the step; see `Law`."""
        steps, share = divmod(self.delay_s / step.seconds, 1)
        self.given.append(step.targets[self.joint.name])
        while len(self.given) < steps + 2:
            self.given.appendleft(self.given[0])
        older, newer = self.given[0], self.given[1]
        self.given.popleft()
        step.targets[self.joint.name] = (1 - share) * newer + share * older


class LimitedSetPoint(Law):
    """A servo's set-point follows the command at limited speed and acceleration.

    It slows down such that it comes to rest at the command. The servo gets its mean
    over the step. (MuJoCo's pid actuator, with `slewmax`, gets that of the step's end,
    which is half a step too early.)
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        joints: Mapping[str, Joint],
        joint: str,
        speed_rad_s: float = float("inf"),
        acceleration_rad_s2: float = float("inf"),
    ) -> None:
        """Limit a joint's set-point, which starts at rest at its first target."""
        self.joint, self.speed_rad_s = joints[joint], speed_rad_s
        self.acceleration_rad_s2 = acceleration_rad_s2
        self.set_point: float | None = None
        self.speed = 0.0

    def before_step(self, step: Step) -> None:
        """Act on the step; see `Law`."""
        target = step.targets[self.joint.name]
        if self.set_point is None:
            self.set_point = target
        error, before = target - self.set_point, self.speed
        towards, far = (-1.0 if error < 0 else 1.0), abs(error)
        most = self.acceleration_rad_s2 * step.seconds
        if np.isinf(most):
            self.speed = towards * min(far / step.seconds, self.speed_rad_s)
            change = self.speed * step.seconds
        else:  # what is left must do for this step and for slowing down
            left = max(far - towards * before * step.seconds / 2, 0.0)
            root = np.sqrt((most / 2) ** 2 + 2 * self.acceleration_rad_s2 * left)
            wanted = towards * min(float(root) - most / 2, self.speed_rad_s)
            self.speed = min(max(wanted, before - most), before + most)
            change = (before + self.speed) / 2 * step.seconds
        step.targets[self.joint.name] = self.set_point + change / 2
        self.set_point += change
