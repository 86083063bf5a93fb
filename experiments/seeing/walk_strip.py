"""Chooses the part and the moments of a walk that a figure of it shows."""

from dataclasses import dataclass

import numpy as np

from experiments.seeing.stick_figure import StickFigure, stick_figure
from groundwalk.arrays import FloatArray, IntArray
from worlds import TICK_S
from worlds.scenes.scene import Scene

COURSE_M, LONGEST_S = 1.0, 5.0
"""Largest distance [m] and duration [s] of the part of a walk that is shown."""

WIDTH_M = 1.5
"""Width of the picture [m]: 1 m of walk, and room for arms, legs and a fall."""

STILL_S = 0.12
"""Time between two stills, the stick figures of a picture [s]: about half a step."""

_ROOM = 2.9
"""Least distance between the heads of two bold stick figures, in radii of the head, so
that the figures and their times do not overlap."""

_GROUND_POINTS = 500


@dataclass(frozen=True, eq=False)
class WalkStrip:
    """Part of a walk, at most 1 m and 5 s: its end if it ended early, else its middle.

    Attributes:
      title: name and speed of the whole walk, and the reason if it ended early.
      ended: whether the walk ended early, such as by a fall.
      time_s: (ticks,) times of all ticks [s].
      figure: the robot as a stick figure at all ticks.
      ticks: the part that is shown, as a slice of the ticks.
      x_range_m: first and last x that are shown [m].
      stills: (stills,) ticks at which the figure is drawn, 0.12 s apart, up to the end
        of the part.
      clear: those of the stills whose figures do not overlap; they are drawn bold.
      ground_m: for "left" and "right" (points, 2) x and z of the ground under the path
        of that foot [m]; empty if the ground is unknown.
    """

    title: str
    ended: bool
    time_s: FloatArray
    figure: StickFigure
    ticks: slice
    x_range_m: tuple[float, float]
    stills: IntArray
    clear: IntArray
    ground_m: dict[str, FloatArray]

    @property
    def z_range_m(self) -> tuple[float, float]:
        """Lowest and highest z to show [m]: from the ground (or 0) to the heads."""
        head_m = self.figure.torso[self.ticks, -1, 2] + self.figure.head_radius_m
        lowest_m = min((line[:, 1].min() for line in self.ground_m.values()), default=0)
        return float(lowest_m), float(np.nanmax(head_m))


def walk_strip(scene: Scene) -> WalkStrip:
    """Choose the part of a walk to show, and prepare it for drawing.

    Raises:
      UnknownNameError: the recording lacks the base's position.
    """
    recording = scene.recording
    time_s, end = recording.time_s, recording.metadata.end
    x_m = recording.vector("base.position")[:, 0]
    ticks = _piece(time_s, x_m, bool(end))
    x_range_m = _x_range(x_m[ticks])
    figure = stick_figure(scene)
    stills = _stills(time_s[ticks]) + ticks.start
    speed_cm_s = 100 * (x_m[-1] - x_m[0]) / max(recording.duration_s, TICK_S)
    title = f"{scene.name.replace('/', ', ')}: {speed_cm_s:.1f} cm/s"
    return WalkStrip(
        title=f"{title}, {end} at {time_s[-1]:.1f} s" if end else title,
        ended=bool(end),
        time_s=time_s,
        figure=figure,
        ticks=ticks,
        x_range_m=x_range_m,
        stills=stills,
        clear=_apart(figure.torso[:, -1, 0], stills, _ROOM * figure.head_radius_m),
        ground_m=_ground(scene, figure, ticks, x_range_m),
    )


def _piece(time_s: FloatArray, x_m: FloatArray, ended: bool) -> slice:
    """The ticks to show: at the walk's end if `ended`, else in its middle."""
    stop = len(x_m)
    if not ended:
        middle = stop // 2
        far = np.abs(x_m[middle:] - x_m[middle]) >= COURSE_M / 2
        far |= time_s[middle:] - time_s[middle] >= LONGEST_S / 2
        stop = middle + int(far.argmax()) if far.any() else stop
    back_m = x_m[:stop][::-1]
    span_m = np.maximum.accumulate(back_m) - np.minimum.accumulate(back_m)
    near = int(np.searchsorted(span_m, COURSE_M, side="right"))
    recent = int(np.searchsorted(time_s, time_s[stop - 1] - LONGEST_S))
    return slice(max(stop - near, recent), stop)


def _x_range(x_m: FloatArray) -> tuple[float, float]:
    """First and last x to show [m], around the positions x_m (ticks,) of the base."""
    middle_m = (x_m.min() + x_m.max()) / 2
    return float(middle_m - WIDTH_M / 2), float(middle_m + WIDTH_M / 2)


def _stills(time_s: FloatArray) -> IntArray:
    """Indices of times 0.12 s apart, counted back from the end of `time_s` (ticks,)."""
    times_s = np.arange(time_s[-1], time_s[0] - TICK_S / 2, -STILL_S)[::-1]
    return np.searchsorted(time_s, times_s - TICK_S / 2)


def _apart(x_m: FloatArray, stills: IntArray, room_m: float) -> IntArray:
    """Those of the stills, from the last one back, whose heads are `room_m` apart."""
    chosen: list[int] = []
    for still in stills[::-1].tolist():
        if (np.abs(x_m[chosen] - x_m[still]) >= room_m).all():
            chosen.append(still)
    return np.array(chosen)


def _ground(
    scene: Scene, figure: StickFigure, ticks: slice, x_range_m: tuple[float, float]
) -> dict[str, FloatArray]:
    """By side (points, 2) x and z of the ground [m] under the path of the foot."""
    if scene.ground is None:
        return {}
    x_m = np.linspace(*x_range_m, _GROUND_POINTS)
    lines_m = {}
    for side, leg_m in figure.legs.items():
        ankle_m = leg_m[ticks, -1]
        nearest = np.abs(x_m[:, np.newaxis] - ankle_m[:, 0]).argmin(axis=1)
        z_m = scene.ground.height_at(x_m, ankle_m[nearest, 1])
        lines_m[side] = np.stack([x_m, z_m], axis=1)
    return lines_m
