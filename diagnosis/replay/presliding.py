"""Friction that bends before it slides: springs in parallel, each of which slips.

Of n springs with the same stiffness k, spring i follows the joint up to its own bend
d_i = reach i / n, and slips beyond. Their torque is k sum z_i with the bends z_i, after
long sliding `torque` = k sum d_i, so that k = 2 torque / (reach (n + 1)).

Source: Lampaert, Al-Bender and Swevers 2003, "A generalized Maxwell-slip friction model
appropriate for control purposes", without its part that depends on speed.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from groundwalk.arrays import FloatArray

SPRINGS = 8
"""Number n of springs. The meaning of `reach` depends on it, but hardly any torque:
with half as many or twice as many the first curve differs by at most 3.4 % of it."""


def springs(
    torque_nm: FloatArray, reach_rad: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Stiffnesses (...) [N m/rad] and largest bends (..., n) [rad] of the springs.

    Both are 0 where the reach is.
    """
    share = np.arange(1, SPRINGS + 1) / SPRINGS
    most = reach_rad[..., None] * share
    whole = reach_rad * (SPRINGS + 1)
    nothing = np.zeros_like(whole)
    return np.divide(2 * torque_nm, whole, out=nothing, where=whole > 0), most


def bent(bend_rad: FloatArray, moved_rad: FloatArray, most: FloatArray) -> FloatArray:
    """Bends (..., n) [rad] after joints have moved (...) [rad] in one direction."""
    return np.minimum(np.maximum(bend_rad + moved_rad[..., None], -most), most)


def torque_along(
    torque_nm: FloatArray,
    reach_rad: FloatArray,
    position_rad: FloatArray,
    earlier_rad: FloatArray | None = None,
) -> FloatArray:
    """(rows, m) torques [N m] against a known motion (rows, m) of m joints.

    `torque_nm` and `reach_rad` are (m,). All springs are relaxed as the motion begins,
    or as the motion `earlier_rad` (rows, m) does, which led to it.
    """
    stiffness, most = springs(torque_nm, reach_rad)
    bend, found = np.zeros_like(most), np.empty_like(position_rad)
    first = position_rad[0]
    if earlier_rad is not None and len(earlier_rad):
        bend = bend_after(most, np.concatenate([earlier_rad, position_rad[:1]]))
    moves = np.diff(position_rad, axis=0, prepend=first[None])
    for row, moved in enumerate(moves):
        bend = bent(bend, moved, most)
        found[row] = bend.sum(axis=-1)
    return stiffness * found


def bend_after(most_rad: FloatArray, position_rad: FloatArray) -> FloatArray:
    """Bends (m, n) of springs that were relaxed before a motion (rows, m), at its end.

    `most_rad` (m, n) are the largest ones.
    """
    bend = np.zeros_like(most_rad)
    for moved in np.diff(position_rad, axis=0):
        bend = bent(bend, moved, most_rad)
    return bend


class BatchPresliding:
    """The springs of all simulations of a batch, stepped with them.

    With a joint's inertia I and damping D, MuJoCo's implicit integrator finds the speed
    v+ after a step h from (I + h D) (v+ - v) / h = rest - D v - F, where `rest` is all
    other torque. An explicit spring of stiffness K is unstable once h^2 K > 2 (2 I +
    h D), and dry friction that is applied in full beyond the moment at which it stops a
    joint turns it round, by h^2 F / (I + h D): for a light joint more than the reach.
    So F is that of the bends after the step, F(z + h v+). For that the equation is
    solved at each joint by itself, exactly, since F is a line from spring to spring;
    what others exert, `rest`, is as in the last step. At the speed v* that is found,
    MuJoCo gets the tangent: a torque -F* + h K* v* and a damping h K* beside its own,
    so that the step is stable whatever was wrong with `rest`: a spring that sticks acts
    as one that is integrated implicitly (Rosenbrock 1963).
    """

    def __init__(self, joints: Mapping[str, FloatArray], step_s: float) -> None:
        """Prepare the springs of (rows, j) `joints`; only joints with some count."""
        self._at = np.nonzero(joints["slip_nm"])
        torque, reach = (joints[name][self._at] for name in ("slip_nm", "slip_rad"))
        self._stiffness, self._most = springs(torque, reach)
        self._torque, self._step_s = torque, step_s
        self._shape = joints["slip_nm"].shape
        self._bend = np.zeros_like(self._most)
        self._last: tuple[FloatArray, FloatArray] | None = None
        self._line = np.zeros((3, len(torque)))
        """Torque, its slope and the speed v* around which the last step was solved."""

    def begin(self, before_rad: Sequence[FloatArray | None] = ()) -> None:
        """Begin again, with all springs relaxed, or as an earlier motion left them.

        `before_rad` has that of each of R runs (rows, j), up to its start; None where
        it is not known. Simulations are sorted by variant, then by run.
        """
        self._last = None
        self._bend = np.zeros_like(self._most)
        rows, columns = self._at
        for number, before in enumerate(before_rad):
            own = rows % len(before_rad) == number
            if before is not None and own.any():
                motion = before[:, columns[own]]
                self._bend[own] = bend_after(self._most[own], motion)

    def step(
        self,
        position_rad: FloatArray,
        velocity_rad_s: FloatArray,
        inertia_kg_m2: FloatArray,
        damping_nm_s_rad: FloatArray,
    ) -> tuple[FloatArray, FloatArray]:
        """Torques (rows, j) [N m] for the next step, and damping [N m s/rad] beside.

        Arrays are (rows, j); the damping is all that is integrated implicitly but this.
        """
        h, position = self._step_s, position_rad[self._at]
        speed = velocity_rad_s[self._at]
        drag = damping_nm_s_rad[self._at]
        inertia = inertia_kg_m2[self._at] + h * drag
        if self._last is None:
            rest = drag * speed + self._stiffness * self._bend.sum(axis=1)
        else:
            before, speed_before = self._last
            self._bend = bent(self._bend, position - before, self._most)
            torque, slope, around = self._line
            rubbed = torque + slope * h * (speed - around)
            rest = inertia * (speed - speed_before) / h + drag * speed_before + rubbed
        self._last = position.copy(), speed.copy()
        push = rest - drag * speed + inertia * speed / h
        moved, torque, slope = self._solved(inertia / h**2, push)
        self._line = np.stack([torque, slope, moved / h])
        torques, dampings = np.zeros(self._shape), np.zeros(self._shape)
        torques[self._at] = slope * moved - torque
        dampings[self._at] = slope * h
        return torques, dampings

    def _solved(
        self, weight: FloatArray, push: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Ways x (g,) [rad] with weight x + F(x) = push, torques F and slopes there.

        F rises on a line from one edge to the next at which some spring begins or ends
        to slip; left of all edges it is minus the friction's largest torque.
        """
        edges = np.concatenate([-self._most - self._bend, self._most - self._bend], 1)
        order = np.argsort(edges, axis=1)
        edges = np.take_along_axis(edges, order, axis=1)
        turns = np.where(order < self._most.shape[1], 1.0, -1.0)
        slopes = self._stiffness[:, None] * np.cumsum(turns, axis=1)
        rises = slopes[:, :-1] * np.diff(edges, axis=1)
        torques = np.concatenate([np.zeros((len(edges), 1)), rises.cumsum(axis=1)], 1)
        torques -= self._torque[:, None]
        below = weight[:, None] * edges + torques < push[:, None]
        last = np.maximum(below.sum(axis=1) - 1, 0)
        row = np.arange(len(edges))
        slope = np.where(below[:, 0], slopes[row, last], 0.0)
        edge, torque = edges[row, last], torques[row, last]
        moved = edge + (push - torque - weight * edge) / (weight + slope)
        return moved, torque + slope * (moved - edge), slope
