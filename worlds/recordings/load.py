"""A known load: a mass that a robot carried in a recording, and its model lacks."""

from dataclasses import dataclass

from groundwalk.errors import BadRecordingError
from groundwalk.json_data import is_number


@dataclass(frozen=True)
class Load:
    """A point mass that is fixed to a body of the robot.

    Raises:
      BadRecordingError: the mass is not above 0, or the place is not three numbers.

    Example:
      >>> Load(mass=1.0, at=(0.0, 0.0, -0.15)).mass
      1.0
    """

    mass: float
    """Its mass [kg], above 0."""
    at: tuple[float, float, float]
    """Where it is fixed: x, y, z [m] in the body's frame."""

    def __post_init__(self) -> None:
        """Check the values, and turn them into floats."""
        if not is_number(self.mass) or self.mass <= 0:
            raise BadRecordingError(
                f"the mass of a load must be a number above 0, not {self.mass!r}"
            )
        place = self.at if isinstance(self.at, tuple | list) else ()
        if len(place) != 3 or not all(map(is_number, place)):
            raise BadRecordingError(
                f"the place of a load must be three numbers (x, y, z), not {self.at!r}"
            )
        x, y, z = map(float, place)
        object.__setattr__(self, "mass", float(self.mass))
        object.__setattr__(self, "at", (x, y, z))
