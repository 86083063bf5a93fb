"""The nominal model of a robot, as the diagnosis replays it."""

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

from diagnosis.plant.servo import Servo

if TYPE_CHECKING:
    import mujoco

Base = Literal["fixed", "floating"]
ROOT = "root"
_SLIDING = {
    "rad": "m",
    "rad/s": "m/s",
    "N m": "N",
    "N m/rad": "N/m",
    "N m s/rad": "N s/m",
    "kg m^2": "kg",
}


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
    """A MuJoCo model whose joints are driven by servos of one law.

    Attributes:
      name: of the robot, or the stem of its file.
      spec: has one affine actuator for each driven joint, named as the joint; its
        control is a position target. A floating base has the free joint `root`.
      joints: hinges and slides that traces speak of, in the model's order; all others
        are held still.
      servo: of these joints, where a trace does not say otherwise.
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
        """Degree of freedom of each joint."""
        return [int(self.model.joint(name).dofadr[0]) for name in self.joints]

    @cached_property
    def qpos(self) -> list[int]:
        """Row in the position vector of each joint."""
        return [int(self.model.joint(name).qposadr[0]) for name in self.joints]

    @cached_property
    def actuators(self) -> list[int]:
        """Actuator of each joint."""
        return [int(self.model.actuator(name).id) for name in self.joints]

    @cached_property
    def slides(self) -> frozenset[str]:
        """The joints that slide instead of turning."""
        import mujoco

        kinds = {name: int(self.model.joint(name).type[0]) for name in self.joints}
        slide = int(mujoco.mjtJoint.mjJNT_SLIDE)
        return frozenset(name for name, kind in kinds.items() if kind == slide)

    def unit(self, unit: str, place: str) -> str:
        """A unit at a place: of joints that slide it is metres where others turn.

        Args:
          unit: as it is where joints turn.
          place: a joint, or anything else.
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
        """The bodies that carry a body, and those that it carries."""
        model = self.model
        own = int(model.body(body).id)
        carried = [i for i in range(1, model.nbody) if _carries(model, own, i)]
        carrying = [i for i in range(1, model.nbody) if _carries(model, i, own)]
        return frozenset(model.body(i).name for i in (*carried, *carrying))

    def at_rest(self, still: Collection[str]) -> frozenset[str]:
        """The bodies that no joint moves as long as some of the joints are still."""
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
