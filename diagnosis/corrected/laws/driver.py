"""All laws of a robot together, to be called before each physics step."""

from collections.abc import Mapping, Sequence
from typing import Any

import mujoco
import numpy as np

from diagnosis.corrected.laws.step import Joint, Law, Step

Parts = Sequence[tuple[type[Law], Sequence[Mapping[str, Any]]]]
"""Kinds of laws in the order in which they act, each with the values of its laws."""


class CorrectedLaws:
    """What corrected.xml lacks: call `before_step` before each `mujoco.mj_step`.

    Laws remember what was before: make the model, its data and the laws anew, by
    `load`, to start again. A model must not be changed between its steps.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        back_emf: Mapping[str, float],
        parts: Parts,
    ) -> None:
        """Prepare a model made from corrected.xml, whose fields some laws change.

        Args:
          model: the model.
          data: its state; the first step starts from what it is then.
          back_emf: back-EMF of the servos [N m s/rad], by the joints' names.
          parts: the laws and their values.
        """
        self.model, self.data = model, data
        self.joints = {
            name: Joint.of(model, name, value) for name, value in back_emf.items()
        }
        self.laws = [
            kind(model, self.joints, **values)  # type: ignore[call-arg]
            for kind, every in parts
            for values in every
        ]
        mujoco.mj_setConst(model, mujoco.MjData(model))  # inertias may have changed
        self._targets: dict[str, float] = {}

    def before_step(
        self,
        targets: Mapping[str, float],
        torques: Mapping[str, float] | None = None,
    ) -> None:
        """Set controls and applied forces of the step that follows.

        Args:
          targets: position targets of servos [rad], by joint, in angles as the encoders
            show them. A joint that is not named keeps its target, the angle where it
            starts at first.
          torques: torques of motors without servos [N m], by joint.

        Forces of your own belong into `data.qfrc_applied` and `data.xfrc_applied` after
        this call, which begins with none.
        """
        if not self._targets:
            self._begin(targets)
        self._targets |= targets
        step = Step(
            self.model,
            self.data,
            dict(self._targets),
            dict(torques or {}),
            self.model.opt.timestep,
        )
        self.data.qfrc_applied[:] = 0.0
        self.data.xfrc_applied[:] = 0.0
        for law in self.laws:
            law.before_step(step)
        for joint in self._each():
            self.data.ctrl[joint.actuator] = step.targets[joint.name]
            self.data.qfrc_applied[joint.dof] += step.torques.get(joint.name, 0.0)

    def readings(self) -> dict[str, tuple[float, float]]:
        """What encoders show now, after a step: angle [rad] and speed [rad/s] by joint.

        Offsets and delays of the encoders are in it.
        """
        return {joint.name: self._reading(joint) for joint in self._each()}

    def gyroscope(self, true: Sequence[float]) -> list[float]:
        """What the gyroscope shows [rad/s] for a true turn rate, about its axes."""
        errors = [law.gyroscope_bias for law in self.laws]
        return [rate + sum(one) for rate, *one in zip(true, *errors, strict=True)]

    def _begin(self, targets: Mapping[str, float]) -> None:
        """Hold joints that have no target yet, and give motors their first torques.

        Springs between motors and joints begin without any.
        """
        start = self.data.qpos
        self._targets = {one.name: start[one.qpos] for one in self._each()}
        self._targets |= targets
        for joint in self._each():
            angle = start[joint.qpos]
            asked = angle if joint.is_spring else self._targets[joint.name]
            self.data.ctrl[joint.actuator] = asked
        mujoco.mj_forward(self.model, self.data)

    def _reading(self, joint: Joint) -> tuple[float, float]:
        for law in self.laws:
            own = law.position(joint.name)
            if own is not None:
                return own
        angle, speed = self.data.qpos[joint.qpos], self.data.qvel[joint.dof]
        late = [self._late(f"{what}.{joint.name}") for what in ("position", "velocity")]
        if late[0] is None or late[1] is None:
            return float(angle), float(speed)
        return late[0], late[1]

    def _late(self, sensor: str) -> float | None:
        """A delayed sensor's reading now; None if the model has no such sensor."""
        number = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_SENSOR, sensor)
        if number < 0 or self.model.sensor_delay[number] == 0:
            return None
        interpolation = int(self.model.sensor_history[number, 1])
        found = mujoco.mj_readSensor(
            self.model, self.data, number, self.data.time, np.zeros(1), interpolation
        )
        return float(found[0])

    def _each(self) -> Sequence[Joint]:
        return list(self.joints.values())
