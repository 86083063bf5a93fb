"""Layout of a Rerun file: the views of robots, feet and curves, and their places."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from groundwalk.arrays import FloatArray
from worlds.recordings.recording import SUPPORT
from worlds.scenes.balance import loaded_feet
from worlds.scenes.curves import MEASURED_SUPPORT, Curve, plots
from worlds.scenes.lanes import Lane
from worlds.scenes.scene import Scene

MOST_ABREAST = 2
"""Largest number of scenes shown side by side with all curves; more get tabs."""

_ON_GROUND = ("below", "pressure", "zmp", "polygon")
_MARGIN = 0.05
"""Free space above and below a curve in its plot, as a share of the curve's range."""
_PAGE_COLUMNS = 2
_LANE_SHARE = 0.15
"""Height of a lane of states, as a share of that of a plot."""
_ROBOT_COLUMNS = 4


def blueprint(
    scenes: Sequence[Scene],
    pages: Mapping[str, Sequence[Curve]],
    lanes: Mapping[str, Sequence[Lane]] = MappingProxyType({}),
) -> rrb.Blueprint:
    """Lay out a file: scenes from left to right, each above its curves.

    `pages` are further curves by the name of their tab. If there are any, they are
    below the robots instead of the scenes' own curves; the `lanes` of a page are above
    its curves.
    """
    tabs: list[rrb.Grid | rrb.Vertical] = [
        _page_with_lanes(name, curves, lanes.get(name, ()))
        for name, curves in pages.items()
    ]
    if not pages and len(scenes) > MOST_ABREAST:
        tabs = [_scene_tab(scene) for scene in scenes]
    rows = []
    if tabs and scenes:
        abreast = min(len(scenes), _ROBOT_COLUMNS)
        rows.append(rrb.Grid(*map(_robot_view, scenes), grid_columns=abreast))
    rows.append(rrb.Tabs(*tabs) if tabs else rrb.Horizontal(*map(_scene_views, scenes)))
    return rrb.Blueprint(
        rrb.Vertical(*rows) if len(rows) > 1 else rows[0],
        rrb.TimePanel(timeline="sim_time", state="collapsed", loop_mode="All"),
        collapse_panels=True,
    )


def _page_with_lanes(
    name: str, curves: Sequence[Curve], lanes: Sequence[Lane]
) -> rrb.Grid | rrb.Vertical:
    """A tab of plots below a time line of states, if there are any."""
    plots = _page(name, curves)
    if not lanes:
        return plots
    states = rrb.StateTimelineView(
        name="what happened",
        origin="/",
        contents=[f"/{lane.path}" for lane in lanes],
    )
    rows = -(-len(curves) // _PAGE_COLUMNS)
    shares = [_LANE_SHARE * (1 + len(lanes)), float(rows)]
    return rrb.Vertical(states, plots, row_shares=shares, name=name)


def _page(name: str, curves: Sequence[Curve]) -> rrb.Grid:
    """A tab of plots, two in a row; those in the first row have a legend.

    The ranges of the axes are set to show the whole curve: the viewer would choose them
    by the values near the time cursor when the file is opened, and there may be none.
    """
    views = [
        rrb.TimeSeriesView(
            name=curve.title,
            origin=f"/{curve.trace.path}",
            axis_x=_whole(curve.time_s),
            axis_y=rrb.ScalarAxis(range=_reach(curve.trace.values)),
            plot_legend=rrb.PlotLegend(visible=index < _PAGE_COLUMNS),
        )
        for index, curve in enumerate(curves)
    ]
    return rrb.Grid(*views, grid_columns=_PAGE_COLUMNS, name=name)


def _whole(time_s: FloatArray) -> rrb.TimeAxis:
    """Time axis from the first to the last of the times (ticks,)."""
    at = rrb.TimeRangeBoundary.absolute
    first, last = (at(seconds=float(time_s[row])) for row in (0, -1))
    return rrb.TimeAxis(view_range=rr.TimeRange(first, last))


def _reach(values: FloatArray) -> tuple[float, float]:
    """Range of an axis: all finite values, and a margin of `_MARGIN` on both sides."""
    known = values[np.isfinite(values)]
    low, high = (known.min(), known.max()) if known.size else (0.0, 0.0)
    margin = _MARGIN * (high - low) or max(abs(high), 1.0) * _MARGIN
    return float(low - margin), float(high + margin)


def _robot_view(scene: Scene) -> rrb.Spatial3DView:
    """View of the robot by a camera that follows it, ahead of it on its right."""
    at = f"/{scene.name}"
    size = scene.description.scale.length
    follow = rrb.EyeControls3D(
        position=(0.5 * size, -0.54 * size, 0.36 * size),
        look_target=(0.0, 0.0, 0.05 * size),
        tracking_entity=f"{at}/robot/{scene.description.root.name}",
    )
    return rrb.Spatial3DView(name=scene.title, origin=at, eye_controls=follow)


def _balance_view(scene: Scene) -> rrb.Spatial3DView:
    """View of soles and balance marks from above, following the robot; ahead is up."""
    at = f"/{scene.name}"
    robot = scene.description
    feet = [robot.links[foot.joint].link.name for foot in robot.feet]
    follow = rrb.EyeControls3D(
        position=(-0.02, 0.0, 0.55 * robot.scale.length),
        look_target=(0.0, 0.0, 0.0),
        tracking_entity=f"{at}/balance/below",
    )
    return rrb.Spatial3DView(
        name="from above",
        origin=at,
        contents=[
            f"{at}/ground",
            *(f"{at}/balance/{part}" for part in _ON_GROUND),
            f"{at}/fall",
            *(f"{at}/robot/{foot}/rim" for foot in feet),
        ],
        eye_controls=follow,
    )


def _scene_views(scene: Scene) -> rrb.Vertical:
    """Views of one scene: its robot, and its balance from above, above its curves."""
    rows, shares = _traces(scene)
    above = _robot_view(scene)
    if scene.description.feet:
        above = rrb.Horizontal(above, _balance_view(scene), column_shares=[3, 2])
    return rrb.Vertical(above, *rows, row_shares=[12, *shares])


def _scene_tab(scene: Scene) -> rrb.Horizontal | rrb.Spatial3DView:
    """Tab of one scene: its balance from above, beside its curves."""
    rows, shares = _traces(scene)
    views = [_balance_view(scene)] if scene.description.feet else []
    if rows:
        views.append(rrb.Vertical(*rows, row_shares=shares))
    return rrb.Horizontal(*views, column_shares=[1, 3][: len(views)], name=scene.name)


def _traces(scene: Scene) -> tuple[list[rrb.Horizontal | rrb.View], list[int]]:
    """Rows of plots, the last for the supporting legs, and their relative heights."""
    at = f"/{scene.name}"
    rows: list[rrb.Horizontal | rrb.View] = []
    for row in plots(scene):
        views = [
            rrb.TimeSeriesView(
                name=plot.name,
                contents=[f"{at}/{path}" for path in plot.paths],
                axis_x=_window(),
            )
            for plot in row
        ]
        rows.append(rrb.Horizontal(*views))
    shares = [4] * len(rows)
    lanes = [SUPPORT] if SUPPORT in scene.recording.columns else []
    lanes += [MEASURED_SUPPORT] if loaded_feet(scene) else []
    if lanes:
        view = rrb.StateTimelineView(
            name="support: planned and felt",
            origin=at,
            contents=[f"{at}/{lane}" for lane in lanes],
            time_view=_window(),
        )
        rows.append(view)
        shares.append(3)
    return rows, shares


def _window() -> rrb.TimeAxis:
    """Time axis from 2 s before to 1 s after the time cursor, so that steps show."""
    at = rrb.TimeRangeBoundary.cursor_relative
    return rrb.TimeAxis(view_range=rr.TimeRange(at(seconds=-2.0), at(seconds=1.0)))
