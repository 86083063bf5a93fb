"""Figures of the terrain stress test: falls by severity, and a comparison of gaits."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from experiments.reports.report import write_figure
from experiments.stress.curves import Curve, family_text, severity_text
from experiments.stress.families import FLAT

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COMPARISON = "terrain_stress.png"
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
_WIDTH_IN = 7.6
"""Width of the figures [inch]: that of a report's column of text, so that their font
size is right on the page."""
_EDGE = 0.06
"""Distance beyond the ends of a ladder of severities, as a share of its length, at
which severities outside of it are drawn."""


def heat_map_name(gait: str) -> str:
    """Name of the PNG file with the falls of a gait."""
    return f"terrain_stress_{gait}.png"


def draw_stress(curves: Sequence[Curve], folder: Path) -> None:
    """Write PNG files: the comparison of all gaits, and the falls of each."""
    write_figure(comparison_figure(curves), folder / COMPARISON)
    for gait in _each(curves, "gait"):
        own = [curve for curve in curves if curve["gait"] == gait]
        write_figure(heat_map_figure(own), folder / heat_map_name(gait))


def heat_map_figure(curves: Sequence[Curve]) -> "Figure":
    """Draw a gait's falls: a panel for each robot and world, a row for each family."""
    from matplotlib.figure import Figure

    settings = _settings(curves)
    ladders = [curve for curve in curves if curve["family"] != FLAT]
    families = _each(ladders, "family")
    size = (_WIDTH_IN, (0.42 * len(families) + 0.6) * len(settings) + 1.0)
    figure = Figure(figsize=size, dpi=200, layout="constrained")
    panels = figure.subplots(len(settings), 1, squeeze=False)[:, 0]
    image = None
    for panel, setting in zip(panels, settings, strict=True):
        own = [curve for curve in ladders if _setting(curve) == setting]
        image = _heat_map(panel, own)
        panel.set_title(_panel_title(curves, setting), fontsize=10)
        panel.set_yticks(range(len(families)), [family_text(name) for name in families])
    if image is not None:
        bar = figure.colorbar(
            image, ax=list(panels), location="bottom", shrink=0.6, aspect=40
        )
        bar.set_label("share of trials that fall")
    figure.suptitle(f"{curves[0]['gait']}: falls on harder and harder ground")
    return figure


def _heat_map(panel: "Axes", curves: Sequence[Curve]) -> Any:
    rates = [[r["falls"] / r["trials"] for r in curve["rungs"]] for curve in curves]
    image = panel.imshow(rates, vmin=0, vmax=1, cmap="YlOrRd", aspect="auto")
    for row, curve in enumerate(curves):
        for column, rung in enumerate(curve["rungs"]):
            severity = severity_text(rung["severity"], curve["unit"])
            panel.text(
                column,
                row,
                f"{rung['falls']}/{rung['trials']}\n{severity}",
                ha="center",
                va="center",
                fontsize=8.5,
                color="white" if rates[row][column] > 0.7 else "black",
            )
    panel.set_xticks([0, len(rates[0]) - 1], ["mild", "hard"])
    panel.tick_params(length=0)
    panel.spines[:].set_visible(False)
    return image


def comparison_figure(curves: Sequence[Curve]) -> "Figure":
    """Draw severities at which half of the trials fall, by robot, world and family.

    The severities tried of every family span the same length, on a logarithmic axis. An
    arrow marks an estimate outside of the severities tried.
    """
    from matplotlib.figure import Figure

    settings, gaits = _settings(curves), _each(curves, "gait")
    ladders = [curve for curve in curves if curve["half"] is not None]
    families = _each(ladders, "family")
    size = (_WIDTH_IN, 0.5 * len(families) + 1.4)
    figure = Figure(figsize=size, dpi=200, layout="constrained")
    panels = figure.subplots(1, len(settings), sharey=True, squeeze=False)[0]
    for panel, setting in zip(panels, settings, strict=True):
        for curve in ladders:
            if _setting(curve) == setting:
                row = families.index(curve["family"])
                _half(panel, curve, row, gaits)
        _frame(panel, ladders, families)
        panel.set_title(_name(curves, setting))
    panels[0].invert_yaxis()
    figure.legend(
        *panels[0].get_legend_handles_labels(),
        loc="outside upper right",
        ncols=len(gaits),
        frameon=False,
    )
    return figure


def _half(panel: "Axes", curve: Curve, row: int, gaits: Sequence[str]) -> None:
    """Draw where half of a curve's trials fall: severity and its 95 % interval."""
    half, k = curve["half"], gaits.index(curve["gait"])
    y = row + 0.6 * ((k + 0.5) / len(gaits) - 0.5)
    colour, label = COLOURS[k % len(COLOURS)], None if row else curve["gait"]
    ends = [_at(curve, half[name]) for name in ("low", "high")]
    low = -_EDGE if ends[0] is None else ends[0]
    high = 1 + _EDGE if ends[1] is None else ends[1]
    if half["beyond"]:
        beyond = half["beyond"] == ">"
        middle, marker = (1 + _EDGE, ">") if beyond else (-_EDGE, "<")
        low, high = (low, middle) if beyond else (middle, high)
    else:
        middle, marker = _at(curve, half["severity"]) or 0.0, "o"
    panel.plot([low, high], [y, y], color=colour, linewidth=2, solid_capstyle="butt")
    panel.plot(middle, y, marker, color=colour, markersize=6, label=label)


def _frame(panel: "Axes", curves: Sequence[Curve], families: Sequence[str]) -> None:
    labels = []
    for family in families:
        curve = next(curve for curve in curves if curve["family"] == family)
        first, last = (
            severity_text(curve["rungs"][k]["severity"], curve["unit"]) for k in (0, -1)
        )
        labels.append(f"{family_text(family)}\n{first} to {last}")
    panel.set_yticks(range(len(families)), labels, fontsize=8)
    panel.set_xticks([0, 1], ["mildest", "hardest"])
    panel.set_xlim(-2 * _EDGE, 1 + 2 * _EDGE)
    panel.set_xlabel("severity at which half of the trials fall")
    for end in (0, 1):
        panel.axvline(end, color="0.85", linewidth=1, zorder=0)
    panel.spines[["top", "right", "left"]].set_visible(False)


def _at(curve: Curve, severity: float | None) -> float | None:
    """Position of a severity on the log scale from 0 (mildest tried) to 1 (hardest)."""
    if severity is None:
        return None
    first, last = (curve["rungs"][k]["severity"] for k in (0, -1))
    return math.log(severity / first) / math.log(last / first)


def _panel_title(curves: Sequence[Curve], setting: tuple[str, str]) -> str:
    name = _name(curves, setting)
    for curve in curves:
        if _setting(curve) == setting and curve["family"] == FLAT:
            rung = curve["rungs"][0]
            name += f" (flat ground: {rung['falls']}/{rung['trials']} fall)"
    return name


def _each(curves: Sequence[Curve], name: str) -> list[str]:
    return list(dict.fromkeys(curve[name] for curve in curves))


def _setting(curve: Curve) -> tuple[str, str]:
    return curve["robot"], curve["world"]


def _settings(curves: Sequence[Curve]) -> list[tuple[str, str]]:
    return list(dict.fromkeys(map(_setting, curves)))


def _name(curves: Sequence[Curve], setting: tuple[str, str]) -> str:
    """Name of a panel: the world, preceded by the robot if there are several robots."""
    return " ".join(setting) if len(_each(curves, "robot")) > 1 else setting[1]
