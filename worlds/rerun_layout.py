"""How Rerun's viewer lays out a file: where robots, curves and feet are to be seen."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from worlds.recording_columns import SUPPORT
from worlds.scene import Scene
from worlds.scene_traces import Curve, Plot, plots

if TYPE_CHECKING:
    import rerun.blueprint as rrb

_PAGE_COLUMNS = 2


def blueprint(
    scenes: Sequence[Scene], pages: Mapping[str, Sequence[Curve]]
) -> "rrb.Blueprint":
    """Everything at once: scenes from left to right, each above its traces.

    Args:
      scenes: what the file shows, each below its own name.
      pages: curves by the name of their page; if there are any, they stand below the
        scenes, of which only the robots are shown then.
    """
    import rerun.blueprint as rrb

    view = _robot_view if pages else _scene_views
    rows = [rrb.Horizontal(*map(view, scenes))] if scenes else []
    if pages:
        rows.append(rrb.Tabs(*(_page(*page) for page in pages.items())))
    return rrb.Blueprint(
        rrb.Vertical(*rows) if len(rows) > 1 else rows[0],
        rrb.TimePanel(timeline="sim_time", state="collapsed", loop_mode="All"),
        collapse_panels=True,
    )


def _page(name: str, curves: Sequence[Curve]) -> "rrb.Grid":
    """Curves side by side; what the colours mean is said in the first row."""
    import rerun.blueprint as rrb

    views = [
        rrb.TimeSeriesView(
            name="/".join(trace.path.split("/")[-2:]),
            origin=f"/{trace.path}",
            plot_legend=rrb.PlotLegend(visible=index < _PAGE_COLUMNS),
        )
        for index, (_, trace) in enumerate(curves)
    ]
    return rrb.Grid(*views, grid_columns=_PAGE_COLUMNS, name=name)


def _robot_view(scene: Scene) -> "rrb.Spatial3DView":
    """The robot, followed from its front right."""
    import rerun.blueprint as rrb

    at = f"/{scene.name}"
    follow = rrb.EyeControls3D(
        position=(0.7, -0.75, 0.5),
        look_target=(0.0, 0.0, 0.1),
        tracking_entity=f"{at}/robot/{scene.description.root.name}",
    )
    return rrb.Spatial3DView(name=scene.title, origin=at, eye_controls=follow)


def _scene_views(scene: Scene) -> "rrb.Vertical":
    """The robot above what it did and felt."""
    import rerun.blueprint as rrb

    at = f"/{scene.name}"
    rows = [
        rrb.Horizontal(*(_plot_view(at, plot) for plot in row)) for row in plots(scene)
    ]
    views = [_robot_view(scene), *rows]
    shares = [6, *(2 for _ in rows)]
    if SUPPORT in scene.recording.columns:
        lane = f"{at}/{SUPPORT}"
        views.append(
            rrb.StateTimelineView(name="support", origin=lane, time_view=_window())
        )
        shares.append(1)
    return rrb.Vertical(*views, row_shares=shares)


def _plot_view(at: str, plot: Plot) -> "rrb.TimeSeriesView":
    import rerun.blueprint as rrb

    return rrb.TimeSeriesView(
        name=plot.name,
        contents=[f"{at}/{path}" for path in plot.paths],
        axis_x=_window(),
        plot_legend=rrb.PlotLegend(visible=plot.has_key),
    )


def _window() -> "rrb.TimeAxis":
    """A few seconds around the time cursor: a whole course would be a blur."""
    import rerun as rr
    import rerun.blueprint as rrb

    start = rrb.TimeRangeBoundary.cursor_relative(seconds=-2.0)
    end = rrb.TimeRangeBoundary.cursor_relative(seconds=1.0)
    return rrb.TimeAxis(view_range=rr.TimeRange(start, end))
