"""How the figures of a diagnosis look."""

from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from matplotlib.axes import Axes

REAL, SIM, CORRECTED = "#1f2328", "#d55e00", "#0072b2"
"""Colours that colour-blind people tell apart (Okabe and Ito)."""
CONTROL, FAINT, GRID, NOISE = "#a6acb5", "#6a737d", "#e6e8eb", "#eceff2"


def plain(axes: "Axes", grid: Literal["x", "y"] | None = "y") -> None:
    """Axes without a frame, with a faint grid behind what is drawn.

    Args:
      axes: to be changed.
      grid: "x", "y" or None.
    """
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.spines["bottom"].set_color(CONTROL)
    axes.tick_params(length=0, colors=FAINT, labelsize=8.5)
    axes.set_axisbelow(True)
    axes.patch.set_alpha(0.0)
    for label in (axes.xaxis.label, axes.yaxis.label):
        label.set(color=FAINT, fontsize=9)
    if grid:
        axes.grid(axis=grid, color=GRID, linewidth=0.8)


def note(
    axes: "Axes",
    text: str,
    at: tuple[float, float],
    colour: str = FAINT,
    offset: tuple[float, float] = (4, 0),
) -> None:
    """A small text beside a point.

    Args:
      axes: to be drawn on.
      text: what it says.
      at: the point, in the axes' units.
      colour: of the text.
      offset: of the text's left end from the point [1/72 inch].
    """
    axes.annotate(
        text,
        at,
        xytext=offset,
        textcoords="offset points",
        va="center",
        fontsize=8.5,
        color=colour,
    )
