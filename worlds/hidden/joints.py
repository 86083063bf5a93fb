"""Servos and joints with hidden physics: the torques of one fine step."""

from collections.abc import Sequence

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from worlds.hidden.effects import Hidden
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.torques import JointTorque, joint_torque, rigid_nm_rad
from worlds.hidden.transmission import Transmission


class HiddenJoints:
    """The servos of one robot, and what acts at its joints besides.

    An engine's speeds are those half a step ago; the law extrapolates them from the
    two last ones to now, which makes its explicit damping exact to second order.
    """

    def __init__(
        self,
        plant: HiddenPlant,
        effects: Sequence[Hidden],
        step_s: float,
        inertia_kg_m2: FloatArray,
    ) -> None:
        """Sort the effects by what they change.

        Args:
          plant: the nominal robot.
          effects: all that is hidden; those of other kinds change nothing here.
          step_s: time step.
          inertia_kg_m2: (j,) what each joint moves at least.
        """
        j = len(plant.joints)
        self._plant, self._step_s, self._inertia = plant, step_s, inertia_kg_m2
        self._kp = plant.kp_nm_rad.copy()
        self._kd = plant.kd_nm_s_rad.copy()
        self._emf = plant.back_emf_nm_s_rad.copy()
        self._most = plant.max_torque_nm.copy()
        self._slew, self._fade = np.full(j, np.inf), np.zeros(j)
        self.offset_rad = np.zeros(j)
        """(j,) measured less true angle."""
        self._parts: list[tuple[int, JointTorque]] = []
        self._leaks: list[tuple[int, int, float]] = []
        self._soft: dict[int, Transmission] = {}
        self._motor_side: set[int] = set()
        for effect in effects:
            self._add(effect)
        self._slews = bool(np.isfinite(self._slew).any())
        self._fades = bool(self._fade.any())
        self._target: FloatArray | None = None
        self._before: FloatArray | None = None

    def _add(self, effect: Hidden) -> None:
        if effect.name in _SERVO:
            self._change_servo(self._plant.joint(effect.place), effect)
        elif effect.name in ("backlash", "joint_elasticity"):
            self._loosen(self._plant.joint(effect.place), effect)
        elif effect.name == "joint_crosstalk":
            joint = self._plant.joint(effect.place)
            source = int(effect["source"])
            if not (0 <= source < len(self._kp) and source != joint):
                raise BadValueError(f"joint_crosstalk: {source} is no other joint")
            self._leaks.append((joint, source, effect["share"]))
        elif effect.name not in _ELSEWHERE:
            joint = self._plant.joint(effect.place)
            part = joint_torque(effect, float(self._inertia[joint]), self._step_s)
            if part is not None:
                self._parts.append((joint, part))

    def _change_servo(self, i: int, effect: Hidden) -> None:
        match effect.name:
            case "servo_gain":
                self._kp[i] *= effect["factor"]
            case "servo_damping":
                self._kd[i] *= effect["factor"]
                self._emf[i] *= effect["factor"]
            case "torque_limit":
                self._most[i] = min(self._most[i], effect["torque"])
            case "speed_limit":
                self._slew[i] = min(self._slew[i], effect["speed"])
            case "servo_fade":
                self._fade[i] += effect["rate"]
            case "encoder_offset":
                self.offset_rad[i] += effect["offset"]

    def _loosen(self, i: int, effect: Hidden) -> None:
        if i in self._soft:
            raise BadValueError(
                f"{effect.place} has backlash or elasticity already; it can have one"
            )
        if effect.name == "joint_elasticity":
            self._motor_side.add(i)
            values = (effect["stiffness"], effect["damping"], 0.0)
        else:
            stiffness = rigid_nm_rad(float(self._inertia[i]), self._step_s)
            values = (stiffness, 0.0, effect["gap"])
        self._soft[i] = Transmission(*values, self._step_s)

    def encoders(self, position_rad: FloatArray) -> FloatArray:
        """(j,) angles where the encoders sit, without any offset.

        That is at the joint, and before the spring of an elastic one.
        """
        if not self._motor_side:
            return position_rad
        angles = position_rad.copy()
        for joint in self._motor_side:
            motor = self._soft[joint].motor_rad
            if motor is not None:
                angles[joint] = motor
        return angles

    def torque(
        self,
        time_s: float,
        position_rad: FloatArray,
        velocity_rad_s: FloatArray,
        command_rad: FloatArray,
    ) -> FloatArray:
        """(j,) torques [N m] that hold over the next fine step.

        Args:
          time_s: in the recording's time, negative before it begins.
          position_rad: (j,) of the joints, as the engine has them.
          velocity_rad_s: (j,) likewise.
          command_rad: (j,) that has reached the servos.
        """
        before = velocity_rad_s if self._before is None else self._before
        speed = 1.5 * velocity_rad_s - 0.5 * before
        self._before = velocity_rad_s.copy()
        target = self._set_point(command_rad) - self.offset_rad
        kp = self._kp
        if self._fades:
            kp = kp * np.maximum(1.0 - self._fade * max(time_s, 0.0), 0.0)
        torque = kp * (target - position_rad) - self._kd * speed
        torque = np.minimum(np.maximum(torque, -self._most), self._most)
        torque -= self._emf * speed
        for i, soft in self._soft.items():
            torque[i] = soft.torque(
                float(position_rad[i]),
                float(speed[i]),
                float(target[i]),
                (float(kp[i]), self._kd[i], self._most[i], self._emf[i]),
            )
        if self._parts:
            servo_nm = torque.copy()
            for i, part in self._parts:
                torque[i] += part.torque(
                    time_s, float(position_rad[i]), float(speed[i]), float(servo_nm[i])
                )
        return np.asarray(torque)

    def _set_point(self, command_rad: FloatArray) -> FloatArray:
        target = command_rad
        if self._leaks:
            target = target.copy()
            for i, source, share in self._leaks:
                target[i] += share * command_rad[source]
        return self._slewed(target) if self._slews else target

    def _slewed(self, target: FloatArray) -> FloatArray:
        """What a set-point of limited speed has got to; it begins where it is."""
        if self._target is None:
            self._target = target
        most, now = self._slew * self._step_s, self._target
        change = target - now
        self._target = now + np.clip(change, -most, most)
        # A ramp has got to `now` at the step's start; what is not limited is centred.
        return np.where(np.abs(change) > most, now, self._target)


_SERVO = frozenset(
    {
        "servo_gain",
        "servo_damping",
        "torque_limit",
        "speed_limit",
        "servo_fade",
        "encoder_offset",
    }
)
_ELSEWHERE = frozenset(
    {
        "command_latency", "sensor_delay", "gyro_bias", "armature", "payload_mass",
        "com_offset", "contact_friction", "contact_compliance", "ground_slope",
        "uneven_ground", "external_force", "drag",
    }
)  # fmt: skip
