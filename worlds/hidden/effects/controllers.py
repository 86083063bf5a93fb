"""Hidden physics of a servo's controller: an integral term, a dead band."""

from worlds.hidden.effects.kind import HiddenKind, Quantity, Values
from worlds.hidden.servos import Servos
from worlds.hidden.setting import Setting


class IntegralTerm(HiddenKind):
    """The servo's controller also integrates its error.

    Its torque is kp (e + int e dt / time) - kd v for the error e, the integral's part
    limited by the servo's largest torque. Integral times of drives are 0.05 to some
    seconds (Astrom and Hagglund 1995, "PID controllers: theory, design, and tuning",
    sections 3.2 and 3.5).
    """

    name = "integral_term"
    rank = 31
    since = 2
    quantities = (Quantity("time", "s", 0.001),)
    outside = True
    sizes = (0.1, 10.0)

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Let the servo integrate its error, with the integral time [s]."""
        servos.integral_1_s[joint] += 1.0 / values["time"]


class DeadBand(HiddenKind):
    """The servo's stiffness does nothing while its error is small.

    Its torque is kp e - kd v where |e| is at least the width, else -kd v. Bus servos
    have such a band against chatter, of 1 to 32 steps of 1.5 mrad (Feetech, "STS series
    memory table", addresses 26 and 27).
    """

    name = "dead_band"
    rank = 32
    since = 2
    quantities = (Quantity("width", "rad", 0.0, 1.0),)
    outside = True

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Give the servo a dead band of this half width [rad]."""
        band = servos.dead_band_rad
        band[joint] = max(band[joint], values["width"])

    def size(self, s: Setting) -> dict[str, float]:
        """Width of 0.03 (hard to detect) to 0.6 (easy) of what the servo needs.

        That is the error at its usual torque; a wider band would let the joint drop.
        """
        error = s.torque_nm / float(s.plant.kp_nm_rad[s.joint])
        return {"width": s.part(0.6, 0.03) * error}
