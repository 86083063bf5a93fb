"""A world around a world."""

from groundwalk.arrays import BoolArray, FloatArray
from robots import Description
from worlds import End, Observation, Truth, World, WorldOptions


class WorldWrapper:
    """Passes everything on to the world inside; subclasses change what they must."""

    def __init__(self, world: World) -> None:
        """Remember the world inside."""
        self.world = world

    @property
    def description(self) -> Description:
        """The robot; all n are alike."""
        return self.world.description

    @property
    def n(self) -> int:
        """How many robots there are."""
        return self.world.n

    @property
    def options(self) -> WorldOptions:
        """How the world inside computes."""
        return self.world.options

    @property
    def ended(self) -> list[End]:
        """Why each robot's rollout ended."""
        return self.world.ended

    @property
    def active(self) -> BoolArray:
        """(n,) robots whose rollout goes on."""
        return self.world.active

    def reset(self, pose_rad: FloatArray) -> Observation:
        """Put every robot on its ground; see `World.reset`."""
        return self.world.reset(pose_rad)

    def step(self, command_rad: FloatArray) -> Observation:
        """Advance the active robots by one tick; see `World.step`."""
        return self.world.step(command_rad)

    def stop(self, robots: BoolArray) -> None:
        """Take robots out of the batch; see `World.stop`."""
        self.world.stop(robots)

    def truth(self) -> Truth:
        """Where the robots really are."""
        return self.world.truth()

    def close(self) -> None:
        """Give back what the world inside holds."""
        self.world.close()
