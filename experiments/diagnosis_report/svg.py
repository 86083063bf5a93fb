"""Figures as SVG inside of a page."""

import html
import io
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH_IN = 7.6
"""Of the page's column: one inch of a figure is one inch of the page."""


def new_figure(height_in: float) -> "Figure":
    """An empty figure as wide as the page's column."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH_IN, height_in), layout="constrained")
    figure.patch.set_alpha(0.0)
    return figure


def inline_svg(figure: "Figure", name: str, alternative: str) -> str:
    """A figure as an `<svg>` element, the same bytes each time.

    Args:
      figure: drawn without pyplot.
      name: no two figures of one page have the same, nor therefore the same ids.
      alternative: what it shows, for those who cannot see it.
    """
    import matplotlib as mpl

    text = io.StringIO()
    with mpl.rc_context({"svg.fonttype": "none"}):
        figure.savefig(text, format="svg", metadata={"Date": None})
    svg = text.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>\s*", "", svg, flags=re.DOTALL)
    svg = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", svg, count=1)
    svg = re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", svg, count=1)
    label = html.escape(alternative)
    svg = svg.replace("<svg", f'<svg role="img" aria-label="{label}"', 1)
    return _with_ids(svg, name)


def _with_ids(svg: str, name: str) -> str:
    """Only ids that are referred to, named after the figure and counted.

    Matplotlib's own are random, or hash the last digits of the layout.
    """
    used = dict.fromkeys(re.findall(r'(?:url\(|href=")#([\w.]+)', svg))
    new = {old: f"{name}-{count}" for count, old in enumerate(used)}

    def identity(match: re.Match[str]) -> str:
        return f' id="{new[match[1]]}"' if match[1] in new else ""

    svg = re.sub(r' id="([\w.]+)"', identity, svg)
    return re.sub(
        r'(url\(|href=")#([\w.]+)', lambda match: f"{match[1]}#{new[match[2]]}", svg
    )
