"""Figure of the NAO study: how fast each gait is, and how often it falls."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from experiments.reports.statistics import wilson

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIGURE = "transfer_nao.png"
COLOURS = ("0.6", "#56b4e9", "#0072b2")
"""Colours of the grounding steps 0, 1 and 2."""


def cells_figure(cells: Sequence[Mapping[str, Any]]) -> "Figure":
    """A row for each cell: speed with standard deviation, falls with 95 % interval.

    A cell is the result of one method after one grounding step.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 0.4 * len(cells) + 1.2), dpi=160)
    figure.set_layout_engine("constrained")
    speeds, falls = figure.subplots(1, 2, sharey=True)
    rows = sorted(cells, key=lambda cell: cell["step"])
    for y, cell in enumerate(rows):
        colour = COLOURS[min(cell["step"], 2)]
        speeds.barh(
            y, cell["speed_mean"], xerr=cell["speed_std"], color=colour, ecolor="0.3"
        )
        share = cell["falls"] / cell["trials"]
        low, high = wilson(cell["falls"], cell["trials"])
        falls.plot([100 * low, 100 * high], [y, y], color=colour, linewidth=3)
        falls.plot(100 * share, y, "o", color=colour)
    labels = [f"{cell['method']}, step {cell['step']}" for cell in rows]
    speeds.set_yticks(range(len(rows)), labels)
    speeds.invert_yaxis()
    speeds.set_xlabel("speed [cm/s]")
    falls.set(xlabel="falls [%], 95 % interval", xlim=(0, 100))
    for panel in (speeds, falls):
        panel.spines[["top", "right"]].set_visible(False)
    return figure
