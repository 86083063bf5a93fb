"""A figure of what one joint shows: its curves with bands, and what they go with."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.seen import Curve, SeenJoint
from experiments.diagnosis_report.figure_style import (
    CONTROL,
    CORRECTED,
    FAINT,
    GRID,
    REAL,
    SIM,
    new_figure,
    note,
    plain,
)
from experiments.diagnosis_report.numbers import error_unit, percent

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HEADS = {
    "speed": "loss torque over speed",
    "load": "over the load",
    "position": "over position",
    "turn": "after a turn",
    "error": "tracking error over torque",
}
"""Title of the panel of each kind of curve, in the order of the panels."""

WAYS = {"both": REAL, "forward": REAL, "backward": SIM}
"""Colours of curves by the direction of motion."""

LAW = (0, (3, 1.5))
"""Dashes of the law that the effects found have."""

ROOM = 0.12
"""Room above and below what panels show, as a share of its height."""

NOTHING = 0.005
"""Share below which a bar is called nothing."""

TEXT_AT = 1.02
"""Place of the numbers beside bars, as a share: right of the longest bar."""


def joint_figure(joint: SeenJoint) -> "Figure":
    """Draw the curves of one joint as small panels, and its shares as bars.

    The four panels of loss torque have the same vertical axis. The law of the effects
    found is dashed; a straight dashed line through the tracking errors is what the
    declared stiffness of the servo says.
    """
    figure = new_figure(4.3)
    panels = figure.subplots(2, 3).ravel()
    of_loss = [one for one in joint.curves if one.kind != "error"]
    low, high = _reach(of_loss)
    for axes, (kind, head) in zip(panels, HEADS.items(), strict=False):
        curves = [one for one in joint.curves if one.kind == kind]
        _head(axes, head)
        if not curves:
            _nothing(axes, "too little to show")
            continue
        _draw(axes, curves)
        if kind == "error":
            _declared(axes, curves, joint.stiffness)
        else:
            axes.set_ylim(low, high)
    _ways(panels[1], joint)
    _shares(panels[5], joint)
    return figure


def _reach(curves: Sequence[Curve]) -> tuple[float, float]:
    """The ends of the vertical axis of curves; 0 is between them."""
    values = [0.0]
    for one in curves:
        values += [*one.low, *one.high, *(one.law or ())]
    low, high = min(values), max(values)
    room = ROOM * max(high - low, 1e-9)
    return low - room, high + room


def _draw(axes: "Axes", curves: Sequence[Curve]) -> None:
    """Draw curves of one kind with bands, and the law of what was found, if any."""
    largest = max(abs(value) for one in curves for value in (*one.low, *one.high))
    factor, unit = error_unit(curves[0].unit, largest)
    axes.axhline(0, color=CONTROL, lw=0.8)
    for one in curves:
        colour = WAYS[one.way]
        for at, values in _parts(one):
            low, middle, high, law = factor * values
            axes.fill_between(at, low, high, color=colour, alpha=0.18, lw=0)
            axes.plot(at, middle, marker="o", ms=2.2, lw=1.1, color=colour)
            if one.law is not None:
                axes.plot(at, law, color=CORRECTED, lw=1.5, ls=LAW, zorder=5)
    plain(axes)
    axes.tick_params(labelsize=7.5)
    axes.locator_params(axis="x", nbins=5)
    axes.locator_params(axis="y", nbins=5)
    axes.set_xlabel(f"{_short(curves[0])} [{curves[0].over_unit}]", fontsize=8)
    axes.set_ylabel(f"[{unit}]", fontsize=8)


def _parts(curve: Curve) -> list[tuple[np.ndarray, np.ndarray]]:
    """A curve's bins and (4, b) low, middle, high and law; each way of speed apart."""
    at = np.array(curve.at)
    law = curve.law if curve.law is not None else (0.0,) * len(at)
    values = np.array([curve.low, curve.middle, curve.high, law])
    if curve.kind != "speed":
        return [(at, values)]
    signs = (at < 0, at >= 0)
    return [(at[own], values[:, own]) for own in signs if own.any()]


def _short(curve: Curve) -> str:
    """The quantity on the horizontal axis, in a few words."""
    return {
        "torque that the motion needs": "needed torque",
        "travel since the last turn": "travel since it",
    }.get(curve.over, curve.over)


def _declared(axes: "Axes", curves: Sequence[Curve], stiffness: float | None) -> None:
    """Draw the error that the declared stiffness makes of the torque."""
    if not stiffness:
        return
    factor, _ = error_unit(curves[0].unit, _largest(curves))
    at = np.array([min(one.at[0] for one in curves), max(one.at[-1] for one in curves)])
    axes.plot(at, factor * at / stiffness, color=FAINT, lw=1, ls=LAW)


def _largest(curves: Sequence[Curve]) -> float:
    return max(abs(value) for one in curves for value in (*one.low, *one.high))


def _ways(axes: "Axes", joint: SeenJoint) -> None:
    """Say which colour is which direction, and what the dashes are."""
    from matplotlib.lines import Line2D

    shown = {one.way for one in joint.curves}
    lines = [
        Line2D([], [], label=way, lw=1.4, color=colour)
        for way, colour in WAYS.items()
        if way in shown and way != "both"
    ]
    if any(one.law is not None for one in joint.curves):
        label = "what was found"
        lines.append(Line2D([], [], label=label, lw=1.4, color=CORRECTED, ls=LAW))
    if lines:
        axes.figure.legend(
            handles=lines, loc="outside upper right", ncols=3, frameon=False, fontsize=8
        )


def _shares(axes: "Axes", joint: SeenJoint) -> None:
    """Draw for each quantity the share of the variance that goes with it."""
    _head(axes, "its variance goes with")
    if joint.together is None:
        _nothing(axes, "too little to tell")
        return
    names = [*(one.name for one in joint.shares), "all together"]
    alone = [*(one.alone for one in joint.shares), joint.together]
    colours = [CONTROL] * len(joint.shares) + [REAL]
    rows = range(len(names))
    axes.barh(rows, alone, height=0.62, color=colours)
    lost = [one.lost for one in joint.shares]
    axes.barh(rows[:-1], lost, height=0.62, color=REAL)
    for row, share in enumerate(alone):
        text = percent(share) if share >= NOTHING else "nothing"
        note(axes, text, (TEXT_AT, row))
    plain(axes, grid=None)
    if joint.noise_share is not None:
        axes.axvline(1 - joint.noise_share, color=FAINT, lw=1, ls=(0, (1, 1.5)))
    axes.set_yticks(rows, names)
    axes.tick_params(axis="y", labelcolor=REAL, labelsize=7.5)
    axes.set_xticks([])
    axes.set_xlim(0, 1.45)
    axes.set_ylim(len(names) - 0.4, -0.6)


def _nothing(axes: "Axes", text: str) -> None:
    """Say in an empty panel why it is empty."""
    plain(axes, grid=None)
    axes.set_xticks([])
    axes.set_yticks([])
    axes.spines["bottom"].set_color(GRID)
    style = {"ha": "center", "va": "center", "fontsize": 8.5, "color": FAINT}
    axes.text(0.5, 0.5, text, style, transform=axes.transAxes)


def _head(axes: "Axes", text: str) -> None:
    """Write a panel's title."""
    axes.set_title(text, loc="left", fontsize=8.5, color=FAINT)
