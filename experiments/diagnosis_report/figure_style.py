"""Style of the figures of a diagnosis, and their conversion to SVG for its page."""

import html
import io
import re
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH_IN = 7.6
"""Width of a figure [inch]: that of the page's column of text."""

REAL, SIM, CORRECTED = "#1f2328", "#d55e00", "#0072b2"
"""Colours of the real recording, the sim and the corrected sim, which colour-blind
people can distinguish (Okabe and Ito)."""
CONTROL, FAINT, GRID, NOISE = "#a6acb5", "#6a737d", "#e6e8eb", "#eceff2"
"""Grey colours of bars for comparison, small text, grid lines, and the noise band."""


def new_figure(height_in: float) -> "Figure":
    """An empty figure of this height [inch], as wide as the page's column of text."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH_IN, height_in), layout="constrained")
    figure.patch.set_alpha(0.0)
    return figure


def plain(axes: "Axes", grid: Literal["x", "y"] | None = "y") -> None:
    """Remove the frame of axes, and put a faint grid behind what is drawn.

    Args:
      axes: the axes to change.
      grid: axis whose ticks get grid lines; None for no grid.
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


def note(axes: "Axes", text: str, at: tuple[float, float], colour: str = FAINT) -> None:
    """Write a small text right of the point `at` (in data coordinates of the axes)."""
    style: dict[str, Any] = {"va": "center", "fontsize": 8.5, "color": colour}
    axes.annotate(text, at, xytext=(4, 0), textcoords="offset points", **style)


def inline_svg(figure: "Figure", name: str, alternative: str) -> str:
    """A figure as an `<svg>` element; the same figure always gives the same bytes.

    Args:
      figure: a figure made without pyplot.
      name: begins the element's ids; no other figure of the page has it.
      alternative: description of the figure for people who cannot see it.
    """
    import matplotlib as mpl

    text = io.StringIO()
    with mpl.rc_context({"svg.fonttype": "none"}):
        figure.savefig(text, format="svg", metadata={"Date": None})
    svg = text.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>\s*", "", svg, flags=re.DOTALL)
    for size in ("width", "height"):
        svg = re.sub(rf'(<svg[^>]*?) {size}="[^"]*"', r"\1", svg, count=1)
    label = html.escape(alternative)
    svg = svg.replace("<svg", f'<svg role="img" aria-label="{label}"', 1)
    return _with_ids(svg, name)


def slim(svg: str) -> str:
    """An SVG of about half the size that looks the same on the page.

    Coordinates get two decimals (a hundredth of a point), and texts lose their lists of
    fonts, since the page's own font replaces these anyway.
    """
    svg = re.sub(r" ?font-family: [^;\"]*;", "", svg)
    svg = re.sub(r" transform=\"rotate\(-0 [^\"]*\"", "", svg)
    svg = re.sub(r"-?\d+\.\d{3,}", lambda match: f"{float(match[0]):.2f}", svg)
    return re.sub(r"\n\s*", "\n", svg)


def _with_ids(svg: str, name: str) -> str:
    """Keep only those ids in an SVG that are referred to, and rename them after `name`.

    Matplotlib's ids are random, or hashes that depend on rounding errors of the layout.
    """
    used = dict.fromkeys(re.findall(r'(?:url\(|href=")#([\w.]+)', svg))
    new = {old: f"{name}-{count}" for count, old in enumerate(used)}

    def identity(match: re.Match[str]) -> str:
        return f' id="{new[match[1]]}"' if match[1] in new else ""

    svg = re.sub(r' id="([\w.]+)"', identity, svg)
    return re.sub(
        r'(url\(|href=")#([\w.]+)', lambda match: f"{match[1]}#{new[match[2]]}", svg
    )
