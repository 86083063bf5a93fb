"""Finds recordings that contradict the robot model: mixed up units, signs or joints."""

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.optimize import linear_sum_assignment

from diagnosis.audit.following import Following, following
from diagnosis.audit.result import Finding
from diagnosis.plant.plant import Plant
from diagnosis.traces.smoothing import Smoothed
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray, IntArray
from groundwalk.gravity import GRAVITY_M_S2

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
_ABOVE, _FAR_ABOVE = 1.5, 20.0
"""Torques above the first multiple of the servo's limit are suspicious; above the
second, their unit is wrong."""
_IN_G = (0.7, 1.4)
"""A median size of the accelerometer's vector within this range, expected in m/s^2,
shows that the sensor reports multiples of gravity."""
_FASTEST_RAD_S = 35.0
"""Largest rate [rad/s] that robots' gyroscopes can measure: 2000 degrees a second."""


def drive_findings(trace: Trace, plant: Plant) -> Iterator[Finding]:
    """Find what a trace lacks for a replay: a base's pose, commands or servo gains."""
    if plant.base == "floating" and (
        trace.base_position_m is None or trace.base_orientation is None
    ):
        text = (
            f"{trace.name} has a floating base without base.position and "
            "base.orientation; nothing says where it is"
        )
        yield Finding("refuse", text, trace.name)
    torques = (trace.command_torque_nm, trace.torque_nm)
    for column, joint in enumerate(plant.joints):
        name = f"command.{joint}"
        if not _has_any(column, trace.command_rad, *torques):
            yield _undriven(trace, plant, column)
        elif trace.servo.kp_nm_rad[column] == 0 and not _has_any(column, *torques):
            text = (
                f"{name} of {trace.name}: no servo gains are known; give them as "
                "options or in the recording's metadata"
            )
            yield Finding("refuse", text, trace.name, name)


def range_findings(trace: Trace, plant: Plant) -> Iterator[Finding]:
    """Find positions and commands beyond the joint ranges of the robot model."""
    targets = {"position": trace.position_rad, "command": trace.command_rad}
    for column, joint in enumerate(plant.joints):
        number = plant.model.joint(joint).id
        if not plant.model.jnt_limited[number]:
            continue
        low, high = plant.model.jnt_range[number]
        for quantity, values in targets.items():
            if values is None:
                continue
            least, most = _outermost(values[:, column], low, high)
            excess = float(max(most - high, low - least, 0.0))
            name = f"{quantity}.{joint}"
            said = (
                f"{name} of {trace.name} goes {excess:.3g} beyond its range of "
                f"{low:.3g} to {high:.3g} in the model"
            )
            # a range in radians was converted once more; all motion is within that
            inside = np.degrees(low) <= least and most <= np.degrees(high)
            if high > low and inside and most - least > _NARROW * (high - low):
                text = (
                    f"{said}; is the model's range in degrees where radians are "
                    "expected, or the other way round (MJCF: compiler angle)?"
                )
                yield Finding("refuse", text, trace.name, name)
            elif excess > max(_FAR_BEYOND * (high - low), _FAR_BEYOND_RAD):
                text = f"{said}; are angles in degrees instead of radians?"
                yield Finding("refuse", text, trace.name, name)
            elif excess > _BEYOND * (high - low):
                end = "the joint is simulated without that range"
                if quantity == "command":
                    end = "the model's end stop would act there"
                yield Finding("limit", f"{said}; {end}", trace.name, name)


def contradicted_ranges(traces: Sequence[Trace], plant: Plant) -> tuple[str, ...]:
    """Names of the joints that went where the model has an end stop.

    What they show there can only be seen in simulations without the model's range. A
    command beyond it says nothing about the stop.
    """
    far = {
        finding.channel.removeprefix("position.")
        for trace in traces
        for finding in range_findings(trace, plant)
        if finding.severity == "limit" and finding.channel.startswith("position.")
    }
    return tuple(joint for joint in plant.joints if joint in far)


def following_findings(trace: Trace, plant: Plant) -> Iterator[Finding]:
    """Find joints that follow another joint's command, or their own with wrong sign."""
    follow = following(trace)
    yield from _swapped(trace, plant, follow)
    for k, column in enumerate(follow.columns):
        name = f"position.{plant.joints[column]}"
        slope, alike = follow.slope[k], follow.correlation[k, k]
        unit = _unit(slope)
        if abs(alike) > _ALIKE and unit:
            text = (
                f"{name} of {trace.name} moves {slope:.3g} times as far as its "
                f"command; is one of them in {unit}?"
            )
            yield Finding("refuse", text, trace.name, name)
        elif alike < -_ALIKE and follow.flipped[k] < _FAR_BETTER * follow.misfit[k, k]:
            text = (
                f"{name} of {trace.name} runs against its command (correlation "
                f"{alike:.2f}); is a sign wrong?"
            )
            yield Finding("refuse", text, trace.name, name)


def velocity_findings(
    trace: Trace, plant: Plant, smoothed: Sequence[Smoothed], moves: Sequence[bool]
) -> Iterator[Finding]:
    """Find measured velocities that contradict the rate of the positions.

    `smoothed` are the positions, joint by joint; `moves` says whether each joint moves.
    """
    if trace.velocity_rad_s is None:
        return
    for column, joint in enumerate(plant.joints):
        rate, measured = smoothed[column].rate, trace.velocity_rad_s[:, column]
        there = np.isfinite(measured) & np.isfinite(rate)
        if not moves[column] or there.sum() < 2 or np.ptp(measured[there]) == 0:
            continue
        cross = float(np.mean(rate[there] * measured[there]))
        power = np.mean(rate[there] ** 2)
        factor = cross / float(power)
        alike = cross / float(np.sqrt(power * np.mean(measured[there] ** 2)))
        right = 1 / _RATE_SLACK < factor < _RATE_SLACK
        if abs(alike) > _ALIKE and not right:
            name = f"velocity.{joint}"
            said = f"{name} of {trace.name} is {factor:.3g} times the rate of its"
            if _unit(factor) == _UNITS[1e3]:
                text = f"{said} positions; is the time in milliseconds?"
                yield Finding("refuse", text, trace.name, name)
                continue
            text = (
                f"{said} positions, as on the motor's side of a gear or in another "
                "unit; it is not used"
            )
            yield Finding("limit", text, trace.name, name)


def torque_findings(trace: Trace, plant: Plant) -> Iterator[Finding]:
    """Find measured and commanded torques far above the servos' limits."""
    torques = {"torque": trace.torque_nm, "command_torque": trace.command_torque_nm}
    for quantity, values in torques.items():
        if values is None:
            continue
        for column, joint in enumerate(plant.joints):
            limit = float(trace.servo.max_torque_nm[column])
            most = float(_sizes(values[:, column]).max(initial=0.0))
            name = f"{quantity}.{joint}"
            said = f"{name} of {trace.name} reaches {most:.3g}"
            if most > _FAR_ABOVE * limit:
                text = f"{said}, far above the servo's {limit:.3g}; is its unit right?"
                yield Finding("refuse", text, trace.name, name)
            elif most > _ABOVE * limit:
                text = f"{said}, above the servo's {limit:.3g}"
                yield Finding("limit", text, trace.name, name)


def imu_findings(trace: Trace) -> Iterator[Finding]:
    """Find accelerations in multiples of gravity, and turning rates in degrees."""
    if trace.accelerometer_m_s2 is not None:
        norms = _sizes(np.linalg.norm(trace.accelerometer_m_s2, axis=1))
        norm = float(np.median(norms)) if len(norms) else GRAVITY_M_S2
        if _IN_G[0] < norm < _IN_G[1]:
            text = (
                f"accelerometer of {trace.name} shows {norm:.3g} where gravity is "
                f"{GRAVITY_M_S2} m/s^2; is it in g?"
            )
            yield Finding("refuse", text, trace.name, "accelerometer")
    if trace.gyroscope_rad_s is not None:
        fastest = float(_sizes(trace.gyroscope_rad_s).max(initial=0.0))
        if fastest > _FASTEST_RAD_S:
            text = (
                f"gyroscope of {trace.name} reaches {fastest:.3g} rad/s, more than "
                "such sensors measure; is it in degrees per second?"
            )
            yield Finding("refuse", text, trace.name, "gyroscope")


def _swapped(trace: Trace, plant: Plant, follow: Following) -> Iterator[Finding]:
    """Find cycles of joints that each follow the command of the next one."""
    if len(follow.columns) < 2:
        return
    cost = follow.misfit**2
    # commands may be alike: a joint keeps its own unless another is far better
    np.fill_diagonal(cost, _FAR_BETTER**2 * np.diag(cost))
    _, of_command = linear_sum_assignment(cost)
    source = np.argsort(of_command)  # the command that explains each position best
    positions = np.arange(len(source))
    own = follow.misfit[positions, positions]
    better = follow.misfit[source, positions] < _FAR_BETTER * own
    better &= follow.correlation[source, positions] > _ALIKE
    for k in positions[source != positions]:
        if not better[_cycle(source, int(k))].all():
            continue
        joint, other = (plant.joints[follow.columns[i]] for i in (k, source[k]))
        name = f"position.{joint}"
        text = (
            f"{name} of {trace.name} follows the command of {other} within "
            f"{follow.misfit[source[k], k]:.2g}, its own only within {own[k]:.2g}; are "
            "joints swapped?"
        )
        yield Finding("refuse", text, trace.name, name)


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


def _undriven(trace: Trace, plant: Plant, column: int) -> Finding:
    """The finding on a joint of which no command and no torque was recorded.

    It is passive, as a flexible link is, if other joints have a drive, and neither the
    model nor the recording knows of a motor at this one.
    """
    joint = plant.joints[column]
    name, text = f"command.{joint}", f"{trace.name}: nothing says what drove {joint}"
    every = range(len(plant.joints))
    drives = trace.command_rad, trace.command_torque_nm, trace.torque_nm
    if trace.servo.kp_nm_rad[column] == 0 and any(_has_any(i, *drives) for i in every):
        said = f"{text}; it is taken as passive, as without a motor"
        return Finding("limit", said, trace.name, name)
    return Finding("refuse", text, trace.name, name)


def _outermost(values: FloatArray, low: float, high: float) -> tuple[float, float]:
    """The 1 % and 99 % quantiles of values; the range itself if there are none."""
    there = values[np.isfinite(values)]
    if not len(there):
        return low, high
    least, most = np.quantile(there, (0.01, 0.99))
    return least, most


def _has_any(column: int, *channels: FloatArray | None) -> bool:
    """Whether a joint has a value in one of the channels (T, j)."""
    return any(
        values is not None and bool(np.isfinite(values[:, column]).any())
        for values in channels
    )


def _sizes(values: FloatArray) -> FloatArray:
    """(k,) absolute values of those that are not missing."""
    return np.asarray(np.abs(values[np.isfinite(values)]))
