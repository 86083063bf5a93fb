"""What motions lack to tell an effect from another one."""

from collections.abc import Sequence

import numpy as np

from diagnosis.audit.result import Audit
from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect, Variety
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

ONE_SPEED = 0.4
"""A joint moves at one speed if 95 % of its rows in motion are slower than this share
more than the slowest quarter. Ramps have 0, a sine 1.6."""

FEW_REVERSALS = 2
"""A joint that turns back less often does not tell friction from a constant torque."""

ONE_POSE_RAD = 0.2
"""A joint with a smaller range stays near one pose: its weight changes by a fiftieth
there, and a spring's torque hardly more."""

STEADY_RAD_S = 4.0
"""A joint whose acceleration is below this multiple of its speed, at 95 % of both,
never changes its speed quickly. Slow sines have their frequency here, 0.6 at 0.1 Hz,
steps and chirps 20 and more."""

APART_ROWS = 3
"""Half width [rows] of the differences that stand for speeds."""

WORDS: dict[Variety, str] = {
    "speeds": "moved at one speed only",
    "reversals": "hardly turned back",
    "poses": "stayed near one pose",
    "accelerations": "never changed its speed quickly",
}
"""What reports say of a motion that lacks something."""


def lacking(
    plant: Plant, traces: Sequence[Trace], audited: Audit
) -> dict[str, tuple[Variety, ...]]:
    """What the motion of each joint lacks, by its name; joints at rest lack all."""
    turns = dict.fromkeys(plant.joints, 0)
    for trace in audited.traces:
        for one in trace.joints:
            turns[one.name] = max(turns[one.name], one.reversals)
    found: dict[str, tuple[Variety, ...]] = {}
    for column, joint in enumerate(plant.joints):
        if joint not in audited.moving:
            found[joint] = tuple(WORDS)
            continue
        speed, change = _speeds(traces, column)
        reach = max(np.ptp(_there(one.position_rad[:, column])) for one in traces)
        moving = speed[speed > 0.1 * np.quantile(speed, 0.95)]
        fast, slow = np.quantile(moving, (0.95, 0.25))
        poor = {
            "speeds": fast < (1 + ONE_SPEED) * slow,
            "reversals": turns[joint] < FEW_REVERSALS,
            "poses": reach < ONE_POSE_RAD,
            "accelerations": np.quantile(change, 0.95) < STEADY_RAD_S * fast,
        }
        found[joint] = tuple(one for one in WORDS if poor[one])
    return found


def why_alike(
    one: PlacedEffect, other: PlacedEffect, lacks: dict[str, tuple[Variety, ...]]
) -> str:
    """What the motion lacks to tell two effects apart, as the end of a sentence.

    "" if it lacks nothing of what either of them needs to show as itself.
    """
    for placed in (one, other):
        need = effect(placed.name).shown_by
        if need is not None and need in lacks.get(placed.place, ()):
            return f"{placed.place} {WORDS[need]}"
    return ""


def _speeds(traces: Sequence[Trace], column: int) -> tuple[FloatArray, FloatArray]:
    """Speeds [rad/s], and accelerations [rad/s^2], of a joint in all traces."""
    speeds, changes = [], []
    for trace in traces:
        there = np.isfinite(trace.position_rad[:, column])
        time_s, position = trace.time_s[there], trace.position_rad[there, column]
        apart = 2 * APART_ROWS
        if len(time_s) <= 2 * apart:
            continue
        rate = (position[apart:] - position[:-apart]) / (
            time_s[apart:] - time_s[:-apart]
        )
        middle = time_s[APART_ROWS:-APART_ROWS]
        speeds.append(np.abs(rate))
        changes.append(
            np.abs(rate[apart:] - rate[:-apart]) / (middle[apart:] - middle[:-apart])
        )
    return np.concatenate(speeds), np.concatenate(changes)


def _there(values: FloatArray) -> FloatArray:
    return values[np.isfinite(values)]
