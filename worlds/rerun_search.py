"""A search as a Rerun file: what each generation tried, and what it came to.

Its one timeline is `generation`. What is drawn over it shows the whole search; bars
and page show the generation under the cursor.

| entity | what |
|---|---|
| `search/reward/{best,middle}` | reward of the best and of the middle gait tried |
| `search/reward/{mean,tried}` | of the mean gait, and points: of every gait tried |
| `search/rewards` | bars: how many gaits got how much |
| `search/falls` | how many of the tried gaits fell [%] |
| `search/parameters/<name>/{mean,spread}` | mean gait, and one deviation around it |
| `search/parameters/<name>/best` | of the best gait, where the history has it |
| `search/gait` | page: parameters of the best gait and of the mean |
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.files import write_bytes
from worlds import scene_colours as colours

if TYPE_CHECKING:
    import rerun as rr
    import rerun.blueprint as rrb

TIMELINE = "generation"
_APPLICATION = "groundwalk-search"
"""Not that of walks: the viewer has one layout for each application."""

_BINS = 30
_PARAMETER_COLUMNS = 4
_MEAN, _BEST, _TRIED = colours.accent(0), colours.accent(1), colours.NEITHER_SIDE


class SearchHistory(NamedTuple):
    """What a search tried; its rows are generations."""

    rewards: Sequence[FloatArray]
    """Of the gaits that were tried, each generation's."""
    falls: FloatArray
    """(generations,) how many of them fell."""
    mean_reward: FloatArray
    """(generations,) of the gait in the middle of the distribution."""
    mean: Mapping[str, FloatArray]
    """(generations,) each parameter of that gait."""
    spread: Mapping[str, FloatArray]
    """(generations,) standard deviation of each parameter, in its own unit."""
    best: Mapping[str, FloatArray]
    """(generations,) each parameter of the best gait; empty where it is not known."""
    units: Mapping[str, str]
    """Of parameters and, as "reward", of the reward."""


def write_search(path: Path, history: SearchHistory, identity: str) -> None:
    """Write a search into one Rerun file, the file at once.

    Args:
      path: the `.rrd` file.
      history: at least one generation.
      identity: to the viewer, files of one identity are one recording.
    """
    import rerun as rr

    stream = rr.RecordingStream(_APPLICATION, recording_id=identity)
    file = stream.memory_recording()
    stream.send_blueprint(_layout(history))
    stream.send_recording_name(path.stem)
    _write_rewards(stream, history)
    _write_parameters(stream, history)
    for generation in range(len(history.rewards)):
        _write_generation(stream, history, generation)
    write_bytes(path, file.drain_as_bytes())


def _write_rewards(stream: "rr.RecordingStream", history: SearchHistory) -> None:
    import rerun as rr

    tried = _tried(history)
    count = tried.shape[1]
    look = rr.SeriesPoints(
        colors=[_TRIED] * count, names=["tried"] * count, marker_sizes=[1.5] * count
    )
    _send(stream, "reward/tried", tried, look)
    for name, values, colour in (
        ("best", np.nanmax(tried, axis=1), _BEST),
        ("middle", np.nanmedian(tried, axis=1), colours.AXES[1]),
        ("mean gait", history.mean_reward, _MEAN),
    ):
        _send(stream, f"reward/{name.split()[0]}", values, _line(name, colour))
    counts = np.array([len(rewards) for rewards in history.rewards])
    share = 100 * history.falls / counts
    _send(stream, "falls", share, _line("fell [%]", colours.FALL))


def _write_parameters(stream: "rr.RecordingStream", history: SearchHistory) -> None:
    import rerun as rr

    band = [colours.pale(_MEAN)] * 2
    for name, mean in history.mean.items():
        around = history.spread.get(name)
        if around is not None:
            edges = np.stack([mean - around, mean + around], axis=1)
            look = rr.SeriesLines(names=["mean - sd", "mean + sd"], colors=band)
            _send(stream, f"parameters/{name}/spread", edges, look)
        _send(stream, f"parameters/{name}/mean", mean, _line("mean", _MEAN))
        if name in history.best:
            best = history.best[name]
            _send(stream, f"parameters/{name}/best", best, _line("best", _BEST))


def _write_generation(
    stream: "rr.RecordingStream", history: SearchHistory, generation: int
) -> None:
    """What is shown of one generation at a time."""
    import rerun as rr

    tried = _tried(history)
    edges = np.linspace(np.nanmin(tried), np.nanmax(tried) + 1e-9, _BINS + 1)
    bars = rr.BarChart(
        np.histogram(history.rewards[generation], edges)[0],
        abscissa=(edges[:-1] + edges[1:]) / 2,
        widths=np.diff(edges).astype(np.float32),
        color=_MEAN,
    )
    stream.set_time(TIMELINE, sequence=generation)
    stream.log("search/rewards", bars, strict=True)
    page = rr.TextDocument(_page(history, generation), media_type="text/markdown")
    stream.log("search/gait", page, strict=True)


def _page(history: SearchHistory, generation: int) -> str:
    """The gaits of a generation as a table in Markdown."""
    best = float(np.max(history.rewards[generation]))
    mean = float(history.mean_reward[generation])
    unit = history.units.get("reward", "")
    lines = [
        f"## Generation {generation}",
        "",
        f"Reward of the best gait {best:.1f}, of the mean gait {mean:.1f} {unit}.",
        "",
        "| parameter | unit | best gait | mean | spread |",
        "|---|---|---:|---:|---:|",
    ]
    for name in history.mean:
        columns = (history.best, history.mean, history.spread)
        cells = [_cell(column, name, generation) for column in columns]
        lines.append(
            " | ".join((f"| {name}", history.units.get(name, ""), *cells)) + " |"
        )
    return "\n".join(lines)


def _cell(column: Mapping[str, FloatArray], name: str, generation: int) -> str:
    return f"{column[name][generation]:.4g}" if name in column else ""


def _tried(history: SearchHistory) -> FloatArray:
    """(generations, gaits) rewards from the best on, NaN where fewer were tried."""
    tried = np.full((len(history.rewards), max(map(len, history.rewards))), np.nan)
    for row, rewards in zip(tried, history.rewards, strict=True):
        row[: len(rewards)] = np.sort(rewards)[::-1]
    return tried


def _send(
    stream: "rr.RecordingStream", path: str, values: FloatArray, look: Any
) -> None:
    """Send (generations,) or (generations, lines) values and what they look like."""
    import rerun as rr

    stream.log(f"search/{path}", look, static=True, strict=True)
    index = rr.TimeColumn(TIMELINE, sequence=np.arange(len(values)))
    columns = rr.Scalars.columns(scalars=values)
    stream.send_columns(f"search/{path}", [index], columns, strict=True)


def _line(name: str, colour: colours.Colour) -> "rr.SeriesLines":
    import rerun as rr

    return rr.SeriesLines(names=[name], colors=[colour])


def _layout(history: SearchHistory) -> "rrb.Blueprint":
    """Rewards and falls beside the generation's gait, the parameters below."""
    import rerun.blueprint as rrb

    unit = history.units.get("reward", "")
    rewards = rrb.Vertical(
        rrb.TimeSeriesView(name=f"reward [{unit}]", origin="search/reward"),
        rrb.Horizontal(
            rrb.BarChartView(name=f"gaits by reward [{unit}]", origin="search/rewards"),
            rrb.TimeSeriesView(name="tried gaits that fell [%]", origin="search/falls"),
        ),
        row_shares=[3, 2],
    )
    page = rrb.TextDocumentView(name="gaits of this generation", origin="search/gait")
    parameters = [
        rrb.TimeSeriesView(
            name=f"{name} [{history.units[name]}]" if name in history.units else name,
            origin=f"search/parameters/{name}",
            plot_legend=rrb.PlotLegend(visible=False),
        )
        for name in history.mean
    ]
    rows: list[rrb.Horizontal | rrb.Grid] = [
        rrb.Horizontal(rewards, page, column_shares=[2, 1])
    ]
    if parameters:
        rows.append(rrb.Grid(*parameters, grid_columns=_PARAMETER_COLUMNS))
    return rrb.Blueprint(
        rrb.Vertical(*rows),
        rrb.TimePanel(timeline=TIMELINE, state="collapsed"),
        collapse_panels=True,
    )
