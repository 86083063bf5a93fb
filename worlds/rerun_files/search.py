"""Writes a search for gaits as a Rerun file: gaits and rewards of each generation.

The only timeline is `generation`. Curves show the whole search; the bars, the text and
the robot show the generation at the time cursor. The mean gait is the centre of the
distribution from which a generation is drawn. docs/seeing.md lists the entities, all
below `search/`.
"""

from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from groundwalk.arrays import FloatArray
from groundwalk.files import write_bytes
from worlds.rerun_files.scene_log import ColumnLog
from worlds.rerun_files.search_history import SearchHistory, search_page
from worlds.rerun_files.search_walk import walk_view, write_walks
from worlds.scenes import colours

TIMELINE = "generation"
_APPLICATION = "groundwalk-search"
"""Rerun's application id of searches. It differs from that of recordings, because the
viewer keeps one layout for each application."""

_BINS = 30
_PARAMETER_COLUMNS = 4
_MEAN, _BEST, _TRIED = colours.accent(0), colours.accent(1), colours.NEITHER_SIDE


def write_search(path: Path, history: SearchHistory, identity: str) -> None:
    """Write a search of at least one generation into one Rerun file, atomically.

    `identity` is the recording id; the viewer shows files with equal ids as one.
    """
    stream = rr.RecordingStream(_APPLICATION, recording_id=identity)
    file = stream.memory_recording()
    stream.send_blueprint(_layout(history))
    stream.send_recording_name(path.stem)
    tried = _tried(history)
    log = ColumnLog(stream, "search/", {TIMELINE: np.arange(len(tried))})
    _write_rewards(log, history, tried)
    _write_parameters(log, history)
    if history.walks:
        write_walks(stream, history.walks, TIMELINE, _BEST)
    _write_generations(stream, history, tried)
    write_bytes(path, file.drain_as_bytes())


def _tried(history: SearchHistory) -> FloatArray:
    """(generations, gaits) rewards, the best first; NaN fills up short generations."""
    tried = np.full((len(history.rewards), max(map(len, history.rewards))), np.nan)
    for row, rewards in zip(tried, history.rewards, strict=True):
        row[: len(rewards)] = np.sort(rewards)[::-1]
    return tried


def _write_rewards(log: ColumnLog, history: SearchHistory, tried: FloatArray) -> None:
    count = tried.shape[1]
    look = rr.SeriesPoints(
        colors=[_TRIED] * count, names=["tried"] * count, marker_sizes=[1.5] * count
    )
    _send(log, "reward/tried", tried, look)
    share = 100 * history.falls / np.array(list(map(len, history.rewards)))
    for path, name, values, colour in (
        ("reward/best", "best", np.nanmax(tried, axis=1), _BEST),
        ("reward/middle", "middle", np.nanmedian(tried, axis=1), colours.AXES[1]),
        ("reward/mean", "mean gait", history.mean_reward, _MEAN),
        ("falls", "fell [%]", share, colours.FALL),
    ):
        _send(log, path, values, _line(name, colour))


def _write_parameters(log: ColumnLog, history: SearchHistory) -> None:
    band = [colours.pale(_MEAN)] * 2
    for name, mean in history.mean.items():
        at, around = f"parameters/{name}", history.spread.get(name)
        if around is not None:
            edges = np.stack([mean - around, mean + around], axis=1)
            look = rr.SeriesLines(names=["mean - sd", "mean + sd"], colors=band)
            _send(log, f"{at}/spread", edges, look)
        _send(log, f"{at}/mean", mean, _line("mean", _MEAN))
        if name in history.best:
            _send(log, f"{at}/best", history.best[name], _line("best", _BEST))


def _write_generations(
    stream: rr.RecordingStream, history: SearchHistory, tried: FloatArray
) -> None:
    """Write the histogram of rewards and the text about each generation."""
    edges = np.linspace(np.nanmin(tried), np.nanmax(tried) + 1e-9, _BINS + 1)
    for generation, rewards in enumerate(history.rewards):
        bars = rr.BarChart(
            np.histogram(rewards, edges)[0],
            abscissa=(edges[:-1] + edges[1:]) / 2,
            widths=np.diff(edges).astype(np.float32),
            color=_MEAN,
        )
        page = search_page(history, generation)
        text = rr.TextDocument(page, media_type="text/markdown")
        stream.set_time(TIMELINE, sequence=generation)
        stream.log("search/rewards", bars, strict=True)
        stream.log("search/gait", text, strict=True)


def _send(log: ColumnLog, path: str, values: FloatArray, look: Any) -> None:
    """Write (generations,) or (generations, lines) values, drawn as `look` says."""
    log.show(path, look, rr.Scalars.columns(scalars=values))


def _line(name: str, colour: colours.Colour) -> rr.SeriesLines:
    return rr.SeriesLines(names=[name], colors=[colour])


def _layout(history: SearchHistory) -> rrb.Blueprint:
    """Layout: the walk beside the text on the generation, and tabs of curves below.

    Without walks there are no tabs: all rewards, the text and all curves are shown.
    """
    page = rrb.TextDocumentView(name="gaits of this generation", origin="search/gait")
    parameters = [_parameter_view(history, name) for name in history.mean]
    curves = []
    if parameters:
        columns = _PARAMETER_COLUMNS
        curves = [rrb.Grid(*parameters, grid_columns=columns, name="parameters")]
    if history.walks:
        robot = walk_view(history.walks, "best gait of this generation")
        above = rrb.Horizontal(robot, page, column_shares=[5, 2])
        rows = [above, rrb.Tabs(_reward_views(history, abreast=True), *curves)]
        shares = [5, 3]
    else:
        rewards = _reward_views(history, abreast=False)
        rows = [rrb.Horizontal(rewards, page, column_shares=[2, 1]), *curves]
        shares = [1] * len(rows)
    return rrb.Blueprint(
        rrb.Vertical(*rows, row_shares=shares),
        rrb.TimePanel(timeline=TIMELINE, state="collapsed", fps=1.0, loop_mode="All"),
        collapse_panels=True,
    )


def _reward_views(
    history: SearchHistory, abreast: bool
) -> rrb.Horizontal | rrb.Vertical:
    """Views of rewards, their histogram and falls, in a row if `abreast`."""
    unit = history.units.get("reward", "")
    rewards = rrb.TimeSeriesView(name=f"reward [{unit}]", origin="search/reward")
    others = (
        rrb.BarChartView(name=f"gaits by reward [{unit}]", origin="search/rewards"),
        rrb.TimeSeriesView(name="tried gaits that fell [%]", origin="search/falls"),
    )
    if abreast:
        shares = [2, 1, 1]
        return rrb.Horizontal(rewards, *others, column_shares=shares, name="rewards")
    return rrb.Vertical(rewards, rrb.Horizontal(*others), row_shares=[3, 2])


def _parameter_view(history: SearchHistory, name: str) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        name=f"{name} [{history.units[name]}]" if name in history.units else name,
        origin=f"search/parameters/{name}",
        plot_legend=rrb.PlotLegend(visible=False),
    )
