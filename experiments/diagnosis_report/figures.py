"""Figures of held-out motion and errors, of total errors, and of the mismatch map.

The map shows errors by channel, part of the data, and time.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.conclude.held_out_series import HeldOutSeries, rms
from diagnosis.verdict import ChannelFit, Fit, MismatchCell, Unexplained
from experiments.diagnosis_report.figure_style import (
    CONTROL,
    CORRECTED,
    FAINT,
    NOISE,
    REAL,
    SIM,
    new_figure,
    note,
    plain,
)
from experiments.diagnosis_report.numbers import error_unit, errors_text, percent
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CLOSE_UP_S = 1.0
"""Duration of a close-up of a motion [s]: long enough for one or two reversals."""
BARS = {
    "nominal": ("the nominal sim", SIM),
    "wrong_effect": ("control: another effect at this place", CONTROL),
    "wrong_place": ("control: the same effect at another place", CONTROL),
    "corrected": ("the corrected sim", CORRECTED),
    "ceiling": ("a regression without physics", CONTROL),
}
"""Label and colour of the bar of each error of a verdict, from top to bottom."""
UNCORRECTED = ("nominal", "ceiling")
"""The keys of `BARS` that are drawn if no effect was found, so nothing corrected."""


def overlay_figure(
    series: HeldOutSeries, channel: str, errors: ChannelFit | None, is_corrected: bool
) -> "Figure":
    """Draw a close-up of a channel, and below it the errors over the whole recording.

    Args:
      series: a held-out recording.
      channel: name of one of its channels.
      errors: the channel's unit and its noise floor, twice of which is shaded; None if
        they are unknown.
      is_corrected: whether the corrected sim is shown, too.
    """
    real, sim, corrected = series.channels[channel]
    rows = close_up(series.time_s, real, sim)
    figure = new_figure(3.6)
    above, below = figure.subplots(2, 1, height_ratios=(3, 2))
    time_s = series.time_s[rows]
    above.plot(time_s, sim[rows], color=SIM, lw=1.3, label="sim")
    wrong = {SIM: sim - real}
    if is_corrected:
        after = corrected[rows]
        above.plot(time_s, after, color=CORRECTED, lw=1.3, label="corrected sim")
        wrong[CORRECTED] = corrected - real
    above.plot(time_s, real[rows], color=REAL, lw=1.6, ls=(0, (4, 1.5)), label="real")
    unit = errors.unit if errors else "SI unit"
    above.set_ylabel(f"{channel}\n[{unit}]")
    above.legend(
        frameon=False, ncols=3, loc="lower left", bbox_to_anchor=(0, 1), fontsize=8.5
    )
    factor, unit = error_unit(unit, max(map(rms, wrong.values())))
    if errors and errors.floor:
        high = 2 * factor * errors.floor
        below.axhspan(-high, high, color=NOISE, zorder=1)
    for colour, error in wrong.items():
        below.plot(series.time_s, factor * error, color=colour, lw=0.8)
    below.set_ylabel(f"error [{unit}]")
    below.set_xlabel("time [s]")
    below.axvspan(time_s[0], time_s[-1], color="#fff3c4", zorder=0, lw=0)
    for axes in (above, below):
        plain(axes)
        axes.margins(x=0)
    figure.align_ylabels()
    return figure


def close_up(time_s: FloatArray, real: FloatArray, sim: FloatArray) -> slice:
    """Choose the second of a recording in which the error is large and easy to see.

    It is the window in which the error is largest relative to the range of the motion,
    among those with at least half the squared error of the worst window. Times,
    measured and predicted values are (T,), with NaN where a measured one is missing.
    """
    rows = int(np.searchsorted(time_s, time_s[0] + CLOSE_UP_S, side="right"))
    windows = np.lib.stride_tricks.sliding_window_view
    energy = windows(np.nan_to_num(real - sim) ** 2, rows).sum(axis=1)
    span = np.ptp(windows(np.nan_to_num(real), rows), axis=1)
    beside = np.divide(energy, span**2, out=np.zeros_like(energy), where=span > 0)
    beside[energy < 0.5 * energy.max()] = -1.0
    best = int(np.argmax(beside))
    return slice(best, best + rows)


def bars_figure(fit: Fit, is_corrected: bool) -> "Figure":
    """Draw bars of the errors of all channels together, in units of the noise floor.

    Without a corrected sim the controls, which replace its effects, are left out, too.
    """
    bars = BARS if is_corrected else UNCORRECTED
    known = [name for name in bars if getattr(fit, name) is not None]
    errors = [getattr(fit, name) for name in known]
    figure = new_figure(0.3 * len(known) + 0.75)
    axes = figure.subplots()
    rows = range(len(known))
    axes.barh(rows, errors, height=0.62, color=[BARS[name][1] for name in known])
    for row, text in enumerate(errors_text(errors)):
        note(axes, text, (errors[row], row))
    plain(axes, grid="x")
    axes.axvline(fit.floor, color=REAL, lw=1, ls=(0, (3, 2)))
    note(axes, "noise floor", (fit.floor, -0.75), REAL)
    axes.set_yticks(rows, [BARS[name][0] for name in known])
    axes.tick_params(axis="y", labelcolor=REAL)
    axes.set_xlim(0, 1.12 * max(*errors, fit.floor))
    axes.set_ylim(len(known) - 0.5, -1.0)
    axes.set_xlabel("rms error on held-out recordings [multiples of the noise floor]")
    return figure


def unexplained_figure(rest: Unexplained) -> "Figure":
    """Draw the mean unexplained error over another quantity, +- two standard errors."""
    at, mean, spread = (np.array(part) for part in (rest.at, rest.mean, rest.spread))
    largest = float(np.abs(mean).max(initial=0.0))
    factor, unit = error_unit(rest.unit, largest)
    figure = new_figure(2.4)
    axes = figure.subplots()
    low, high = factor * (mean - 2 * spread), factor * (mean + 2 * spread)
    axes.fill_between(at, low, high, color=CORRECTED, alpha=0.18, lw=0)
    axes.plot(at, factor * mean, "o-", color=CORRECTED, ms=3, lw=1.3)
    axes.axhline(0, color=REAL, lw=0.8)
    plain(axes)
    axes.set_xlabel(f"{rest.against} [{rest.against_unit}]")
    axes.set_ylabel(f"mean error of\n{rest.channel} [{unit}]")
    return figure


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
