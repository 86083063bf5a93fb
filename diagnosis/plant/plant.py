"""The nominal robot model (the plant) that the diagnosis replays."""

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

from diagnosis.plant.servo import Servo

if TYPE_CHECKING:
    import mujoco

Base = Literal["fixed", "floating"]
"""How a robot's base is held."""
ROOT = "root"
"""Name of a floating base's free joint."""
_SLIDING = {
    "rad": "m",
    "rad/s": "m/s",
    "N m": "N",
    "N m/rad": "N/m",
    "N m s/rad": "N s/m",
    "kg m^2": "kg",
}
"""Units of sliding joints by those of turning joints."""


@dataclass(frozen=True)
class ModelOptions:
    """Options of a model file that replays replace by their own.

    Attributes:
      timestep_s: of the physics.
      integrator: MuJoCo's number of it.
      disableflags: MuJoCo's bits of what is switched off, such as contacts.
    """

    timestep_s: float
    integrator: int
    disableflags: int

    @classmethod
    def of(cls, spec: "mujoco.MjSpec") -> "ModelOptions":
        """The options that a specification has."""
        option = spec.option
        return cls(option.timestep, int(option.integrator), int(option.disableflags))


@dataclass(frozen=True, eq=False)
class Plant:
    """A nominal robot model whose joints are driven by servos.

    Attributes:
      name: name of the robot, or the stem of its file.
      spec: MuJoCo specification with one affine actuator for each driven joint, named
        as the joint; its control is a position target. A floating base has the free
        joint `root`.
      joints: hinges and slides that recordings have, in the model's order; all other
        joints are held still.
      servo: servos of these joints, for recordings that state no gains.
      base: "fixed" or "floating".
      feet: names of the bodies that touch the ground, left before right.
      options: of the file that the model was read from; None if the file has none, as
        a URDF.

    Example:
      >>> load_plant("nao", base="floating").joints
    """

    name: str
    spec: "mujoco.MjSpec"
    joints: tuple[str, ...]
    servo: Servo
    base: Base = "fixed"
    feet: tuple[str, ...] = ()
    options: ModelOptions | None = None

    @cached_property
    def model(self) -> "mujoco.MjModel":
        """The compiled model; do not change it."""
        return self.spec.compile()

    @cached_property
    def dofs(self) -> list[int]:
        """Index of each joint in MuJoCo's velocity vector."""
        return [int(self.model.joint(name).dofadr[0]) for name in self.joints]

    @cached_property
    def qpos(self) -> list[int]:
        """Index of each joint in MuJoCo's position vector."""
        return [int(self.model.joint(name).qposadr[0]) for name in self.joints]

    @cached_property
    def actuators(self) -> list[int]:
        """Index of each joint's actuator."""
        return [int(self.model.actuator(name).id) for name in self.joints]

    @cached_property
    def slides(self) -> frozenset[str]:
        """Names of the joints that slide instead of turning."""
        import mujoco

        kinds = {name: int(self.model.joint(name).type[0]) for name in self.joints}
        slide = int(mujoco.mjtJoint.mjJNT_SLIDE)
        return frozenset(name for name, kind in kinds.items() if kind == slide)

    def unit(self, unit: str, place: str) -> str:
        """The unit of a quantity at a place; sliding joints have metres and newtons.

        Args:
          unit: the unit for a joint that turns, such as "N m/rad".
          place: name of a joint, or any other place, which keeps the unit.
        """
        return _SLIDING.get(unit, unit) if place in self.slides else unit

    @cached_property
    def bodies(self) -> tuple[str, ...]:
        """Names of the bodies that have mass and move."""
        model = self.model
        return tuple(
            model.body(i).name
            for i in range(1, model.nbody)
            if model.body_mass[i] > 0 and model.body_weldid[i] > 0
        )

    def neighbours(self, body: str) -> frozenset[str]:
        """Names of the bodies that carry a body, and of those that it carries."""
        model = self.model
        own = int(model.body(body).id)
        carried = [i for i in range(1, model.nbody) if _carries(model, own, i)]
        carrying = [i for i in range(1, model.nbody) if _carries(model, i, own)]
        return frozenset(model.body(i).name for i in (*carried, *carrying))

    def at_rest(self, still: Collection[str]) -> frozenset[str]:
        """Names of the bodies that stay at rest as long as the `still` joints do."""
        if self.base == "floating":
            return frozenset()
        moved = [
            int(self.model.joint(name).bodyid[0])
            for name in self.joints
            if name not in still
        ]
        return frozenset(
            name
            for name in self.bodies
            for body in [int(self.model.body(name).id)]
            if not any(one == body or _carries(self.model, one, body) for one in moved)
        )


def _carries(model: "mujoco.MjModel", body: int, other: int) -> bool:
    """Whether a body is between another one and the world."""
    while other > 0:
        other = int(model.body_parentid[other])
        if other == body:
            return True
    return False
