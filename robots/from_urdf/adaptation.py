"""Facts about a robot that its URDF lacks, read from a TOML file; all are optional."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from groundwalk.errors import BadModelError, BadValueError, UnknownNameError
from robots.from_urdf.mesh_files import example_robots
from robots.leg_geometry import ROLES

FORWARD = ("x", "-x", "y", "-y")


@dataclass(frozen=True)
class SoleBox:
    """A rectangular sole for a foot whose URDF has none.

    Coordinates are in the frame of the leg's last joint, x forward, z up: z of the
    sole, negative; x of heel and toe; y of the inner and the outer edge, positive
    outward.
    """

    height_m: float
    x_m: tuple[float, float]
    y_m: tuple[float, float]

    def __post_init__(self) -> None:
        """Refuse soles that have no area or do not lie below the ankle."""
        rises = self.x_m[0] < self.x_m[1] and self.y_m[0] < self.y_m[1]
        if not (self.height_m < 0 and rises):
            raise BadValueError(f"sole {self}: height_m < 0, x_m and y_m must rise")


@dataclass(frozen=True)
class Adaptation:
    """How a URDF becomes a walking robot; what is left out follows from the URDF.

    Attributes:
      urdf: a file, or the name of a URDF in the Python package example-robot-data, such
        as "g1_29dof_rev_1_0".
      forward: direction in which the robot faces in the root link's frame: "x", "-x",
        "y" or "-y".
      left_leg, right_leg: names of the leg's six joints: yaw, roll, pitch, knee, ankle
        pitch, ankle roll.
      moving: further joints with motors; those of legs and shoulders always have them.
      held: joints of legs or shoulders that are held still.
      pose_rad: angles [rad] of joints without motors, by name; by default the angle of
        the joint's range that is nearest to zero.
      range_rad: lower and upper ends of joints [rad], in place of the URDF's.
      effort_nm: largest torques of motors [N m], in place of the URDF's.
      speed_rad_s: largest speeds of motors [rad/s], in place of the URDF's.
      sole: the left sole; the right one is its mirror image.
    """

    urdf: str
    forward: str | None = None
    left_leg: tuple[str, ...] = ()
    right_leg: tuple[str, ...] = ()
    moving: tuple[str, ...] = ()
    held: tuple[str, ...] = ()
    pose_rad: Mapping[str, float] = field(default_factory=dict)
    range_rad: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    effort_nm: Mapping[str, float] = field(default_factory=dict)
    speed_rad_s: Mapping[str, float] = field(default_factory=dict)
    sole: SoleBox | None = None

    def __post_init__(self) -> None:
        """Refuse unknown directions and legs without exactly six joints."""
        if self.forward is not None and self.forward not in FORWARD:
            raise UnknownNameError("direction", self.forward, FORWARD)
        for leg in (self.left_leg, self.right_leg):
            if leg and len(leg) != len(ROLES):
                raise BadValueError(
                    f"a leg names {len(leg)} joints {leg}; it needs {', '.join(ROLES)}"
                )
        if bool(self.left_leg) != bool(self.right_leg):
            raise BadValueError("name the joints of both legs, or of none")

    def joints(self) -> set[str]:
        """Names of all joints that the adaptation mentions."""
        named = {*self.left_leg, *self.right_leg, *self.moving, *self.held}
        tables = (self.pose_rad, self.range_rad, self.effort_nm, self.speed_rad_s)
        return named.union(*tables)


def read_adaptation(path: Path) -> Adaptation:
    """Read an `Adaptation` from a TOML file; keys are the names of its attributes."""
    try:
        table = tomllib.loads(path.read_text())
        names = [one.name for one in fields(Adaptation)]
        for key in table:
            if key not in names:
                raise UnknownNameError(f"key in {path}", key, names)
        if "sole" in table:
            table["sole"] = SoleBox(**_tuples(table["sole"]))
        return Adaptation(**_tuples(table))
    except (OSError, TypeError, tomllib.TOMLDecodeError) as error:
        raise BadModelError(f"{path} is no robot: {error}") from error


def urdf_path(name: str, folder: Path) -> Path:
    """Find a URDF: a path in `folder`, or the name of one in example-robot-data."""
    path = folder / name
    if path.is_file():
        return path
    examples = example_robots()
    if name not in examples:
        raise UnknownNameError("URDF", name, examples)
    return examples[name]


def _tuples(value: Any) -> Any:
    """Copy a value of a TOML file with all lists turned into tuples."""
    if isinstance(value, dict):
        return {key: _tuples(item) for key, item in value.items()}
    return tuple(map(_tuples, value)) if isinstance(value, list) else value
