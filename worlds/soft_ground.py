"""Soft ground: a spring and a damper under each foot, the same in both worlds.

A flat foot that has sunk in by r feels the normal force K r + B r' (Kelvin-Voigt;
Gilardi and Sharf 2002, "Literature survey of contact dynamics modelling", section 4).
The points of a sole share a foot's K and B evenly. A robot at rest on one level foot
sinks in by weight / K, and by half of that on two.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from groundwalk.gravity import GRAVITY_M_S2
from robots.description import Description

if TYPE_CHECKING:
    import mujoco

DAMPING_RATIO = 0.1
"""Damping of soft ground as a share of the critical damping of the whole robot on one
foot: a landing foot rebounds once or twice. A factor of two changes little."""

_ADDED_MASS = 0.25
"""Extra share of a foot's inverse mass in MuJoCo's soft contacts. Measured: with
this value a standing robot sinks in as deep as the ground's stiffness predicts."""

_IMPEDANCE_RATIO = 100.0
"""MuJoCo's `impratio`, the impedance of friction over that of the normal force. At 1 a
sticking foot creeps at tangential force / damping; at 100 a hundredth as fast."""


@dataclass(frozen=True)
class FootSpring:
    """Stiffness K and damping B of soft ground under one whole foot.

    The normal force on a foot that has sunk in by r is K r + B r'.
    """

    stiffness_n_m: float
    damping_n_s_m: float

    @classmethod
    def sinking(cls, description: Description, sinkage_m: float) -> "FootSpring":
        """Ground into which a robot at rest on one foot sinks by `sinkage_m` > 0."""
        mass_kg = description.mass_kg
        stiffness_n_m = mass_kg * GRAVITY_M_S2 / sinkage_m
        critical = 2 * math.sqrt(stiffness_n_m * mass_kg)
        return cls(stiffness_n_m, DAMPING_RATIO * critical)


def soften_mujoco(
    model: "mujoco.MjModel", description: Description, spring: FootSpring
) -> None:
    """Give the soles of a compiled MuJoCo model soft contacts; changes the model.

    A MuJoCo contact with solref (-k, -b), constant impedance d, depth r, acceleration a
    and force f solves a + b r' / d + k r / d + R f = 0, with R = A (1 - d) / d and the
    foot's inverse mass A in the reference pose (MuJoCo's "Constraint model"). At rest
    f = k r / (A (1 - d)): stiffness K of a foot of n points needs k = K A (1 - d) / n.
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
