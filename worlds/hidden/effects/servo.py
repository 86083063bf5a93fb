"""Hidden physics of a servo: its gains, limits, encoder and wiring."""

from groundwalk.errors import BadValueError
from worlds.hidden.effects.kind import HiddenKind, Quantity, Values
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.servos import Servos
from worlds.hidden.setting import LEAST_LEVER_M, Scales, Setting, Spot

_LEAST_EFFORT = 0.06
"""A joint whose servo needs a smaller share of its largest torque does not show a
torque limit. Insensitive within a factor of two."""


class EncoderOffset(HiddenKind):
    """The encoder reads a constant angle too much."""

    name = "encoder_offset"
    rank = 9
    quantities = (Quantity("offset", "rad", -1.0, 1.0),)

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Add the offset to the encoder's readings, which the servo controls."""
        servos.offset_rad[joint] += values["offset"]

    def size(self, s: Setting) -> dict[str, float]:
        """Offset from 0.005 (hard to see) to 0.1 rad (easy), to either side."""
        return {"offset": s.sign * s.part(0.1, 0.005)}

    def shows(self, plant: HiddenPlant, scales: Scales, spot: Spot) -> bool:
        """Whether gravity shows it: a joint on a fixed base has to carry weight."""
        lever_m = scales.bodies.branch_lever_m[spot.joint]
        return plant.floating or bool(lever_m >= LEAST_LEVER_M)


class TorqueLimit(HiddenKind):
    """The servo's largest torque is smaller than the nominal one."""

    name = "torque_limit"
    rank = 11
    quantities = (Quantity("torque", "N m", 0.0),)

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Lower the servo's largest torque, if it is not lower already."""
        most = servos.max_torque_nm
        most[joint] = min(most[joint], values["torque"])

    def size(self, s: Setting) -> dict[str, float]:
        """Limit from 0.9 (hard to see) to 0.4 times (easy) the largest torque used."""
        return {"torque": s.part(0.4, 0.9) * float(s.scales.peak_nm[s.joint])}

    def shows(self, plant: HiddenPlant, scales: Scales, spot: Spot) -> bool:
        """Whether the motion needs a noticeable share of the servo's largest torque."""
        effort = scales.peak_nm[spot.joint] / plant.max_torque_nm[spot.joint]
        return bool(effort >= _LEAST_EFFORT)


class SpeedLimit(HiddenKind):
    """The servo's set-point follows its command at a limited speed."""

    name = "speed_limit"
    rank = 12
    quantities = (Quantity("speed", "rad/s", 0.0),)
    needs_motion = True

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Lower the speed at which the servo's set-point follows its command."""
        most = servos.max_speed_rad_s
        most[joint] = min(most[joint], values["speed"])

    def size(self, s: Setting) -> dict[str, float]:
        """Limit from 0.9 (hard to see) to 0.4 times (easy) the command's top speed."""
        return {"speed": s.part(0.4, 0.9) * s.speed_rad_s}


class ServoGain(HiddenKind):
    """The servo's stiffness is the nominal one times a factor."""

    name = "servo_gain"
    rank = 13
    quantities = (Quantity("factor", "1", 0.0, 10.0),)

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Multiply the servo's stiffness kp by the factor."""
        servos.kp_nm_rad[joint] *= values["factor"]

    def size(self, s: Setting) -> dict[str, float]:
        """Factor that differs from 1 by 0.03 (hard to see) to 0.4 (easy)."""
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
        """Factor that differs from 1 by 0.05 (hard to see) to 0.4 (easy).

        It is below 1 where all damping is back-EMF: more of that is the same as viscous
        friction.
        """
        part = s.part(0.4, 0.05)
        sign = s.sign if s.plant.kd_nm_s_rad[s.joint] > 0 else -1.0
        return {"factor": 1.0 + sign * part}

    def cancels(self, plant: HiddenPlant) -> bool:
        """Whether all damping is back-EMF: less of it and more friction then cancel."""
        return not plant.kd_nm_s_rad.any()


class ServoFade(HiddenKind):
    """The servo loses a constant share of its stiffness in every second."""

    name = "servo_fade"
    rank = 20
    quantities = (Quantity("rate", "1/s", 0.0, 10.0),)

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Let the servo's stiffness kp fade from the beginning of the recording."""
        servos.fade_1_s[joint] += values["rate"]

    def size(self, s: Setting) -> dict[str, float]:
        """Rate that takes 3 % (hard to see) to 25 % (easy) over the whole recording."""
        return {"rate": s.part(0.25, 0.03) / s.duration_s}


class JointCrosstalk(HiddenKind):
    """A share of another joint's command is added to this joint's."""

    name = "joint_crosstalk"
    rank = 29
    quantities = (
        Quantity("source", "1", 0.0),
        Quantity("share", "1", -1.0, 1.0),
    )
    outside = True

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Add a share of the command of the joint whose column is `source`.

        Raises:
          BadValueError: the source is not the number of another joint.
        """
        source, joints = int(values["source"]), len(servos.kp_nm_rad)
        if not (0 <= source < joints and source != joint):
            raise BadValueError(f"joint_crosstalk: {source} is no other joint")
        servos.leaks.append((joint, source, values["share"]))

    def size(self, s: Setting) -> dict[str, float]:
        """A share of 1 % (hard to see) to 20 % (easy) of any other joint's command."""
        others = [i for i in range(len(s.plant.joints)) if i != s.joint]
        return {
            "source": float(s.rng.choice(others)),
            "share": s.sign * s.part(0.2, 0.01),
        }

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether the robot has another joint."""
        return len(plant.joints) > 1
