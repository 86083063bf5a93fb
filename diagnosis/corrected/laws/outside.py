"""Forces on bodies from outside: pushes and drag."""

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np
import numpy.typing as npt

from diagnosis.corrected.laws.step import Joint, Law, Step


class Push(Law):
    """A constant force (x, y, z) [N], world frame, at a body's centre of mass.

    It acts from `start_s` for `duration_s`, in the simulation's time, which is 0 where
    the recordings began.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        joints: Mapping[str, Joint],
        body: str,
        force_n: Sequence[float],
        start_s: float,
        duration_s: float,
    ) -> None:
        """Push a body for some time."""
        self.body, self.force_n = model.body(body).id, np.array(force_n)
        self.start_s, self.end_s = start_s, start_s + duration_s

    def before_step(self, step: Step) -> None:
        """Act on the step; see `Law`."""
        begin = max(step.data.time, self.start_s)
        end = min(step.data.time + step.seconds, self.end_s)
        share = max(end - begin, 0.0) / step.seconds
        step.data.xfrc_applied[self.body, :3] += share * self.force_n


class Drag(Law):
    """A force -c v at a body's centre of mass, v its mean velocity in the last step."""

    def __init__(
        self,
        model: mujoco.MjModel,
        joints: Mapping[str, Joint],
        body: str,
        coefficient_n_s_m: float,
    ) -> None:
        """Drag a body by c newtons for each m/s."""
        self.body, self.c = model.body(body).id, coefficient_n_s_m
        self.last_m: npt.NDArray[np.float64] | None = None

    def before_step(self, step: Step) -> None:
        """Act on the step; see `Law`."""
        centre = step.data.xipos[self.body].copy()
        if self.last_m is not None:
            velocity = (centre - self.last_m) / step.seconds
            step.data.xfrc_applied[self.body, :3] -= self.c * velocity
        self.last_m = centre
