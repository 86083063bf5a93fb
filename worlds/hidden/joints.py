"""Torques at the joints of a robot with hidden physics, for one physics step."""

from collections.abc import Sequence

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from worlds.hidden.effects.kind import JointTorque, StiffContact
from worlds.hidden.effects.placed import Hidden
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.servos import Servos, servo_torque_nm
from worlds.hidden.transmission import Transmission


class HiddenJoints:
    """A robot's servos, transmissions and other joint torques, with hidden effects.

    The engine's leapfrog integration gives the speeds of half a step ago. They are
    extrapolated to the present, so that explicit damping is second-order accurate.
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
                contact = StiffContact(float(inertia_kg_m2[joint]), step_s)
                self._add(joint, effect, contact)
        self._before: FloatArray | None = None

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

    def encoders(self, position_rad: FloatArray) -> FloatArray:
        """(j,) true angles [rad] of the joints, or of motors that have the encoder."""
        angles = position_rad
        for joint, transmission in self._loose.items():
            if transmission.encoder_at_motor and transmission.motor_rad is not None:
                angles = angles.copy()
                angles[joint] = transmission.motor_rad
        return angles

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
        gains = kp, kd, back_emf, most = self._servos.gains(time_s)
        torque = servo_torque_nm(gains, target - position_rad, speed)
        for i, transmission in self._loose.items():
            torque[i] = transmission.torque(
                float(position_rad[i]),
                float(speed[i]),
                float(target[i]),
                (float(kp[i]), kd[i], most[i], back_emf[i]),
            )
        if self._parts:
            servo_nm = torque.copy()
            for i, part in self._parts:
                torque[i] += part(
                    time_s, float(position_rad[i]), float(speed[i]), float(servo_nm[i])
                )
        return torque
