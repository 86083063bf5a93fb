"""Base class of worlds that wrap another world."""

from groundwalk.arrays import BoolArray, FloatArray
from robots import Description
from worlds import End, Observation, Truth, World, WorldOptions


class WorldWrapper:
    """A world that passes every call on to the world inside; subclasses change some.

    Example:
      See `GroundedWorld`.
    """

    def __init__(self, world: World) -> None:
        """Choose the world inside."""
        self.world = world

    @property
    def description(self) -> Description:
        """The robot; all n are alike."""
        return self.world.description

    @property
    def n(self) -> int:
        """Number of robots."""
        return self.world.n

    @property
    def options(self) -> WorldOptions:
        """Options of the world inside."""
        return self.world.options

    @property
    def ended(self) -> list[End]:
        """Why each robot's rollout ended."""
        return self.world.ended

    @property
    def active(self) -> BoolArray:
        """(n,) whether each robot's rollout continues."""
        return self.world.active

    def reset(self, pose_rad: FloatArray) -> Observation:
        """Put every robot on its ground, in poses (n, joints) [rad]."""
        return self.world.reset(pose_rad)

    def step(self, command_rad: FloatArray) -> Observation:
        """Advance the active robots by one tick with commands (n, joints) [rad]."""
        return self.world.step(command_rad)

    def stop(self, robots: BoolArray) -> None:
        """End the rollouts of the robots in a mask (n,)."""
        self.world.stop(robots)

    def truth(self) -> Truth:
        """True poses, velocities and contacts of the robots, which no gait sees."""
        return self.world.truth()

    def close(self) -> None:
        """Release the resources of the world inside."""
        self.world.close()
