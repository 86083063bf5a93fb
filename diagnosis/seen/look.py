"""Looks at recordings: what each joint shows, before any effect is named."""

from collections.abc import Sequence
from typing import Literal

import mujoco
import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.residuals.replays import Model
from diagnosis.seen.curves import curves_of
from diagnosis.seen.delays import delay_of
from diagnosis.seen.known_torques import WHY, known_torques
from diagnosis.seen.pieces import ENOUGH, pieces_of
from diagnosis.seen.result import Delay, Seen, SeenJoint, Source
from diagnosis.seen.rows import Rows, rows_of
from diagnosis.seen.shares import shares_of
from diagnosis.traces.outliers import without_outliers
from diagnosis.traces.trace import Trace
from groundwalk.arrays import IntArray
from groundwalk.blas import one_blas_thread

HARDLY = "It hardly moves: its loss torque shows nothing."
FEW = (
    "It moves too little, or in too few parts of the recordings, to tell what its loss "
    "torque goes with."
)
STILL_DELAY = "It does not follow its commands closely enough to tell a delay."
NO_COMMANDS = "No position commands were recorded: no delay and no tracking error."
COUPLED = (
    "The model couples it with another joint: what the coupling passes from one to the "
    "other is part of its loss torque."
)
FEWEST_ROWS = 20
"""Fewest rows in which a joint must move for its loss torque to show anything."""


@one_blas_thread
def look(plant: Plant, traces: Sequence[Trace], model: Model = ()) -> Seen:
    """Find out what each joint shows in recordings; nothing is fitted.

    Single wrong samples are left out. The loss torque of a joint is the torque that it
    had less the torque that its smoothed motion needs by the nominal model.

    Args:
      plant: the nominal robot model.
      traces: recordings of the robot, one at least.
      model: effects with values, such as those of a verdict, whose law is computed in
        the same bins; () for none.

    Example:
      >>> plant, traces = read_traces(["a.parquet"], "so101")
      >>> print(look(plant, traces).to_json())
    """
    traces = [without_outliers(trace)[0] for trace in traces]
    pieces, names = pieces_of(traces)
    torques, sources = known_torques(plant, traces)
    rows: Rows | None = None
    by_servo = np.array([source == "servo" for source in sources])
    if plant.base == "fixed" and set(sources) != {"unknown"}:
        rows = rows_of(plant, traces, torques, by_servo, model)
    piece = np.concatenate(pieces)
    found = []
    for j, source in enumerate(sources):
        delay = delay_of(traces, pieces, names, j)
        found.append(_joint(plant, traces, rows, piece, j, source, delay))
    by: Literal["recordings", "blocks"]
    by = "recordings" if len(traces) >= ENOUGH else "blocks"
    highest_hz = None if rows is None else rows.cutoff_hz
    return Seen(tuple(found), tuple(names), by, highest_hz)


def _joint(
    plant: Plant,
    traces: Sequence[Trace],
    rows: Rows | None,
    piece: IntArray,
    joint: int,
    source: Source,
    delay: Delay | None,
) -> SeenJoint:
    """What one joint shows; `rows` is None if no loss torque is known."""
    name = plant.joints[joint]
    unit, unknown = plant.unit("N m", name), list[str]()
    if all(trace.command_rad is None for trace in traces):
        unknown.append(NO_COMMANDS)
    elif delay is None:
        unknown.append(STILL_DELAY)
    if rows is None or source == "unknown":
        why = WHY["unknown" if source == "unknown" else "floating"]
        return SeenJoint(name, source, (why, *unknown), unit, delay=delay)
    loss = rows.loss_nm[:, joint]
    moving = rows.counts[:, joint] & np.isfinite(loss)
    if moving.sum() < FEWEST_ROWS:
        return SeenJoint(name, source, (HARDLY, *unknown), unit, delay=delay)
    if name in _coupled(plant):
        unknown.append(COUPLED)
    shares, together, noise = shares_of(rows, piece, joint, source == "passive")
    return SeenJoint(
        joint=name,
        source=source,
        unknown=(*unknown, *([] if shares else [FEW])),
        torque_unit=unit,
        loss_rms=float(np.sqrt(np.mean(loss[moving] ** 2))),
        needed_rms=float(np.sqrt(np.mean(rows.needed_nm[moving, joint] ** 2))),
        stiffness=_stiffness(traces, joint),
        curves=curves_of(plant, rows, piece, joint, source),
        shares=shares,
        together=together,
        noise_share=noise,
        delay=delay,
    )


def _coupled(plant: Plant) -> frozenset[str]:
    """Names of the joints that an equality of the model couples with another joint.

    Inverse dynamics leaves out the torque that passes between them.
    """
    model = plant.model
    pairs = np.flatnonzero(model.eq_type == int(mujoco.mjtEq.mjEQ_JOINT))
    ids = {int(k) for one in (model.eq_obj1id, model.eq_obj2id) for k in one[pairs]}
    return frozenset(model.joint(k).name for k in ids if k >= 0)


def _stiffness(traces: Sequence[Trace], joint: int) -> float | None:
    """Declared stiffness of a joint's servo, if it is the same in all recordings."""
    held = [one for one in traces if one.command_rad is not None]
    found = {float(one.servo.kp_nm_rad[joint]) for one in held}
    return found.pop() if len(found) == 1 and found != {0.0} else None
