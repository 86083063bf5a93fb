"""Ground that gives under a foot: a spring and a damper, the same in both worlds.

Normal force of a flat foot K r + B r', with r how deep it sinks in (Kelvin-Voigt;
Gilardi and Sharf 2002, "Literature survey of contact dynamics modelling", section 4).
The points of a sole share a foot's K and B evenly. So a robot at rest on one level foot
sinks in by weight / K, and by half of that on two.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from groundwalk.gravity import GRAVITY_M_S2
from robots.description import Description
from robots.sole import contact_points

if TYPE_CHECKING:
    import mujoco

DAMPING_RATIO = 0.1
"""Of critical, for the whole robot on one foot."""

_ADDED_MASS = 0.25
"""Of the foot's own: what MuJoCo's contacts seem to weigh."""

_IMPEDANCE_RATIO = 100.0
"""A sticking foot creeps at tangential force / B; this slows it to a hundredth."""


@dataclass(frozen=True)
class FootSpring:
    """What the ground is to one whole foot.

    Attributes:
      stiffness_n_m: K.
      damping_n_s_m: B.
    """

    stiffness_n_m: float
    damping_n_s_m: float

    @classmethod
    def sinking(cls, description: Description, sinkage_m: float) -> "FootSpring":
        """The ground into which this robot sinks so deep when it stands on one foot."""
        mass_kg = description.mass_kg
        stiffness_n_m = mass_kg * GRAVITY_M_S2 / sinkage_m
        critical = 2 * math.sqrt(stiffness_n_m * mass_kg)
        return cls(stiffness_n_m, DAMPING_RATIO * critical)


def soften_mujoco(
    model: "mujoco.MjModel", description: Description, spring: FootSpring
) -> None:
    """Make the soles of a compiled model meet soft ground.

    A contact with solref (-k, -b) and constant impedance d solves
    a + b r' / d + k r / d + R f = 0, with R = A (1 - d) / d and A the foot's inverse
    mass in the reference pose (MuJoCo's documentation, "Constraint model"). At rest
    f = k r / (A (1 - d)), so that k = K A (1 - d) / n for a foot of n points.
    """
    import mujoco

    model.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    model.opt.impratio = _IMPEDANCE_RATIO
    for foot in description.feet:
        body = model.body(description.links[foot.joint].link.name).id
        own = (model.geom_bodyid == body) & (model.geom_contype == 1)
        points = int(own.sum())
        impedance = _ADDED_MASS / (points + _ADDED_MASS)
        scale = model.body_invweight0[body, 0] * (1 - impedance) / points
        model.geom_solref[own] = (
            -scale * spring.stiffness_n_m,
            -scale * spring.damping_n_s_m,
        )
        model.geom_solimp[own, :2] = impedance


def soften_bullet(
    bullet: Any,
    client: dict[str, int],
    body: int,
    description: Description,
    spring: FootSpring,
) -> None:
    """Make the soles of a loaded robot meet soft ground.

    Args:
      bullet: the module.
      client: names the physics client.
      body: the robot's number; its links are the joints in their order.
      description: the robot.
      spring: of a whole foot.
    """
    for foot in description.feet:
        points = len(contact_points(foot))
        bullet.changeDynamics(
            body,
            foot.joint,
            contactStiffness=spring.stiffness_n_m / points,
            contactDamping=spring.damping_n_s_m / points,
            **client,
        )
