"""Physics that a hidden world can have and its nominal model lacks: names and numbers.

The words are those of the diagnosis, the physics behind them is written here a second
time (`worlds.hidden.joints`, `worlds.hidden.friction`, `worlds.hidden.transmission`,
`worlds.hidden.model`, `worlds.hidden.drive`), so that whoever looks for it does not
look into a mirror.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from groundwalk.errors import BadValueError, UnknownNameError


@dataclass(frozen=True)
class HiddenKind:
    """What an effect needs to be told.

    Attributes:
      place: "joint", "body", or the one word that is its only place.
      parameters: unit by name.
      optional: parameters with a value that stands when they are not given.
      outside: whether a diagnosis does not know it.
    """

    place: str
    parameters: Mapping[str, str]
    optional: Mapping[str, float]
    outside: bool = False


def _kind(place: str, **parameters: str) -> HiddenKind:
    return HiddenKind(place, parameters, {})


def _strange(**parameters: str) -> HiddenKind:
    return HiddenKind("joint", parameters, {}, outside=True)


_XYZ_M = {"x": "m", "y": "m", "z": "m"}
_PUSH = {"x": "N", "y": "N", "z": "N", "start": "s", "duration": "s"}

KINDS: Mapping[str, HiddenKind] = {
    "viscous_friction": _kind("joint", coefficient="N m s/rad"),
    "coulomb_friction": _kind("joint", torque="N m"),
    "stribeck_friction": _kind(
        "joint", coulomb_torque="N m", extra_torque="N m", speed="rad/s"
    ),
    "load_friction": _kind("joint", share="1"),
    "backlash": _kind("joint", gap="rad"),
    "joint_elasticity": _kind("joint", stiffness="N m/rad", damping="N m s/rad"),
    "command_latency": _kind("commands", delay="s"),
    "sensor_delay": _kind("encoders", delay="s"),
    "encoder_offset": _kind("joint", offset="rad"),
    "gyro_bias": _kind("gyroscope", x="rad/s", y="rad/s", z="rad/s"),
    "torque_limit": _kind("joint", torque="N m"),
    "speed_limit": _kind("joint", speed="rad/s"),
    "servo_gain": _kind("joint", factor="1"),
    "servo_damping": _kind("joint", factor="1"),
    "armature": _kind("joint", inertia="kg m^2"),
    "payload_mass": _kind("body", mass="kg"),
    "com_offset": _kind("body", **_XYZ_M),
    "joint_spring": _kind("joint", stiffness="N m/rad", rest="rad"),
    "end_stop": _kind("joint", angle="rad", side="1"),
    "servo_fade": _kind("joint", rate="1/s"),
    "contact_friction": _kind("feet", coefficient="1"),
    "contact_compliance": HiddenKind(
        "feet", {"stiffness": "N/m", "damping": "N s/m"}, {"damping": math.nan}
    ),
    "ground_slope": _kind("world", pitch="rad", roll="rad"),
    "uneven_ground": _kind("world", height="m"),
    "external_force": _kind("body", **_PUSH),
    "drag": _kind("body", coefficient="N s/m"),
    "lugre_hysteresis": _strange(torque="N m", stiffness="N m/rad"),
    "cogging": _strange(torque="N m", per_turn="1", phase="rad"),
    "joint_crosstalk": _strange(source="1", share="1"),
    "periodic_torque": _strange(torque="N m", frequency="Hz", phase="rad"),
}
"""By name. The last four are for cases that no diagnosis has a word for."""


@dataclass(frozen=True)
class Hidden:
    """One effect at its place.

    Attributes:
      name: one of `KINDS`.
      place: a joint, a body, or the kind's only place.
      parameters: values in SI units by name.
    """

    name: str
    place: str
    parameters: Mapping[str, float]

    def __post_init__(self) -> None:
        """Refuse unknown names, and parameters that are missing or no numbers."""
        if self.name not in KINDS:
            raise UnknownNameError("effect", self.name, KINDS)
        kind = KINDS[self.name]
        for name in self.parameters:
            if name not in kind.parameters:
                raise UnknownNameError(
                    f"parameter of {self.name}", name, kind.parameters
                )
        for name in kind.parameters:
            if name not in self.parameters and name not in kind.optional:
                raise BadValueError(f"{self.name} needs a value of {name}")
        for name, value in self.parameters.items():
            if not math.isfinite(value):
                raise BadValueError(f"{self.name}: {name} is {value}")
        if kind.place not in ("joint", "body") and self.place != kind.place:
            raise BadValueError(
                f"{self.name} belongs to {kind.place!r}, not to {self.place!r}"
            )

    def __getitem__(self, parameter: str) -> float:
        """Value of a parameter."""
        if parameter in self.parameters:
            return float(self.parameters[parameter])
        return KINDS[self.name].optional[parameter]

    def to_text(self) -> str:
        """`name@place:parameter=value,...`, which `parse` reads."""
        values = ",".join(f"{key}={value:g}" for key, value in self.parameters.items())
        return f"{self.name}@{self.place}:{values}"

    @classmethod
    def parse(cls, text: str) -> "Hidden":
        """Read `name@place:parameter=value,...`.

        Raises:
          GroundwalkError: the text is not of this form, or names what is not there.
        """
        head, _, tail = text.partition(":")
        name, at, place = head.partition("@")
        if name not in KINDS:
            raise UnknownNameError("effect", name, KINDS)
        if not at and KINDS[name].place in ("joint", "body"):
            raise BadValueError(
                f"{text}: say where, as in {name}@PLACE:parameter=value"
            )
        values = {}
        for item in filter(None, tail.split(",")):
            key, _, number = item.partition("=")
            try:
                values[key] = float(number)
            except ValueError:
                raise BadValueError(
                    f"{text}: {item!r} must be parameter=number"
                ) from None
        return cls(name, place or KINDS[name].place, values)
