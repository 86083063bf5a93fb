"""Mass, centre of mass and inertia of a rigid body, and how they add up."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError


@dataclass(frozen=True, eq=False)
class Inertial:
    """Mass, centre of mass and rotational inertia of a rigid body.

    The centre of mass (3,) is in the frame of the body's joint; the inertia (3, 3) is
    about the centre of mass, along the axes of that frame.
    """

    mass_kg: float
    com_m: FloatArray
    inertia_kg_m2: FloatArray

    def __post_init__(self) -> None:
        """Refuse a mass that is not positive, and an inertia that no body can have."""
        moments = np.linalg.eigvalsh(self.inertia_kg_m2)
        if not (self.mass_kg > 0 and np.isfinite(self.com_m).all()):
            raise BadValueError(f"a mass of {self.mass_kg} kg; it must be positive")
        if moments[0] < 0 or moments[0] + moments[1] < moments[2] * (1 - 1e-6):
            raise BadValueError(
                f"principal moments of inertia {moments} kg m^2: no body has them, "
                "two must add up to at least the third"
            )

    def moved(self, offset_m: FloatArray) -> "Inertial":
        """The body in a parallel frame whose origin is at -offset_m (3,) [m]."""
        return Inertial(self.mass_kg, self.com_m + offset_m, self.inertia_kg_m2)

    def with_rotor(self, axis: FloatArray, rotor_kg_m2: float) -> "Inertial":
        """The body with a geared rotor's inertia about the joint axis (3,) added.

        The rotor is a thin disc fixed to the link, which MuJoCo and Bullet can both
        simulate: Bullet has no joint armature, and a torque from outside in its place
        makes the simulation unstable. A thin disc's inertia across its axis is half of
        that about it, J = `rotor_kg_m2`, so that its matrix is J (E + a a^T) / 2.
        """
        disc = rotor_kg_m2 * (np.eye(3) + np.outer(axis, axis)) / 2
        return Inertial(self.mass_kg, self.com_m, self.inertia_kg_m2 + disc)


def inertia_matrix(components: Sequence[float]) -> FloatArray:
    """Make the symmetric (3, 3) inertia matrix of [ixx, iyy, izz, ixy, ixz, iyz]."""
    xx, yy, zz, xy, xz, yz = components
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], float)


def combined(bodies: Sequence[Inertial]) -> Inertial:
    """Combine rigidly joined bodies, all given in one frame, into one body.

    The inertia about the common centre of mass follows from the parallel axis theorem,
    I = sum_i (I_i + m_i (d_i.d_i E - d_i d_i^T)), d_i from there to that of body i.
    """
    mass = sum(body.mass_kg for body in bodies)
    com = np.sum([body.mass_kg * body.com_m for body in bodies], axis=0) / mass
    inertia = np.zeros((3, 3))
    for body in bodies:
        d = body.com_m - com
        inertia += body.inertia_kg_m2 + body.mass_kg * (
            d @ d * np.eye(3) - np.outer(d, d)
        )
    return Inertial(mass, com, inertia)
