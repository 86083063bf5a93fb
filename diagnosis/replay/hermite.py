"""Cubic courses between states with positions and velocities."""

from groundwalk.arrays import FloatArray


def hermite(
    before: tuple[FloatArray, FloatArray],
    after: tuple[FloatArray, FloatArray],
    step_s: float,
    share: FloatArray | float,
) -> tuple[FloatArray, FloatArray]:
    """Position by cubic Hermite interpolation, velocity by linear.

    Args:
      before: position and velocity, of one shape.
      after: those a step later.
      step_s: between the two.
      share: of the step that has gone by, 0 to 1.
    """
    h, t = step_s, share
    (q0, v0), (q1, v1) = before, after
    v0, v1 = h * v0, h * v1
    rise = q1 - q0
    position = q0 + t * (v0 + t * (3 * rise - 2 * v0 - v1 + t * (v0 + v1 - 2 * rise)))
    return position, (v0 + t * (v1 - v0)) / h
