"""Hidden physics of a servo: changed gains and limits, encoder offset, crosstalk."""

from groundwalk.errors import BadValueError
from worlds.hidden.effects.kind import HiddenKind, Quantity, Values
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.servos import Servos
from worlds.hidden.setting import LEAST_LEVER_M, Scales, Setting, Spot

_LEAST_EFFORT = 0.06
"""Least peak torque of a servo in the motion, as a share of its largest torque, for the
joint to be given a torque limit. Insensitive within a factor of two."""


class EncoderOffset(HiddenKind):
    """A constant error of a joint's encoder, which the servo acts on."""

    name = "encoder_offset"
    rank = 9
    in_torques = True
    quantities = (Quantity("offset", "rad", -1.0, 1.0),)

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Add the offset [rad] to the readings of the joint's encoder."""
        servos.offset_rad[joint] += values["offset"]

    def size(self, s: Setting) -> dict[str, float]:
        """Offset of 0.005 (hard to detect) to 0.1 rad (easy), to either side."""
        return {"offset": s.sign * s.part(0.1, 0.005)}

    def shows(self, plant: HiddenPlant, scales: Scales, spot: Spot) -> bool:
        """Whether gravity shows it: on a fixed base the joint has to carry weight."""
        lever_m = scales.branch_lever_m[spot.joint]
        return plant.floating or bool(lever_m >= LEAST_LEVER_M)


class TorqueLimit(HiddenKind):
    """The servo's largest torque is smaller than the nominal one."""

    name = "torque_limit"
    rank = 11
    quantities = (Quantity("torque", "N m", 0.0),)

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Lower the servo's largest torque to the limit, if it is above."""
        most = servos.max_torque_nm
        most[joint] = min(most[joint], values["torque"])

    def size(self, s: Setting) -> dict[str, float]:
        """Limit of 0.9 (hard to detect) to 0.4 (easy) of the motion's peak torque."""
        return {"torque": s.part(0.4, 0.9) * float(s.scales.peak_nm[s.joint])}

    def shows(self, plant: HiddenPlant, scales: Scales, spot: Spot) -> bool:
        """Whether the motion needs at least 6 % of the servo's largest torque."""
        effort = scales.peak_nm[spot.joint] / plant.max_torque_nm[spot.joint]
        return bool(effort >= _LEAST_EFFORT)


class SpeedLimit(HiddenKind):
    """The servo's set-point follows its command at a limited speed."""

    name = "speed_limit"
    rank = 12
    quantities = (Quantity("speed", "rad/s", 0.0),)
    needs_motion = True

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Limit the speed at which the servo's set-point follows its command."""
        most = servos.max_speed_rad_s
        most[joint] = min(most[joint], values["speed"])

    def size(self, s: Setting) -> dict[str, float]:
        """Limit of 0.9 (hard to detect) to 0.4 times (easy) the command's top speed."""
        return {"speed": s.part(0.4, 0.9) * s.speed_rad_s}


class AccelerationLimit(HiddenKind):
    """The servo's set-point follows its command at a limited acceleration.

    Its speed over time is a trapezoid (Biagiotti and Melchiorri 2008, "Trajectory
    planning for automatic machines and robots", section 3.2).
    """

    name = "acceleration_limit"
    since = 5
    quantities = (Quantity("acceleration", "rad/s^2", 0.001),)
    needs_motion = True

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Limit the acceleration of the servo's set-point."""
        most = servos.max_acceleration_rad_s2
        most[joint] = min(most[joint], values["acceleration"])

    def size(self, s: Setting) -> dict[str, float]:
        """Limit that takes 0.02 (hard to detect) to 0.5 s (easy) to the top speed."""
        return {"acceleration": s.speed_rad_s / s.part(0.5, 0.02)}


class ServoGain(HiddenKind):
    """The servo's stiffness is the nominal one times a factor."""

    name = "servo_gain"
    rank = 13
    quantities = (Quantity("factor", "1", 0.0, 10.0),)

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Multiply the servo's stiffness kp by the factor."""
        servos.kp_nm_rad[joint] *= values["factor"]

    def size(self, s: Setting) -> dict[str, float]:
        """Factor that differs from 1 by 0.03 (hard to detect) to 0.4 (easy)."""
        return {"factor": 1.0 + s.sign * s.part(0.4, 0.03)}


class ServoDamping(HiddenKind):
    """The servo's damping and back-EMF are the nominal ones times a factor."""

    name = "servo_damping"
    rank = 14
    quantities = (Quantity("factor", "1", 0.0, 10.0),)
    apart = ("viscous_friction",)

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Multiply the servo's damping kd and back-EMF by the factor."""
        servos.kd_nm_s_rad[joint] *= values["factor"]
        servos.back_emf_nm_s_rad[joint] *= values["factor"]

    def size(self, s: Setting) -> dict[str, float]:
        """Factor that differs from 1 by 0.05 (hard to detect) to 0.4 (easy).

        It is below 1 where all damping is back-EMF, since more back-EMF is the same as
        viscous friction.
        """
        part = s.part(0.4, 0.05)
        sign = s.sign if s.plant.kd_nm_s_rad[s.joint] > 0 else -1.0
        return {"factor": 1.0 + sign * part}

    def cancels(self, plant: HiddenPlant) -> bool:
        """Whether all servo damping is back-EMF, which acts like viscous friction."""
        return not plant.kd_nm_s_rad.any()


class ServoFade(HiddenKind):
    """The servo loses a constant share of its nominal stiffness per second."""

    name = "servo_fade"
    rank = 20
    quantities = (Quantity("rate", "1/s", 0.0, 10.0),)

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Let the servo's stiffness kp decrease from the beginning of the recording."""
        servos.fade_1_s[joint] += values["rate"]

    def size(self, s: Setting) -> dict[str, float]:
        """Rate [1/s] at which 3 % (hard to detect) to 25 % (easy) are lost in total."""
        return {"rate": s.part(0.25, 0.03) / s.duration_s}


class JointCrosstalk(HiddenKind):
    """A share of another joint's command is added to this joint's command."""

    name = "joint_crosstalk"
    rank = 29
    quantities = (
        Quantity("source", "1", 0.0),
        Quantity("share", "1", -1.0, 1.0),
    )
    outside = True

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Add a share of the command of the joint whose index is `source`."""
        source, joints = int(values["source"]), len(servos.kp_nm_rad)
        if not (0 <= source < joints and source != joint):
            raise BadValueError(f"joint_crosstalk: {source} is no other joint")
        servos.leaks.append((joint, source, values["share"]))

    def size(self, s: Setting) -> dict[str, float]:
        """Share of 1 % (hard to detect) to 20 % (easy) of a random joint's command."""
        others = [i for i in range(len(s.plant.joints)) if i != s.joint]
        return {
            "source": float(s.rng.choice(others)),
            "share": s.sign * s.part(0.2, 0.01),
        }

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether the robot has more than one joint."""
        return len(plant.joints) > 1
