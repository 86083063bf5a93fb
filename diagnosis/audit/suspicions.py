"""Finds recordings that contradict the robot model: mixed up units, signs or joints."""

import numpy as np
from scipy.optimize import linear_sum_assignment

from diagnosis.audit.following import Following, following
from diagnosis.audit.result import Finding
from diagnosis.plant.plant import Plant
from diagnosis.traces.smoothing import Smoothed
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray, IntArray

_FAR_BEYOND, _FAR_BEYOND_RAD = 1.0, 1.0
"""Positions beyond a joint's range in the model, both by this multiple of its width and
by this angle [rad], are taken to be in another unit."""
_BEYOND = 0.05
"""Positions beyond a joint's range in the model by this share of its width are worth a
finding."""
_NARROW = 3.0
"""Motion this many times wider than a joint's range in the model shows that the range
was converted to radians although it was in radians already."""
_FAR_BETTER = 0.4
"""Joints count as swapped if another joint's command fits a position with less than
this share of the rms error of the joint's own command."""
_ALIKE = 0.8
"""Smallest absolute correlation of two signals that count as the same motion."""
_UNIT_SLACK = 1.4
"""Largest factor between the slope of a position over its command and the factor of a
confused unit, such as 57.3 for degrees, for which that unit is suspected."""
_UNITS = {np.degrees(1): "degrees instead of radians", 1e3: "thousandths of the unit"}
"""Factors between units that are often confused, and words for the wrong unit."""
_RATE_SLACK = 2.0
"""Largest factor between measured velocities and the rate of the positions."""


def range_findings(trace: Trace, plant: Plant) -> list[Finding]:
    """Find positions and commands beyond the joint ranges of the robot model."""
    found = []
    for column, joint in enumerate(plant.joints):
        number = plant.model.joint(joint).id
        if not plant.model.jnt_limited[number]:
            continue
        low, high = plant.model.jnt_range[number]
        for quantity, values in _targets(trace):
            most = _excess(values[:, column], low, high)
            name = f"{quantity}.{joint}"
            said = f"{name} of {trace.name} goes {most:.3g} beyond"
            ends = f"its range of {low:.3g} to {high:.3g} in the model"
            if _is_in_degrees(values[:, column], low, high):
                text = (
                    f"{said} {ends}; is the model's range in degrees where radians are "
                    "expected, or the other way round (MJCF: compiler angle)?"
                )
                found.append(Finding("refuse", text, trace.name, name))
            elif most > max(_FAR_BEYOND * (high - low), _FAR_BEYOND_RAD):
                text = f"{said} {ends}; are angles in degrees instead of radians?"
                found.append(Finding("refuse", text, trace.name, name))
            elif most > _BEYOND * (high - low):
                text = f"{said} {ends}; the model's end stop would act there"
                found.append(Finding("limit", text, trace.name, name))
    return found


def following_findings(trace: Trace, plant: Plant) -> list[Finding]:
    """Find joints that follow another joint's command, or their own with wrong sign."""
    if trace.command_rad is None:
        return []
    follow = following(trace)
    found = _swapped(trace, plant, follow)
    for k, column in enumerate(follow.columns):
        name = f"position.{plant.joints[column]}"
        slope, alike = follow.slope[k], follow.correlation[k, k]
        unit = _unit(slope)
        if abs(alike) > _ALIKE and unit:
            text = (
                f"{name} of {trace.name} moves {slope:.3g} times as far as its "
                f"command; is one of them in {unit}?"
            )
            found.append(Finding("refuse", text, trace.name, name))
        elif alike < -_ALIKE and follow.flipped[k] < _FAR_BETTER * follow.misfit[k, k]:
            text = (
                f"{name} of {trace.name} runs against its command (correlation "
                f"{alike:.2f}); is a sign wrong?"
            )
            found.append(Finding("refuse", text, trace.name, name))
    return found


def velocity_findings(
    trace: Trace, plant: Plant, smoothed: list[Smoothed], moves: list[bool]
) -> list[Finding]:
    """Find measured velocities that contradict the rate of the positions.

    Args:
      trace: a recording of the plant.
      plant: the robot model.
      smoothed: the trace's smoothed positions, joint by joint.
      moves: whether each joint moves.
    """
    found: list[Finding] = []
    if trace.velocity_rad_s is None:
        return found
    for column, joint in enumerate(plant.joints):
        rate, measured = smoothed[column].rate, trace.velocity_rad_s[:, column]
        there = np.isfinite(measured) & np.isfinite(rate)
        if not moves[column] or there.sum() < 2 or np.ptp(measured[there]) == 0:
            continue
        cross = float(np.mean(rate[there] * measured[there]))
        factor = cross / float(np.mean(rate[there] ** 2))
        alike = cross / float(
            np.sqrt(np.mean(rate[there] ** 2) * np.mean(measured[there] ** 2))
        )
        right = 1 / _RATE_SLACK < factor < _RATE_SLACK
        if abs(alike) > _ALIKE and not right:
            name = f"velocity.{joint}"
            text = (
                f"{name} of {trace.name} is {factor:.3g} times the rate of its "
                "positions; are their units, signs and the time's the same?"
            )
            found.append(Finding("refuse", text, trace.name, name))
    return found


def drive_findings(trace: Trace, plant: Plant) -> list[Finding]:
    """Find what a trace lacks for a replay: a base's pose, commands or servo gains."""
    found = []
    if plant.base == "floating" and (
        trace.base_position_m is None or trace.base_orientation is None
    ):
        text = (
            f"{trace.name} has a floating base without base.position and "
            "base.orientation; nothing says where it is"
        )
        found.append(Finding("refuse", text, trace.name))
    for column, joint in enumerate(plant.joints):
        if _is_driven(trace, column) and not _follows_unknown(trace, column):
            continue
        name = f"command.{joint}"
        text = (
            f"{name} of {trace.name}: no servo gains are known; give them as options "
            "or in the recording's metadata"
            if _is_driven(trace, column)
            else f"{trace.name}: nothing says what drove {joint}"
        )
        found.append(Finding("refuse", text, trace.name, name))
    return found


def _swapped(trace: Trace, plant: Plant, follow: Following) -> list[Finding]:
    """Find cycles of joints that each follow the command of the next one."""
    if len(follow.columns) < 2:
        return []
    _, of_command = linear_sum_assignment(follow.misfit**2)
    source = np.argsort(of_command)  # the command that explains each position best
    positions = np.arange(len(source))
    own = follow.misfit[positions, positions]
    better = follow.misfit[source, positions] < _FAR_BETTER * own
    better &= follow.correlation[source, positions] > _ALIKE
    found = []
    for k in positions[source != positions]:
        if not all(better[member] for member in _cycle(source, int(k))):
            continue
        joint, other = (plant.joints[follow.columns[i]] for i in (k, source[k]))
        name = f"position.{joint}"
        text = (
            f"{name} of {trace.name} follows the command of {other} within "
            f"{follow.misfit[source[k], k]:.2g}, its own only within {own[k]:.2g}; are "
            "joints swapped?"
        )
        found.append(Finding("refuse", text, trace.name, name))
    return found


def _cycle(source: IntArray, start: int) -> list[int]:
    members, k = [start], int(source[start])
    while k != start:
        members.append(k)
        k = int(source[k])
    return members


def _unit(slope: float) -> str:
    for factor, unit in _UNITS.items():
        for size in (factor, 1 / factor):
            if 1 / _UNIT_SLACK < abs(slope) / size < _UNIT_SLACK:
                return unit
    return ""


def _targets(trace: Trace) -> list[tuple[str, FloatArray]]:
    pairs = [("position", trace.position_rad), ("command", trace.command_rad)]
    return [(name, values) for name, values in pairs if values is not None]


def _excess(values: FloatArray, low: float, high: float) -> float:
    """Distance by which values leave a range, without the outermost 1 % at each end."""
    there = values[np.isfinite(values)]
    least, most = np.quantile(there, (0.01, 0.99)) if len(there) else (low, high)
    return float(max(most - high, low - least, 0.0))


def _is_in_degrees(values: FloatArray, low: float, high: float) -> bool:
    """Whether a joint's range was converted to radians although it was in radians.

    This is so if the joint moves over more than three times its range, but within 57.3
    times that range.
    """
    there = values[np.isfinite(values)]
    if len(there) == 0 or high <= low:
        return False
    least, most = np.quantile(there, (0.01, 0.99))
    inside = np.degrees(low) <= least and most <= np.degrees(high)
    return bool(inside and most - least > _NARROW * (high - low))


def _is_driven(trace: Trace, column: int) -> bool:
    drives = (trace.command_rad, trace.command_torque_nm, trace.torque_nm)
    return any(
        values is not None and bool(np.isfinite(values[:, column]).any())
        for values in drives
    )


def _follows_unknown(trace: Trace, column: int) -> bool:
    """Whether the joint has no servo gains, and no torques instead of commands."""
    torques = (trace.command_torque_nm, trace.torque_nm)
    by_torque = any(
        values is not None and bool(np.isfinite(values[:, column]).any())
        for values in torques
    )
    return bool(trace.servo.kp_nm_rad[column] == 0) and not by_torque
