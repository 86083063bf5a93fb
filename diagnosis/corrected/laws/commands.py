"""What becomes of a command before the servo gets it: it is late, and slowed down."""

from collections import deque
from collections.abc import Mapping

import mujoco

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


class SpeedLimit(Law):
    """A servo's set-point follows the command no faster than `speed_rad_s`.

    The servo gets the set-point's mean over the step. (MuJoCo's pid actuator, with
    `slewmax`, gets that of the step's end, which is half a step too early.)
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        joints: Mapping[str, Joint],
        joint: str,
        speed_rad_s: float,
    ) -> None:
        """Limit the speed of a joint's set-point, which starts at its first target."""
        self.joint, self.speed_rad_s = joints[joint], speed_rad_s
        self.set_point: float | None = None

    def before_step(self, step: Step) -> None:
        """Act on the step; see `Law`."""
        target = step.targets[self.joint.name]
        if self.set_point is None:
            self.set_point = target
        most = self.speed_rad_s * step.seconds
        change = min(max(target - self.set_point, -most), most)
        step.targets[self.joint.name] = self.set_point + change / 2
        self.set_point += change
