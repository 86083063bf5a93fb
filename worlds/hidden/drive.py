"""Steps one robot with hidden physics in an engine: servos, joint torques, pushes."""

from collections import deque
from collections.abc import Sequence
from functools import partial
from math import ceil

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from worlds.hidden.effects.kind import JointTorque, StiffContact
from worlds.hidden.effects.placed import Hidden, surroundings
from worlds.hidden.engine import WATCH_STEPS, HiddenEngine, least_inertia_kg_m2
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.servos import Servos, Transmission, servo_torque_nm


class HiddenJoints:
    """A robot's servos, transmissions and other joint torques, with hidden effects.

    The engine's leapfrog integration gives the speeds of half a step ago. They are
    extrapolated to the present, so that explicit damping is second-order accurate.

    Attributes:
      servo_nm: (j,) torques of the motors in the last step, without those of effects.
    """

    def __init__(
        self,
        plant: HiddenPlant,
        effects: Sequence[Hidden],
        step_s: float,
        inertia_kg_m2: FloatArray,
    ) -> None:
        """Apply those effects that are at joints to the nominal servos and joints.

        `inertia_kg_m2` (j,) is that at each joint with all other joints free.
        """
        self._servos = Servos(plant, step_s)
        self._parts: list[tuple[int, JointTorque]] = []
        self._loose: dict[int, Transmission] = {}
        for effect in effects:
            if effect.kind.place == "joint":
                joint = plant.joint(effect.place)
                rigid_nm_rad = plant.rigid_nm_rad(joint)
                inertia = float(inertia_kg_m2[joint])
                contact = StiffContact(inertia, step_s, rigid_nm_rad)
                self._add(joint, effect, contact)
        self._before: FloatArray | None = None
        self.servo_nm = np.zeros(len(plant.joints))

    def _add(self, joint: int, effect: Hidden, contact: StiffContact) -> None:
        kind, values = effect.kind, effect.values
        kind.change_servos(self._servos, joint, values)
        torque = kind.torque(values, contact)
        if torque is not None:
            self._parts.append((joint, torque))
        transmission = kind.transmission(values, contact)
        if transmission is not None:
            if joint in self._loose:
                raise BadValueError(
                    f"{effect.place} has backlash or elasticity already; it can have "
                    "one"
                )
            self._loose[joint] = transmission

    @property
    def offset_rad(self) -> FloatArray:
        """(j,) constant error [rad] of the encoders: angle read minus true angle."""
        return self._servos.offset_rad

    @property
    def late_s(self) -> FloatArray:
        """(j,) time [s] by which each joint's reading is older than the others'."""
        return self._servos.late_s

    def encoders(self, position_rad: FloatArray) -> FloatArray:
        """(j,) angles [rad] of the joints, or of motors that have the encoder.

        They are true but for periodic errors of the encoders.
        """
        angles = position_rad
        for joint, transmission in self._loose.items():
            if transmission.encoder_at_motor and transmission.motor_rad is not None:
                angles = angles.copy()
                angles[joint] = transmission.motor_rad
        return self._servos.rippled(angles)

    def torque(
        self,
        time_s: float,
        position_rad: FloatArray,
        velocity_rad_s: FloatArray,
        command_rad: FloatArray,
    ) -> FloatArray:
        """(j,) torques [N m] on the joints, constant over the next physics step.

        `time_s` counts from the start of the recording. Angles and speeds (j,) come
        from the engine; `command_rad` (j,) are the targets that have reached the
        servos.
        """
        before = velocity_rad_s if self._before is None else self._before
        speed = 1.5 * velocity_rad_s - 0.5 * before
        self._before = velocity_rad_s.copy()
        target = self._servos.set_point(command_rad)
        target = self._servos.controlled(target, position_rad)
        gains = kp, kd, back_emf, most = self._servos.gains(time_s)
        torque = servo_torque_nm(gains, target - position_rad, speed)
        for i, transmission in self._loose.items():
            torque[i] = transmission.torque(
                float(position_rad[i]),
                float(speed[i]),
                float(target[i]),
                (float(kp[i]), kd[i], most[i], back_emf[i]),
            )
        self.servo_nm = servo_nm = torque
        if self._parts:
            torque = torque.copy()
            for i, part in self._parts:
                torque[i] += part(
                    time_s, float(position_rad[i]), float(speed[i]), float(servo_nm[i])
                )
        return torque


_LEAD_STEPS = 0.5
"""Delay of every command in physics steps: in leapfrog integration the force at the
start of a step stands for the time from half a step before to half a step after it."""


class CommandLine:
    """Delays commands to servos by a time that need not be whole physics steps."""

    def __init__(self, start_rad: FloatArray, delay_steps: float) -> None:
        """Begin with (j,) targets in force; later ones come `delay_steps` late."""
        self._now, self._delay = start_rad, delay_steps + _LEAD_STEPS
        self._coming: deque[tuple[float, FloatArray]] = deque()

    def send(self, step: int, command_rad: FloatArray) -> None:
        """Send (j,) position targets at the beginning of physics step number `step`."""
        self._coming.append((step + self._delay, command_rad))

    def over(self, step: int) -> FloatArray:
        """(j,) mean position targets [rad] that the servos have in this physics step.

        Must be called once for each step, in order: it drops the commands used.
        """
        if not self._coming or self._coming[0][0] >= step + 1:
            return self._now
        mean, done = np.zeros_like(self._now), 0.0
        while self._coming and self._coming[0][0] < step + 1:
            at, command = self._coming.popleft()
            part = max(at - step, 0.0)
            mean += (part - done) * self._now
            self._now, done = command, part
        return np.asarray(mean + (1.0 - done) * self._now)


class PathLine(CommandLine):
    """Leads to each command on a straight path, as controllers that plan paths do.

    The path begins when the command is sent and takes as long as the tick before.
    """

    def __init__(self, start_rad: FloatArray) -> None:
        """Begin with (j,) targets in force."""
        super().__init__(start_rad, 0.0)
        self._from = self._to = start_rad
        self._sent, self._steps = 0, 1

    def send(self, step: int, command_rad: FloatArray) -> None:
        """Lead to (j,) position targets from those of physics step number `step`."""
        self._from, self._to = self.over(step), command_rad
        self._steps, self._sent = max(step - self._sent, 1), step

    def over(self, step: int) -> FloatArray:
        """(j,) position targets [rad] in the middle of this physics step."""
        done = min((step - self._sent + 0.5) / self._steps, 1.0)
        return np.asarray(self._from + done * (self._to - self._from))


class HiddenDrive:
    """Applies commands, joint torques and pushes to a robot; reads its encoders."""

    def __init__(
        self,
        plant: HiddenPlant,
        effects: Sequence[Hidden],
        world: HiddenEngine,
        step_s: float,
        start_rad: FloatArray,
        paths: bool = False,
    ) -> None:
        """Begin with the robot at rest in the (j,) start pose of the engine `world`.

        With `paths` the servos' targets move steadily from command to command, which
        are not delayed; else each command holds until the next.
        """
        inertia = least_inertia_kg_m2(plant, start_rad)
        around = surroundings(effects)
        self._world, self._step_s = world, step_s
        self._joints = HiddenJoints(plant, effects, step_s, inertia)
        held = CommandLine(start_rad, around.command_delay_s / step_s)
        self._line = PathLine(start_rad) if paths else held
        pushes = [(effect.place, effect.kind.push(effect.values)) for effect in effects]
        self._pushes = [(body, push) for body, push in pushes if push is not None]
        self._late_steps = (around.encoder_delay_s + self._joints.late_s) / step_s
        self._step = 0
        # Past angles at the encoders, as many as their delay needs.
        self._seen = deque([start_rad], maxlen=ceil(self._late_steps.max()) + 2)

    def send(self, command_rad: FloatArray) -> None:
        """Send (j,) position targets to the servos, which get them after the delay."""
        self._line.send(self._step, command_rad)

    def advance(self, steps: int, zero_step: int = 0) -> None:
        """Take physics steps; sensor values are averaged over the last of them.

        Effects count their time from the physics step number `zero_step`.
        """
        world, end = self._world, self._step + steps
        while self._step < end:
            time_s = (self._step - zero_step) * self._step_s
            for body, push in self._pushes:
                force_n = push(time_s, partial(world.body_velocity, body))
                if force_n is not None:
                    world.push(body, force_n)
            torque = self._joints.torque(
                time_s,
                world.position_rad,
                world.velocity_rad_s,
                self._line.over(self._step),
            )
            world.step(torque)
            self._step += 1
            self._seen.append(self._joints.encoders(world.position_rad).copy())
            if self._step > end - WATCH_STEPS:
                world.watch()

    def encoders(self) -> FloatArray:
        """(j,) readings [rad] of noiseless encoders now, with offsets and delays."""
        steps = np.arange(self._step + 1 - len(self._seen), self._step + 1)
        columns = zip(self._late_steps, np.transpose(self._seen), strict=True)
        angles = [np.interp(self._step - late, steps, one) for late, one in columns]
        return np.array(angles) + self._joints.offset_rad

    def motor_torques(self) -> FloatArray:
        """(j,) torques [N m] of the motors in the last physics step."""
        return self._joints.servo_nm.copy()
