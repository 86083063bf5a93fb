"""Curves of a recording over time, and the plots of a viewer that show them."""

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from worlds.recordings.recording import JOINT_QUANTITIES, SUPPORT, VECTORS
from worlds.scenes import colours
from worlds.scenes.scene import SIDES, Scene

_IMU = ("gyroscope", "accelerometer")
MEASURED_SUPPORT = "contact/support"
SIDEWAYS = "balance/sideways"
"""Path of the curves of y of centre of mass, centre of pressure and ZMP."""
_ABREAST = 4
"""Largest number of joint plots in one row."""
_SUPPORT_NAMES = {-1: "right", 0: "both", 1: "left"}


class Trace(NamedTuple):
    """Lines over the times of a recording, at one path of a viewer's file.

    The path is below the scene's name, such as "imu/gyroscope". Values are (ticks,) or
    (ticks, lines), NaN where one is missing; `names` are for the legend, and `lines`
    are the colours, None to let the viewer choose.
    """

    path: str
    names: Sequence[str]
    values: FloatArray
    lines: Sequence[colours.Colour] | None


class Curve(NamedTuple):
    """Lines with times (ticks,) of their own, in a plot of their own.

    The title has the unit; the trace's path has no scene's name before it.
    """

    title: str
    time_s: FloatArray
    trace: Trace


class Plot(NamedTuple):
    """A plot: its title and the paths of the traces that it shows together."""

    name: str
    paths: Sequence[str]


def traces(scene: Scene) -> Iterator[Trace]:
    """Yield the recorded curves of the joints, the foot forces and the IMU."""
    recording = scene.recording
    legs = {
        joint: colours.SIDES[side]
        for side in SIDES
        for joint in scene.pitch_joints(side)
    }
    for quantity in JOINT_QUANTITIES:
        for joint in recording.joints_with(quantity):
            line = legs.get(joint)
            if line and quantity == "command":
                line = colours.pale(line)
            yield Trace(
                f"joints/{joint}/{quantity}",
                [f"{joint} {quantity}"],
                recording.columns[f"{quantity}.{joint}"],
                line and [line],
            )
    for side in SIDES:
        force_n = scene.foot_force_n(side)
        if force_n is not None:
            yield Trace(f"contact/{side}", [side], force_n, [colours.SIDES[side]])
    for name in _IMU:
        if recording.has(name):
            values = recording.vector(name)
            yield Trace(f"imu/{name}", VECTORS[name], values, colours.AXES)


def plots(scene: Scene) -> list[list[Plot]]:
    """Rows of plots: pitch joints of both legs, or all joints of a robot without feet.

    The last row shows the sensors. Quantities that were not recorded have no plot.
    """
    units = {
        joint.name: "m" if joint.slides else "rad" for joint in scene.description.links
    }
    groups: Iterable[tuple[str, ...]] = ((joint,) for joint in scene.recording.joints)
    if scene.description.feet:
        groups = zip(*map(scene.pitch_joints, SIDES), strict=False)
    joints = [
        Plot(
            f"{', '.join(group)} [{units[group[0]]}]",
            [
                f"joints/{joint}/{quantity}"
                for joint in group
                for quantity in ("position", "command")
            ],
        )
        for group in groups
    ]
    sensors = [
        Plot("foot forces [N]", [f"contact/{side}" for side in SIDES]),
        Plot("gyroscope [rad/s]", ["imu/gyroscope"]),
        Plot("balance: y [m]", [f"{SIDEWAYS}/**"]),
    ]
    recorded = {trace.path for trace in traces(scene)}
    if scene.recording.has("base.position") and scene.description.feet:
        recorded.add(f"{SIDEWAYS}/**")
    rows = [joints[k : k + _ABREAST] for k in range(0, len(joints), _ABREAST)]
    shown = [
        [plot for plot in row if not recorded.isdisjoint(plot.paths)]
        for row in (*rows, sensors)
    ]
    return [row for row in shown if row]


def support_changes(scene: Scene) -> tuple[IntArray, list[str]]:
    """Rows where the gait's supporting leg changes, and the new: left, right, both."""
    support = scene.recording.columns.get(SUPPORT, np.empty(0))
    known = np.flatnonzero(~np.isnan(support))
    changes = known[np.diff(support[known], prepend=np.nan) != 0]
    return changes, [_SUPPORT_NAMES[int(leg)] for leg in support[changes]]
