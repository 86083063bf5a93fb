"""The base class of all kinds of hidden physics, and the types of their parts."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from groundwalk.arrays import FloatArray
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.servos import Servos
from worlds.hidden.setting import Scales, Setting, Spot
from worlds.hidden.surroundings import Surroundings
from worlds.hidden.transmission import Transmission
from worlds.soft_ground import FootSpring

Values = Mapping[str, float]
"""Value of each parameter by its name, in SI units."""

JointTorque = Callable[[float, float, float, float], float]
"""Torque [N m] on a joint for the next step, from time [s], angle [rad], speed [rad/s]
and the servo's torque [N m]."""

Push = Callable[[float, Callable[[], FloatArray]], FloatArray | None]
"""Force (3,) [N] on a body for the next step, or None, from the recording's time [s]
and a function that returns the body's velocity (3,) [m/s]."""

_MOST = 0.15
"""Largest stiffness of a contact in units of inertia / step^2. A semi-implicit step is
stable up to 4; this is far below, so that the contact's motion is resolved, too."""
_DAMPING_RATIO = 1.0
"""Contacts are critically damped, so that they do not ring."""
_LAST = 1000
"""Rank of a kind that states none: after all others."""


@dataclass(frozen=True)
class Quantity:
    """One parameter of a kind of hidden physics: its name, unit and sensible range.

    Attributes:
      name: as in `name@place:parameter=value`.
      unit: such as "N m"; "1" for a plain number.
      low, high: sensible range; values outside of it are refused.
      default: value where none is given; None if one must be given.
    """

    name: str
    unit: str
    low: float = -math.inf
    high: float = math.inf
    default: float | None = None

    @property
    def range_text(self) -> str:
        """The sensible range in words, such as "0 to 0.5"."""
        if math.isinf(self.low):
            return "any"
        if math.isinf(self.high):
            return f"{self.low:g} or more"
        return f"{self.low:g} to {self.high:g}"


@dataclass(frozen=True)
class StiffContact:
    """How stiff a contact at a joint can be made so that time steps can follow it.

    Attributes:
      inertia_kg_m2: least inertia that a torque at the joint moves.
      step_s: time step.
    """

    inertia_kg_m2: float
    step_s: float

    def stiffness_nm_rad(self, wanted_nm_rad: float) -> float:
        """The wanted stiffness, or the largest that the time step can follow."""
        return min(wanted_nm_rad, _MOST * self.inertia_kg_m2 / self.step_s**2)

    def damping_nm_s_rad(self, stiffness_nm_rad: float) -> float:
        """Critical damping of a contact of this stiffness."""
        return 2 * _DAMPING_RATIO * math.sqrt(stiffness_nm_rad * self.inertia_kg_m2)


class HiddenKind:
    """One kind of hidden physics: its parameters, physics, size and place.

    The methods change nothing by default; a subclass overrides some of them.

    Attributes:
      name: as in `name@place:parameter=value`.
      rank: position in the list from which concealed cases draw. The ranks of existing
        kinds are fixed: a change would draw other cases from the same seed.
      place: "joint", "body", or the one word that is this kind's only place.
      quantities: its parameters.
      outside: whether the diagnosis has no effect of this name.
      engines: that can compute it.
      needs_motion: whether a joint shows it only while the joint moves.
      apart: kinds that are never drawn into the same case, if `cancels` says so.
      sizes: the only parameter of an effect that is easy and of one that is hard to
        see in concealed cases; kinds whose size depends on more override `size`.

    Example:
      >>> from worlds.hidden import KINDS
      >>> KINDS["backlash"].sizes
      (0.06, 0.003)
    """

    name: ClassVar[str]
    rank: ClassVar[int] = _LAST
    place: ClassVar[str] = "joint"
    quantities: ClassVar[tuple[Quantity, ...]]
    outside: ClassVar[bool] = False
    engines: ClassVar[tuple[str, ...]] = ("bullet", "mujoco")
    needs_motion: ClassVar[bool] = False
    apart: ClassVar[tuple[str, ...]] = ()
    sizes: ClassVar[tuple[float, float]]

    @property
    def parameters(self) -> dict[str, Quantity]:
        """The parameters by name."""
        return {quantity.name: quantity for quantity in self.quantities}

    # Physics

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Change numbers of the servo of a joint, given by its column."""

    def torque(self, values: Values, contact: StiffContact) -> JointTorque | None:
        """Law of a torque at the joint besides the servo's; None if there is none."""
        return None

    def transmission(
        self, values: Values, contact: StiffContact
    ) -> Transmission | None:
        """What replaces the rigid gear between motor and joint; None if nothing."""
        return None

    def change_part(self, part: Any, values: Values) -> None:
        """Change the `mujoco.MjsJoint` or `MjsBody` at the effect's place."""

    def sole_friction(self, values: Values) -> float | None:
        """Friction coefficient between soles and ground; None leaves it unchanged."""
        return None

    def foot_spring(self, values: Values, mass_kg: float) -> FootSpring | None:
        """Soft ground under each foot of a robot of this mass; None for hard ground."""
        return None

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Change the signals' delays and biases, or the ground."""

    def push(self, values: Values) -> Push | None:
        """Law of a force at a body's centre of mass; None if there is none."""
        return None

    # Size and place in concealed cases

    def size(self, s: Setting) -> dict[str, float]:
        """Parameters of an effect that is as easy to see as the setting says."""
        return {self.quantities[0].name: s.part(*self.sizes)}

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether the robot can have this effect and distinguish it from all others."""
        return True

    def shows(self, plant: HiddenPlant, scales: Scales, spot: Spot) -> bool:
        """Whether the motion shows this effect at a spot, unlike all other effects."""
        return True

    def cancels(self, plant: HiddenPlant) -> bool:
        """Whether a robot cannot distinguish this kind from those in `apart`."""
        return True

    def spots(
        self, plant: HiddenPlant, scales: Scales, joints: Sequence[int]
    ) -> list[Spot]:
        """Where a concealed case may have this effect; empty if nowhere.

        Args:
          plant: the robot.
          scales: of the robot's motion with nothing hidden.
          joints: columns of the joints that may be chosen.
        """
        if not self.possible(plant):
            return []
        found = [Spot(joint, plant.links[joint]) for joint in joints]
        if self.place == "body" and plant.floating and plant.description is not None:
            trunk = plant.description.root.name
            found += [Spot(joint, trunk) for joint in joints]
        return [spot for spot in found if self.shows(plant, scales, spot)]
