"""Steps one robot with hidden physics in an engine: servos, joint torques, pushes."""

from collections import deque
from collections.abc import Callable, Sequence
from functools import partial
from math import ceil

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from worlds.hidden.commands import CommandLine, Held, PathLine, mean_of
from worlds.hidden.effects.kind import JointTorque, StiffContact
from worlds.hidden.effects.placed import Hidden, surroundings
from worlds.hidden.engine import (
    WATCH_STEPS,
    HiddenEngine,
    least_inertia_kg_m2,
    present,
)
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.servos import Gains, Servos, Transmission, servo_torque_nm

SETTLED = 3
"""Rounds in which a supply's voltage and the torques under it settle. Each is exact
where torques are in proportion to the voltage but for back-EMF, and keep their signs.
"""


class HiddenJoints:
    """A robot's servos, transmissions and other joint torques, with hidden effects.

    All torques are those in the middle of a physics step, as `HiddenDrive` says. Speeds
    are extrapolated to it, so that explicit damping is second-order accurate.

    Attributes:
      servo_nm: (j,) torques of the motors in the last step, without those of effects.
    """

    def __init__(
        self,
        plant: HiddenPlant,
        effects: Sequence[Hidden],
        step_s: float,
        inertia_kg_m2: FloatArray,
        links_nm: Callable[[], FloatArray],
    ) -> None:
        """Apply those effects that are at joints to the nominal servos and joints.

        `inertia_kg_m2` (j,) is that at each joint with all other joints free;
        `links_nm` is `HiddenEngine.links_nm`.
        """
        self._servos = Servos(plant, step_s)
        self._servos.sag_share = surroundings(effects).sag_share
        self._parts: list[tuple[int, JointTorque]] = []
        self._loose: dict[int, Transmission] = {}
        for effect in effects:
            if effect.kind.place == "joint":
                joint = plant.joint(effect.place)
                rigid_nm_rad = plant.rigid_nm_rad(joint)
                inertia = float(inertia_kg_m2[joint])
                own_nm = partial(_at, links_nm, joint)
                middle_rad = float(np.mean(plant.range_rad[joint]))
                contact = StiffContact(
                    inertia, step_s, rigid_nm_rad, own_nm, middle_rad
                )
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
            motor_rad = transmission.next_rad
            if transmission.encoder_at_motor and motor_rad is not None:
                angles = angles.copy()
                angles[joint] = motor_rad
        return self._servos.rippled(angles)

    def torque(
        self,
        time_s: float,
        position_rad: FloatArray,
        velocity_rad_s: FloatArray,
        held: Sequence[Held],
    ) -> FloatArray:
        """(j,) torques [N m] on the joints, constant over the next physics step.

        `time_s` is that of the step's middle, counted from the start of the recording.
        Angles and speeds (j,) come from the engine; `held` are the targets that have
        reached the servos. Servos that remember earlier targets get their mean.
        """
        before = velocity_rad_s if self._before is None else self._before
        speed = present(velocity_rad_s, before)
        self._before = velocity_rad_s.copy()
        servos, gains = self._servos, self._servos.gains(time_s)
        if servos.remember:
            held = [(1.0, mean_of(held))]
        aims = [
            (share, servos.controlled(servos.set_point(command_rad), position_rad))
            for share, command_rad in held
        ]
        target = sum((share * aim for share, aim in aims), np.zeros_like(speed))
        errors = [(share, aim - position_rad) for share, aim in aims]
        if servos.sag_share:
            gains = self._sagged(gains, errors, speed)
        torque = _mean_nm(gains, errors, speed)
        kp, kd, back_emf, most = gains
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

    def _sagged(
        self,
        gains: Gains,
        errors: Sequence[tuple[float, FloatArray]],
        speed: FloatArray,
    ) -> Gains:
        """The gains with the voltage that a supply has under the torques that follow.

        Motors whose gears are loose are taken to have the torques of the step before.
        """
        kp, kd, back_emf, most = gains

        def weaker(left: float) -> Gains:
            return left * kp, left * kd, back_emf, left * most

        def then(left: float) -> float:
            torque = _mean_nm(weaker(left), errors, speed)
            for joint in self._loose:
                torque[joint] = self.servo_nm[joint]
            return self._servos.voltage(torque)

        left = 1.0
        for _ in range(SETTLED):  # Steffensen's method
            once = then(left)
            step, twice = once - left, then(once)
            bend = (twice - once) - step
            left = left - step**2 / bend if abs(bend) > 1e-12 else twice
        return weaker(left)


class HiddenDrive:
    """Applies commands, joint torques and pushes to a robot; reads its encoders.

    Engines integrate by leapfrog: forces act over a whole physics step, and the
    positions that belong to them are those in its middle. So the engine's positions are
    half a step ahead of its speeds, of commands and of readings, which are taken at the
    ends of steps. Commands then change with the steps, and all that depends on
    positions and speeds is second-order accurate.
    """

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
        self._joints = HiddenJoints(plant, effects, step_s, inertia, world.links_nm)
        held = CommandLine(start_rad, around.command_delay_s / step_s)
        self._line = PathLine(start_rad) if paths else held
        pushes = [(effect.place, effect.kind.push(effect.values)) for effect in effects]
        self._pushes = [(body, push) for body, push in pushes if push is not None]
        self._late_steps = (around.encoder_delay_s + self._joints.late_s) / step_s
        self._step = 0
        # Past angles at the encoders, as many as their delay needs.
        self._seen = deque([start_rad], maxlen=ceil(self._late_steps.max()) + 3)
        self._true = deque([start_rad], maxlen=2)

    def send(self, command_rad: FloatArray) -> None:
        """Send (j,) position targets to the servos, which get them after the delay."""
        self._line.send(self._step, command_rad)

    def advance(self, steps: int, zero_step: int = 0) -> None:
        """Take physics steps; sensor values are averaged over the last of them.

        Effects count their time from the physics step number `zero_step`.
        """
        world, end = self._world, self._step + steps
        while self._step < end:
            time_s = (self._step + 0.5 - zero_step) * self._step_s
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
            self._true.append(world.position_rad.copy())
            self._seen.append(self._joints.encoders(world.position_rad).copy())
            if self._step > end - WATCH_STEPS:
                world.watch()

    def encoders(self) -> FloatArray:
        """(j,) readings [rad] of noiseless encoders now, with offsets and delays."""
        steps = np.arange(self._step + 1 - len(self._seen), self._step + 1)
        columns = zip(self._late_steps, np.transpose(self._seen), strict=True)
        now = self._step - 0.5
        angles = [np.interp(now - late, steps, one) for late, one in columns]
        return np.array(angles) + self._joints.offset_rad

    def positions(self) -> FloatArray:
        """(j,) true angles [rad] of the joints now."""
        return np.asarray(np.mean(self._true, axis=0))

    def motor_torques(self) -> FloatArray:
        """(j,) torques [N m] of the motors in the last physics step."""
        return self._joints.servo_nm.copy()


def _mean_nm(
    gains: Gains, errors: Sequence[tuple[float, FloatArray]], speed: FloatArray
) -> FloatArray:
    """(j,) mean torques [N m] of servos with errors (j,) [rad], each for a share."""
    every = (share * servo_torque_nm(gains, error, speed) for share, error in errors)
    return np.asarray(sum(every, np.zeros_like(speed)))


def _at(links_nm: Callable[[], FloatArray], joint: int) -> float:
    """What a function of (j,) torques says of one joint."""
    return float(links_nm()[joint])
