"""Figures of held-out recordings: motion and errors over time, and total errors."""

from typing import TYPE_CHECKING

import numpy as np

from diagnosis.conclude.held_out_series import HeldOutSeries, rms
from diagnosis.verdict import ChannelFit, Fit, Unexplained
from experiments.diagnosis_report.figure_style import (
    CONTROL,
    CORRECTED,
    NOISE,
    REAL,
    SIM,
    new_figure,
    note,
    plain,
)
from experiments.diagnosis_report.numbers import error_unit, errors_text
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
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
