"""The recordings' time lines on the page: what was used for what, what happened."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from diagnosis.effects import effect as kind_of
from diagnosis.traces.time_line import Stretch
from experiments.diagnosis_report.figure_style import (
    CONTROL,
    CORRECTED,
    NOISE,
    REAL,
    SIM,
    inline_svg,
    new_figure,
    plain,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_EVENTS = 12
"""Largest number of events that are listed below the figure."""

MOST_ROWS = 24
"""Largest number of recordings that are drawn, those with events first."""

USES = {
    "fitted": CORRECTED,
    "selected": "#7fb8d8",
    "held out": REAL,
    "not used": NOISE,
}
"""Colours of the uses, in the order of the legend."""

EVENTS = {
    "stall": ("|", SIM),
    "wrong sample": ("x", SIM),
    "pulse": ("v", "#cc79a7"),
    "effect": ("v", "#e69f00"),
}
"""Marker and colour of each kind of event, in the order of the legend."""

_ROW_IN, _REST_IN = 0.24, 1.2
_BAR, _ABOVE = 0.55, 0.45
"""Height of a bar, and that of the marks above its middle, in rows."""


def time_line_shown(stretches: Sequence[Stretch]) -> dict[str, Any]:
    """What the page's template shows of time lines: a figure, and a list of events."""
    told = [one for one in stretches if one.what in EVENTS]
    count = len({one.recording for one in stretches})
    alternative = "uses and events of the recordings over time"
    return {
        "svg": inline_svg(time_line_figure(stretches), "time-line", alternative),
        "events": list(map(event_words, told[:MOST_EVENTS])),
        "more_events": max(0, len(told) - MOST_EVENTS),
        "more_recordings": max(0, count - MOST_ROWS),
    }


def event_words(one: Stretch) -> str:
    """An event as a text, such as "walk, 3.1 to 3.6 s: pulse at elbow, 2 N m"."""
    times = f"{one.start_s:.4g}"
    if one.end_s > one.start_s:
        times += f" to {one.end_s:.4g}"
    where = f" at {one.channel}" if one.channel else ""
    what = kind_of(one.why).words.label if one.what == "effect" else one.what
    why = f", {one.why}" if one.why and one.what != "effect" else ""
    return f"{one.recording}, {times} s: {what}{where}{why}"


def time_line_figure(stretches: Sequence[Stretch]) -> "Figure":
    """Draw a bar for each recording, coloured by use, with marks for what happened."""
    names = drawn_recordings(stretches)
    figure = new_figure(_REST_IN + _ROW_IN * max(len(names), 2))
    axes = figure.subplots()
    rows = {name: len(names) - 1 - row for row, name in enumerate(names)}
    known = [one for one in stretches if one.recording in rows]
    for one in known:
        _draw(axes, one, rows[one.recording])
    axes.set_yticks(list(rows.values()), list(rows))
    axes.set_ylim(-0.6, len(names) - 0.2)
    axes.set_xlabel("time in the recording [s]")
    axes.margins(x=0.01)
    plain(axes, grid="x")
    _legend(axes, {one.what for one in known})
    return figure


def drawn_recordings(stretches: Sequence[Stretch]) -> list[str]:
    """Names of the recordings that are drawn, in their order."""
    names = list(dict.fromkeys(one.recording for one in stretches))
    eventful = {one.recording for one in stretches if one.what in EVENTS}
    first = sorted(names, key=lambda name: name not in eventful)[:MOST_ROWS]
    return [name for name in names if name in first]


def _draw(axes: "Axes", one: Stretch, row: int) -> None:
    if one.what in USES:
        where = [(one.start_s, one.end_s - one.start_s)]
        height = (row - _BAR / 2, _BAR)
        line = CONTROL if one.what == "not used" else "none"
        axes.broken_barh(where, height, color=USES[one.what], ec=line, lw=0.5)
        return
    marker, colour = EVENTS[one.what]
    at = row + _ABOVE
    if one.end_s > one.start_s:
        axes.plot([one.start_s, one.end_s], [at, at], color=colour, lw=2.0)
    axes.plot([one.start_s], [at], marker, color=colour, ms=5, mew=1.4)


def _legend(axes: "Axes", kinds: set[str]) -> None:
    """A legend of the kinds that are drawn."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    uses = [Patch(color=c, label=name) for name, c in USES.items() if name in kinds]
    events = [
        Line2D([], [], ls="", marker=marker, color=colour, mew=1.4, label=name)
        for name, (marker, colour) in EVENTS.items()
        if name in kinds
    ]
    axes.legend(
        handles=[*uses, *events],
        frameon=False,
        ncols=min(4, len(uses) + len(events)),
        loc="lower left",
        bbox_to_anchor=(0, 1),
        fontsize=8.5,
    )
