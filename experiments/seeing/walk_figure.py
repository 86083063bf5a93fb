"""Draws walks as stick figures seen from the side, at the same scale in x and z."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from experiments.reports.report import write_figure
from experiments.seeing.scenes import make_scenes
from experiments.seeing.walk_strip import STILL_S, WIDTH_M, WalkStrip, walk_strip
from groundwalk.errors import BadValueError
from worlds import Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LEGS = {"left": "#0072b2", "right": "#d55e00"}
ARMS, TORSO, GROUND, ENDED = "#009e73", "#444444", "#dddddd", "#b2182b"
"""Colours of arms, torso, ground and of the time label at an early end."""

PANEL_IN = 5.0
"""Width of a walk's panel [inch]."""

BELOW_M, ABOVE_M = 0.03, 0.09
"""Heights [m] shown below the ground, and above the heads (for the time)."""


def draw_walk(recordings: Mapping[str, Recording], path: Path) -> None:
    """Draw walks, with base pose and all joints at every tick, into a PNG file."""
    strips = {scene.name: walk_strip(scene) for scene in make_scenes(recordings)}
    write_figure(walk_figure(strips), path)


def walk_figure(strips: Mapping[str, WalkStrip], dots_per_inch: int = 200) -> "Figure":
    """Draw a panel for each walk, all at the same scale.

    A faint stick figure is drawn every 0.12 s; those that do not overlap are drawn bold
    with the time above. Thin lines are the paths of the ankles, with the ground under
    them. The text before the last "/" of a walk's name is the column, the
    text after it the row: "sim/tuned" and "real/tuned" are side by side.
    """
    if not strips:
        raise BadValueError("there is no recording that could be drawn")
    places = {name: name.rpartition("/")[::2] for name in strips}
    columns = list(dict.fromkeys(column for column, _ in places.values()))
    rows = list(dict.fromkeys(row for _, row in places.values()))
    height_m = max(np.ptp(strip.z_range_m) for strip in strips.values())
    height_m += BELOW_M + ABOVE_M
    size = len(rows), len(columns)
    figure, panels = _panels(*size, height_m / WIDTH_M, dots_per_inch)
    for name, strip in strips.items():
        column, row = places[name]
        _draw_strip(panels[rows.index(row), columns.index(column)], strip, height_m)
    _add_key(figure)
    return figure


def _panels(
    rows: int, columns: int, ratio: float, dots_per_inch: int
) -> tuple["Figure", Any]:
    """A figure with (rows, columns) panels without axes; `ratio` is height / width."""
    from matplotlib.figure import Figure

    panel_in = PANEL_IN * ratio + 0.6  # title and axis
    size_in = PANEL_IN * columns, panel_in * rows + 0.7  # key
    figure = Figure(figsize=size_in, dpi=dots_per_inch, layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False)
    for axes in panels.flat:
        axes.set_axis_off()
    for axes in panels[-1]:
        axes.set_xlabel("x [m]")
    return figure, panels


def _draw_strip(axes: "Axes", strip: WalkStrip, height_m: float) -> None:
    low_m = strip.z_range_m[0] - BELOW_M
    axes.set_axis_on()
    axes.set(xlim=strip.x_range_m, ylim=(low_m, low_m + height_m))
    axes.set(yticks=[], aspect="equal")
    axes.set_title(strip.title, loc="left", fontsize=11)
    axes.spines[["top", "left", "right"]].set_visible(False)
    for side, line_m in strip.ground_m.items():
        x_m, z_m = line_m.T
        axes.fill_between(x_m, z_m, low_m, color=GROUND, zorder=0, linewidth=0)
        axes.plot(x_m, z_m, color=LEGS[side], lw=0.8, zorder=1)
    for side, leg_m in strip.figure.legs.items():
        ankle_m = leg_m[strip.ticks, -1]
        axes.plot(ankle_m[:, 0], ankle_m[:, 2], color=LEGS[side], lw=0.6, alpha=0.7)
    _draw_figures(axes, strip)


def _draw_figures(axes: "Axes", strip: WalkStrip) -> None:
    """Draw the stick figures of all stills, seen from the robot's right side."""
    from matplotlib.collections import LineCollection

    body = strip.figure
    arms = [(arm_m, ARMS) for arm_m in body.arms]
    left, right = ((body.legs[side], LEGS[side]) for side in ("left", "right"))
    limbs = [*arms[:1], left, (body.torso, TORSO), right, *arms[1:]]
    for depth, (limb_m, colour) in enumerate(limbs):
        for stills, look in (
            (strip.stills, {"linewidths": 0.8, "alpha": 0.35, "zorder": 2}),
            (strip.clear, {"linewidths": 2, "capstyle": "round", "zorder": 3 + depth}),
        ):
            lines_m = limb_m[stills][:, :, [0, 2]]
            axes.add_collection(LineCollection(list(lines_m), colors=colour, **look))
    for still in strip.clear:
        _draw_head(axes, strip, still)


def _draw_head(axes: "Axes", strip: WalkStrip, still: int) -> None:
    """Draw the head of the stick figure at a tick, with the time above."""
    from matplotlib.patches import Circle

    x_m, _, z_m = strip.figure.torso[still, -1]
    radius_m = strip.figure.head_radius_m
    axes.add_patch(Circle((x_m, z_m), radius_m, fc="white", ec=TORSO, lw=1.5, zorder=8))
    is_end = strip.ended and still == strip.stills[-1]
    axes.annotate(
        f"{strip.time_s[still]:.1f} s",
        (x_m, z_m + radius_m),
        xytext=(0, 3),
        textcoords="offset points",
        horizontalalignment="center",
        fontsize=9,
        color=ENDED if is_end else "black",
        fontweight="bold" if is_end else "normal",
        zorder=9,
    )


def _add_key(figure: "Figure") -> None:
    """Draw the legend, once for all panels."""
    from matplotlib.lines import Line2D

    names = {f"{side} leg": colour for side, colour in LEGS.items()}
    names |= {"arms": ARMS, "torso and head": TORSO}
    figure.legend(
        [Line2D([], [], color=colour, lw=2) for colour in names.values()],
        list(names),
        title=f"from the right side, a figure every {STILL_S:g} s",
        loc="outside lower center",
        ncols=len(names),
        frameon=False,
    )
