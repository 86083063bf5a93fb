"""Figure of the mismatch map: errors by channel, part of the data, and time."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.verdict import MismatchCell
from experiments.diagnosis_report.figure_style import (
    FAINT,
    REAL,
    SIM,
    new_figure,
    note,
    plain,
)
from experiments.diagnosis_report.numbers import percent

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MOST_ROWS = 12
"""Largest number of channels (rows) in the map."""
_FEW_ROWS, _SMALL_SHARE = 4, 0.005
"""Number of channels that are always shown, and share of the mismatch below which any
further channel is left out."""
_SHARE_WIDTH, _CELL_WIDTH, _BURST_WIDTH = 2.0, 0.9, 2.6
"""Relative widths of the panel of bars, of a column of cells, and of the time axis."""
_LEAST_TOP = 0.7
"""Cells are darkest at the largest error, but at least at this decimal logarithm of the
error [noise floors], so that errors near the noise stay pale."""
_DARK = 0.6
"""Share of the colour scale above which the number in a cell is white, not black."""


def worst_cells(cells: Sequence[MismatchCell]) -> list[MismatchCell]:
    """Choose the channels that the mismatch map shows, the worst first."""
    ranked = sorted(cells, key=lambda cell: -cell.share)[:_MOST_ROWS]
    return [
        cell
        for rank, cell in enumerate(ranked)
        if rank < _FEW_ROWS or cell.share >= _SMALL_SHARE
    ]


def mismatch_figure(rows: Sequence[MismatchCell]) -> "Figure":
    """Draw for each channel its share of the mismatch, its errors and its bursts.

    Errors are given for each part of the data (regime), such as "reversals"; a burst is
    a short time with large errors. Panels without content are left out. The channels
    `rows`, at least one, come from top to bottom.
    """
    regimes = list(dict.fromkeys(name for cell in rows for name in cell.regimes))
    has_bursts = any(cell.bursts for cell in rows)
    regimes_width = [_CELL_WIDTH * len(regimes)] * bool(regimes)
    widths = [_SHARE_WIDTH, *regimes_width, *([_BURST_WIDTH] * has_bursts)]
    figure = new_figure(0.27 * len(rows) + 1.3)
    panels = figure.subplots(
        1, len(widths), squeeze=False, sharey=True, width_ratios=widths
    )[0]
    _draw_shares(panels[0], rows)
    if regimes:
        _draw_regimes(panels[1], rows, regimes)
    if has_bursts:
        _draw_bursts(panels[-1], rows)
    return figure


def _draw_shares(axes: "Axes", rows: Sequence[MismatchCell]) -> None:
    shares = [100 * cell.share for cell in rows]
    axes.barh(range(len(rows)), shares, height=0.62, color=SIM, alpha=0.85)
    for row, cell in enumerate(rows):
        note(axes, percent(cell.share), (shares[row], row))
    plain(axes, grid=None)
    axes.set_yticks(range(len(rows)), [cell.channel for cell in rows])
    axes.tick_params(axis="y", labelcolor=REAL)
    axes.set_xticks([])
    axes.spines["bottom"].set_visible(False)
    axes.set_xlim(0, 1.35 * max(*shares, 1))
    axes.set_ylim(len(rows) - 0.5, -0.5)
    _head(axes, "share of\nthe mismatch")


def _draw_regimes(
    axes: "Axes", rows: Sequence[MismatchCell], regimes: Sequence[str]
) -> None:
    """Draw errors as cells, the darker the larger the logarithm of the error is."""
    from matplotlib.colors import LinearSegmentedColormap

    colours = LinearSegmentedColormap.from_list(
        "mismatch", ["#f7f4f1", "#f0b27a", SIM, "#6e2a00"]
    )
    values = np.array(
        [[cell.regimes.get(name, np.nan) for name in regimes] for cell in rows]
    )
    depth = np.log10(np.maximum(values, 1.0))
    top = max(float(np.nanmax(depth)), _LEAST_TOP)
    edges = [np.arange(size + 1) - 0.5 for size in reversed(depth.shape)]
    mesh = axes.pcolormesh(*edges, depth, cmap=colours, vmin=0, vmax=top)
    mesh.set(edgecolor="white", linewidth=1.5)
    for (row, column), value in np.ndenumerate(values):
        if np.isfinite(value):
            light = depth[row, column] > _DARK * top
            text = f"{value:.1f}" if value < 9.95 else f"{value:.0f}"
            colour = "white" if light else REAL
            centred = {"ha": "center", "va": "center", "fontsize": 8, "color": colour}
            axes.text(column, row, text, centred)
    plain(axes, grid=None)
    axes.spines["bottom"].set_visible(False)
    axes.set_xticks(range(len(regimes)), regimes)
    axes.tick_params(axis="x", labelrotation=35)
    for label in axes.get_xticklabels():
        label.set(ha="right", rotation_mode="anchor")
    axes.tick_params(axis="y", left=False)
    axes.set_xlim(-0.5, len(regimes) - 0.5)
    axes.set_ylim(len(rows) - 0.5, -0.5)
    _head(axes, "error in multiples\nof the noise floor")


def _draw_bursts(axes: "Axes", rows: Sequence[MismatchCell]) -> None:
    for row, cell in enumerate(rows):
        spans = [(start_s, end_s - start_s) for start_s, end_s in cell.bursts]
        axes.broken_barh(spans, (row - 0.31, 0.62), color=SIM, alpha=0.85, lw=1)
    plain(axes, grid="x")
    axes.set_xlabel("time [s]")
    _head(axes, "times with\nlarge errors")


def _head(axes: "Axes", text: str) -> None:
    """Write a panel's title in two lines, so that it does not reach the next panel."""
    axes.set_title(text, loc="left", fontsize=8.5, color=FAINT)
