"""What a loss torque may go with: a few columns of a regression for each quantity."""

import numpy as np

from diagnosis.seen.bins import quantile_edges
from diagnosis.seen.rows import Rows
from groundwalk.arrays import FloatArray, IntArray

POSITION_KNOTS, LOAD_KNOTS = 16, 5
"""Number of knots of the piecewise linear functions of position and of load."""

BY_LOAD = "load", "acceleration"
"""Names of the quantities from which the loss torque of a passive joint is computed."""

OTHERS = "other joints"
"""Name of the quantity that is not the joint's own."""

FADES = (0.003, 0.01, 0.03)
"""Distances since a turn, as shares of the joint's range, over which a loss torque that
depends on history fades."""


def drivers_of(rows: Rows, chosen: IntArray, joint: int) -> dict[str, FloatArray]:
    """Columns (n, k) of each quantity, by its name, in n chosen rows of one joint.

    Each is a simple additive law. Speed is linear, without the jump at zero that is the
    sign's. Load includes friction that grows with load, and position friction that
    grows with the angle, but not friction at their means, which is the sign's, too.
    History fades with the travel since the last turn, and so differs from the sign near
    turns only.
    """
    v = rows.velocity_rad_s[chosen, joint]
    q = rows.position_rad[chosen, joint]
    needed, way = rows.needed_nm[chosen, joint], np.sign(v)
    heavier = np.abs(needed) - np.mean(np.abs(needed))
    others = [k for k in range(rows.velocity_rad_s.shape[1]) if k != joint]
    found = {
        "sign of speed": way[:, None],
        "speed": v[:, None],
        "acceleration": rows.acceleration_rad_s2[chosen, joint][:, None],
        "load": np.column_stack([_hats(needed, LOAD_KNOTS), heavier * way]),
        "position": np.column_stack([_hats(q, POSITION_KNOTS), (q - q.mean()) * way]),
        "travel since turn": _fading(rows, chosen, joint, way),
        OTHERS: np.column_stack(
            [rows.velocity_rad_s[chosen][:, others], rows.needed_nm[chosen][:, others]]
        ),
    }
    return {name: one for name, one in found.items() if one.shape[1]}


def _hats(values: FloatArray, knots: int) -> FloatArray:
    """(n, k) hat functions at quantiles of values (n,): a piecewise linear function."""
    at = quantile_edges(values, knots - 1)
    return np.stack([np.interp(values, at, one) for one in np.eye(len(at))], axis=1)


def _fading(rows: Rows, chosen: IntArray, joint: int, way: FloatArray) -> FloatArray:
    """(n, 3) the sign of speed, fading with the travel since the last turn."""
    reach = float(np.ptp(rows.position_rad[chosen, joint]))
    travel = np.nan_to_num(rows.travel_rad[chosen, joint], nan=np.inf)
    far = np.array(FADES) * max(reach, 1e-12)
    return np.asarray(way[:, None] * np.exp(-travel[:, None] / far))
