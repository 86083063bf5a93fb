"""Types of position servos: stiffness, back-EMF, torque limit and rotor inertia."""

import math
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from groundwalk.errors import BadValueError, UnknownNameError
from groundwalk.json_data import from_plain

_FILE = Path(__file__).with_name("types.toml")
_NUMBER = r"[0-9]+(?:\.[0-9]+)?"
_FORM = re.compile(
    rf"(?P<type>[\w-]+)(?:@(?P<volts>{_NUMBER})[vV])?(?:,[pP]=(?P<p>{_NUMBER}))?"
)


@dataclass(frozen=True)
class ServoType:
    """A type of servo, whose duty cycle is proportional to its position error.

    At the supply U the motor's torque is kt / R (duty U - kt velocity), with a duty
    cycle of `duty_per_rad_p` times the position gain P for each radian of error. All
    constants are at the output of the gear. Values and sources are in
    `robots/servos/types.toml`.

    Attributes:
      name: of the type, such as "sts3215".
      volts: lowest and highest supply [V] for which the constants hold.
      usual_volts: supply [V] if none is given.
      usual_p: position gain P of the firmware, as delivered.
      duty_per_rad_p: duty cycle for each radian of error at P = 1.
      most_duty: largest duty cycle, up to 1.
      kt_nm_a: torque constant [N m/A].
      ohm: resistance of the winding.
      source: where the numbers come from.
      rotor_kg_m2: rotor inertia times the squared gear ratio; 0 if unknown.
    """

    name: str
    volts: tuple[float, float]
    usual_volts: float
    usual_p: float
    duty_per_rad_p: float
    most_duty: float
    kt_nm_a: float
    ohm: float
    source: str
    rotor_kg_m2: float = 0.0

    def __post_init__(self) -> None:
        """Refuse values that are not finite, or not above 0 where they must be."""
        for name, value in vars(self).items():
            least = 0.0 if name == "rotor_kg_m2" else math.nextafter(0.0, 1.0)
            if isinstance(value, float) and not least <= value < math.inf:
                raise BadValueError(f"{name} of {self.name} is {value}")

    def at(self, volts: float, p: float) -> "SuppliedServo":
        """The servo at a supply [V], with a position gain in the firmware's units."""
        per_volt = self.kt_nm_a / self.ohm
        return SuppliedServo(
            kp_nm_rad=self.duty_per_rad_p * p * volts * per_volt,
            back_emf_nm_s_rad=self.kt_nm_a * per_volt,
            max_torque_nm=self.most_duty * volts * per_volt,
            rotor_kg_m2=self.rotor_kg_m2,
        )


@dataclass(frozen=True)
class SuppliedServo:
    """A servo at its supply voltage: clip(kp error, +-max_torque) - back_emf velocity.

    Example:
      >>> servo_of("mx-64@12V").back_emf_nm_s_rad
      0.666...
    """

    kp_nm_rad: float
    back_emf_nm_s_rad: float
    max_torque_nm: float
    rotor_kg_m2: float


def servo_of(text: str) -> SuppliedServo:
    """The servo of a text such as "sts3215", "sts3215@7.4V" or "sts3215@12V,P=16".

    Raises:
      BadValueError: the text has another form, or the type has no such supply.
      UnknownNameError: there is no such type.

    Example:
      >>> round(servo_of("mx-64@12V").kp_nm_rad, 1)
      24.9
    """
    found = _FORM.fullmatch(text.strip())
    if found is None:
        raise BadValueError(
            f"servo {text!r} cannot be read: give a type, its supply and its position "
            "gain, such as sts3215@7.4V,P=16"
        )
    name = found["type"].lower()
    types = servo_types()
    if name not in types:
        raise UnknownNameError("servo", name, types)
    volts = float(found["volts"] or types[name][0].usual_volts)
    for one in types[name]:
        if one.volts[0] <= volts <= one.volts[1]:
            return one.at(volts, float(found["p"] or one.usual_p))
    ranges = " or ".join(f"{low:g} to {high:g}" for low, high in _supplies(name))
    raise BadValueError(f"servo {text!r}: the supply of {name} is {ranges} V")


def _supplies(name: str) -> list[tuple[float, float]]:
    return [one.volts for one in servo_types()[name]]


@cache
def servo_types() -> Mapping[str, tuple[ServoType, ...]]:
    """All types of servos by name, each with its variants for different supplies.

    Example:
      >>> servo_types()["mx-64"][0].kt_nm_a
      1.622
    """
    tables = tomllib.loads(_FILE.read_text())
    return {
        name: tuple(
            from_plain(ServoType, {"name": name, **one}, f"{_FILE.name}: {name}", False)
            for one in variants
        )
        for name, variants in tables.items()
    }
