"""The base class of all kinds of hidden physics, and types that they use."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.gravity import GRAVITY_M_S2
from robots.description import Description
from terrain import Heightfield, Lumps
from worlds.hidden.plant import RIGID_NM_RAD, HiddenPlant
from worlds.hidden.servos import Servos, Transmission
from worlds.hidden.setting import Scales, Setting, Spot
from worlds.soft_ground import FootSpring

_HALF_SIDE_M = 3.0
"""Half the side of the square ground [m]; walks of 6 s stay well within it."""
_BUMP_WAVELENGTH_M = 0.2
"""Shortest wavelength of bumps [m]: about the length of a NAO's foot."""
_BUMP_BLEND_M = 0.05


@dataclass(eq=False)
class Surroundings:
    """Signal delays, gyroscope bias, supply and ground; all zero without effects.

    Commands reach the servos, and encoders are read, with a delay; the gyroscope's bias
    (3,) is in the base's frame. The servos' supply loses `sag_share` of its voltage at
    full load. The ground, or a fixed base's mount, dips towards the
    front (x) by the pitch and rises towards the left (y) by the roll. `bumps_m` is the
    height of bumps under a floating robot, `friction` that of its soles; None for the
    nominal one.
    """

    command_delay_s: float = 0.0
    encoder_delay_s: float = 0.0
    gyroscope_bias_rad_s: FloatArray = field(default_factory=lambda: np.zeros(3))
    sag_share: float = 0.0
    pitch_rad: float = 0.0
    roll_rad: float = 0.0
    bumps_m: float = 0.0
    friction: float | None = None

    def tilt(self) -> FloatArray:
        """(3, 3) rotation R_y(pitch) R_x(roll) from the ground's frame to upright."""
        cos, sin = math.cos(self.pitch_rad), math.sin(self.pitch_rad)
        about_y = np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
        cos, sin = math.cos(self.roll_rad), math.sin(self.roll_rad)
        about_x = np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])
        return np.asarray(about_y @ about_x)

    def gravity_m_s2(self) -> FloatArray:
        """(3,) gravity [m/s^2] in the frame of the tilted ground or mount."""
        return np.asarray(self.tilt().T @ np.array([0, 0, -GRAVITY_M_S2]))

    def ground(self, seed: np.random.SeedSequence) -> Heightfield:
        """The ground under a floating robot: a plane, or random bumps everywhere."""
        low, high = -_HALF_SIDE_M, _HALF_SIDE_M
        if self.bumps_m == 0:
            return Heightfield(np.zeros((2, 2)), (low, low), high - low)
        lumps = Lumps(
            amplitude_m=self.bumps_m,
            wavelength_m=_BUMP_WAVELENGTH_M,
            x_range_m=(low, high),
            y_range_m=(low, high),
            start_radius_m=0.0,
            blend_m=_BUMP_BLEND_M,
        )
        return lumps.make(seed)


Values = Mapping[str, float]
"""Values of an effect's parameters by name, in SI units."""

JointTorque = Callable[[float, float, float, float], float]
"""Law of a torque: from time in the recording [s], joint angle [rad], joint speed
[rad/s] and servo torque [N m] to the torque [N m] on the joint in the next step."""

Push = Callable[[float, Callable[[], FloatArray]], FloatArray | None]
"""Law of a force: from time in the recording [s] and a function that returns the body's
velocity (3,) [m/s] to the force (3,) [N] in the next step, or None for no force."""

_MOST = 0.15
"""Largest stiffness of a contact in units of inertia / step^2. Semi-implicit Euler is
stable up to 4; this is far below, so that the contact's motion is resolved, too."""


@dataclass(frozen=True)
class Quantity:
    """One parameter of a kind of hidden physics, `name` in the text of an effect.

    The unit of a plain number is "1". Values outside of the range from `low` to `high`
    are refused; without a default a value must be given.
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
    """Limits the stiffness of a contact at a joint to what the time step can resolve.

    The inertia is that seen by a torque at the joint, with all other joints free;
    surfaces that stick and gear teeth that touch have the stiffness `rigid_nm_rad`.
    `links_nm` tells the torque [N m] that gravity and the links' motion, accelerations
    left out, put on the joint at present. `middle_rad` is the middle of its range.
    """

    inertia_kg_m2: float
    step_s: float
    rigid_nm_rad: float = RIGID_NM_RAD
    links_nm: Callable[[], float] = float
    middle_rad: float = 0.0

    def stiffness_nm_rad(self, wanted_nm_rad: float) -> float:
        """The wanted stiffness, or the largest that the time step can resolve."""
        return min(wanted_nm_rad, _MOST * self.inertia_kg_m2 / self.step_s**2)

    def damping_nm_s_rad(self, stiffness_nm_rad: float) -> float:
        """Critical damping of a contact at the joint with this stiffness."""
        return 2 * math.sqrt(stiffness_nm_rad * self.inertia_kg_m2)


class HiddenKind:
    """One kind of hidden physics that can be added to a nominal robot.

    Methods for physics add nothing by default; a subclass overrides some of them. Other
    methods and attributes serve to draw test cases with unknown effects at random.

    Attributes:
      name: the `name` in an effect's text `name@place:parameter=value`.
      rank: position in the list from which cases are drawn; last by default. It is
        fixed: a change, and a new kind, would draw other cases from the same seed.
      place: "joint", "body", or the one word that is this kind's only place.
      quantities: its parameters.
      outside: whether the diagnosis had no effect of this name when sets 1 to 4 of
        concealed cases were drawn; their truth stays, though it may have one by now.
      engines: names of the physics engines that can simulate it.
      needs_motion: whether it shows only at joints that move.
      since: the first set of concealed cases that may have it.
      in_torques: whether positions and measured torques show it, so that the commands
        need not be known.
      fixed_base_only: whether only robots on a fixed base can have it.
      stiff: whether it adds a spring that long physics steps could make unstable.
      apart: kinds that are never drawn into the same case, if `cancels` says so.
      sizes: value of the only parameter for an effect that is easy to detect, and for
        one that is hard; kinds with more parameters override `size`.
    """

    name: ClassVar[str]
    rank: ClassVar[int] = 1000
    place: ClassVar[str] = "joint"
    quantities: ClassVar[tuple[Quantity, ...]]
    outside: ClassVar[bool] = False
    engines: ClassVar[tuple[str, ...]] = ("bullet", "mujoco")
    needs_motion: ClassVar[bool] = False
    since: ClassVar[int] = 1
    in_torques: ClassVar[bool] = False
    fixed_base_only: ClassVar[bool] = False
    stiff: ClassVar[bool] = False
    apart: ClassVar[tuple[str, ...]] = ()
    sizes: ClassVar[tuple[float, float]]

    @property
    def parameters(self) -> dict[str, Quantity]:
        """The kind's parameters by name."""
        return {quantity.name: quantity for quantity in self.quantities}

    # Physics

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Change gains, limits or faults of the servo of joint number `joint`."""

    def torque(self, values: Values, contact: StiffContact) -> JointTorque | None:
        """Law of an extra torque at the joint; None if this kind adds none."""
        return None

    def transmission(
        self, values: Values, contact: StiffContact
    ) -> Transmission | None:
        """Spring or play in place of the joint's rigid gear; None to keep it rigid."""
        return None

    def change_part(self, part: Any, values: Values) -> None:
        """Change the `mujoco.MjsJoint` or `MjsBody` at the effect's place."""

    def foot_spring(self, values: Values, robot: Description) -> FootSpring | None:
        """Soft ground under each foot of a robot; None for hard ground."""
        return None

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Change signal delays, the gyroscope's bias, the supply or the ground."""

    def push(self, values: Values) -> Push | None:
        """Law of a force at a body's centre of mass; None if this kind adds none."""
        return None

    def misread(
        self,
        values: Values,
        time_s: FloatArray,
        angle_rad: FloatArray,
        rng: np.random.Generator,
    ) -> FloatArray:
        """(rows,) angles as they are written down, unchanged by default.

        They follow from those that a joint's encoder read at times (rows,).
        """
        return angle_rad

    # Size and place in concealed cases

    def size(self, s: Setting) -> dict[str, float]:
        """Parameter values of an effect that is as easy to detect as `s.ease` says."""
        return {self.quantities[0].name: s.part(*self.sizes)}

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether a robot can have this effect and can tell it from all others."""
        return True

    def shows(self, plant: HiddenPlant, scales: Scales, spot: Spot) -> bool:
        """Whether the motion shows this effect at a spot and no other effect alike."""
        return True

    def cancels(self, plant: HiddenPlant) -> bool:
        """Whether the robot's motion cannot tell this kind from those in `apart`."""
        return True

    def spots(
        self, plant: HiddenPlant, scales: Scales, joints: Sequence[int]
    ) -> list[Spot]:
        """Spots at any of these joints where a test case may have this effect."""
        if not self.possible(plant):
            return []
        found = [Spot(joint, plant.links[joint]) for joint in joints]
        if self.place == "body" and plant.floating and plant.description is not None:
            trunk = plant.description.root.name
            found += [Spot(joint, trunk) for joint in joints]
        return [spot for spot in found if self.shows(plant, scales, spot)]
