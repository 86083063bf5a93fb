"""Figure of each gait's predicted fall rate and speed against the real ones."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from experiments.transfer.nao_studies.falls_measures import GROUNDINGS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIGURE = "transfer_nao_falls.png"

PANELS = (("fall_rate", "fall rate", 1.0), ("speed_cm_s", "speed [cm/s]", 40.0))
"""For each row of panels: key of the results, label, and upper end of the axes."""


def falls_figure(state: Mapping[str, Any]) -> "Figure":
    """A column for each grounding: fall rates above, speeds below.

    `state` has the fall rates and speeds [cm/s] of the gaits, in the real world
    ("real") and as each grounding's sim predicts them.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 5.4), dpi=160, layout="constrained")
    axes = figure.subplots(2, len(GROUNDINGS), sharex="row", sharey="row")
    for column, name in enumerate(GROUNDINGS):
        for row, (key, label, largest) in enumerate(PANELS):
            panel = axes[row, column]
            panel.plot([0, largest], [0, largest], color="0.75", linewidth=1)
            panel.scatter(state["real"][key], state[name][key], s=22, color="#0072b2")
            panel.set(xlabel=f"real {label}", aspect="equal")
            panel.spines[["top", "right"]].set_visible(False)
            if column == 0:
                panel.set_ylabel(f"predicted {label}")
        axes[0, column].set_title(name)
    return figure
