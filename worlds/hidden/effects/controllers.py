"""Hidden physics of a servo's controller: integral, dead band, derivative of errors."""

from groundwalk.errors import BadValueError
from worlds.hidden.effects.kind import HiddenKind, Quantity, Values
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.servos import Servos
from worlds.hidden.setting import Scales, Setting, Spot


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


class ErrorDerivative(HiddenKind):
    """The servo's damping acts on the rate of its error, in part or fully.

    Its torque is kp e + kd (share dc/dt - v) with the target's rate dc/dt, which a lag
    of kd / (10 kp) smooths: the derivative of textbooks' controllers has such a filter,
    and a weight for the set-point (Astrom and Hagglund 2006, "Advanced PID control",
    chapter 3).
    """

    name = "error_derivative"
    since = 5
    quantities = (Quantity("share", "1", 0.0, 1.0),)
    needs_motion = True
    sizes = (1.0, 0.05)

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Let the servo's damping take a share of the target's rate.

        Raises:
          BadValueError: the servo has no damping of its own.
        """
        if not servos.kd_nm_s_rad[joint] > 0:
            raise BadValueError(
                "error_derivative: this joint's servo has no damping of its own (kd is "
                "0, all damping is back-EMF); choose a joint whose servo has some"
            )
        servos.target_rate_share[joint] += values["share"]

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether some servo has damping of its own, which is no back-EMF."""
        return bool(plant.kd_nm_s_rad.any())

    def shows(self, plant: HiddenPlant, scales: Scales, spot: Spot) -> bool:
        """Whether this joint's servo has damping of its own."""
        return bool(plant.kd_nm_s_rad[spot.joint] > 0)
