"""Facts about a robot that its URDF lacks; each of them is optional."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from groundwalk.errors import BadModelError, BadValueError, UnknownNameError
from robots.from_urdf.package_paths import example_robots
from robots.leg_axes import ROLES

FORWARD = ("x", "-x", "y", "-y")


@dataclass(frozen=True)
class SoleBox:
    """A sole where the URDF has none, in the frame of the foot's joint, x forward.

    Attributes:
      height_m: of the sole; negative.
      x_m: from heel to toe.
      y_m: from the inner to the outer edge; positive is outward.
    """

    height_m: float
    x_m: tuple[float, float]
    y_m: tuple[float, float]

    def __post_init__(self) -> None:
        """Refuse boxes that are empty or do not lie below the ankle."""
        rises = self.x_m[0] < self.x_m[1] and self.y_m[0] < self.y_m[1]
        if not (self.height_m < 0 and rises):
            raise BadValueError(f"sole {self}: height_m < 0, x_m and y_m must rise")


@dataclass(frozen=True)
class Adaptation:
    """How a URDF becomes a robot that walks; missing parts follow from the URDF.

    Attributes:
      urdf: a file, or a URDF of example-robot-data, such as "g1_29dof_rev_1_0".
      forward: which way the robot faces in the root link's frame, one of `FORWARD`.
      left_leg, right_leg: the joints of the roles `ROLES`, in that order.
      moving: further joints with motors; those of legs and shoulders always have them.
      held: joints of legs or shoulders that are held still.
      pose_rad: angles of joints without motors; the angle next to zero by default.
      range_rad: lower and upper ends of joints, in place of the file's [rad].
      effort_nm: largest torques of motors, in place of the file's [N m].
      speed_rad_s: largest speeds of motors, in place of the file's [rad/s].
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
        """Every joint that the adaptation names."""
        named = {*self.left_leg, *self.right_leg, *self.moving, *self.held}
        tables = (self.pose_rad, self.range_rad, self.effort_nm, self.speed_rad_s)
        return named.union(*tables)


def read_adaptation(path: Path) -> Adaptation:
    """Read an adaptation from a TOML file whose keys are the attributes' names.

    Raises:
      BadModelError: the file cannot be read as an adaptation.
      UnknownNameError: it has a key that is no attribute.
    """
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
    """Find the URDF that an adaptation names.

    Args:
      name: a path, or a URDF of example-robot-data.
      folder: the folder from which a path is seen.

    Raises:
      UnknownNameError: there is neither such a file nor such an example.
    """
    path = folder / name
    if path.is_file():
        return path
    examples = example_robots()
    if name not in examples:
        raise UnknownNameError("URDF", name, examples)
    return examples[name]


def _tuples(value: Any) -> Any:
    """A value of a TOML file with tuples in place of lists."""
    if isinstance(value, dict):
        return {key: _tuples(item) for key, item in value.items()}
    return tuple(map(_tuples, value)) if isinstance(value, list) else value
