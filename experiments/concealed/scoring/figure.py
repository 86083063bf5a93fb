"""Figure of a score: accuracy by level, and calibration of stated probabilities."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from experiments.concealed.size_by_information import LEVELS
from experiments.reports.figure_file import write_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""Colours of the methods, the diagnosis first: a palette (Okabe and Ito) that
colour-blind people can distinguish."""


def draw_score(score: Mapping[str, Any], path: Path) -> None:
    """Write the figure of a score (the contents of score.json) as a PNG file.

    The left panel shows for all methods the share of single effects that were named
    correctly, by level of difficulty; the right one for the diagnosis the share of
    correct names over the stated probability.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 4.0), dpi=200, layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.5, 1))
    _draw_levels(left, {"diagnosis": score, **score["baselines"]})
    _draw_reliability(right, score["reliability"])
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
        axes.set_axisbelow(True)
    write_figure(figure, path)


def _draw_levels(axes: "Axes", methods: Mapping[str, Mapping[str, Any]]) -> None:
    width = 0.8 / len(methods)
    for number, (name, figures) in enumerate(methods.items()):
        shares = [figures["top1"][level] for level in LEVELS]
        there = [i for i, one in enumerate(shares) if one["value"] is not None]
        middles = np.array(there) + (number - (len(methods) - 1) / 2) * width
        counted = [shares[i] for i in there]
        values, colour = (
            [one["value"] for one in counted],
            COLOURS[number % len(COLOURS)],
        )
        errors: dict[str, Any] = {
            "yerr": _bars(counted),
            "error_kw": {"elinewidth": 0.8},
        }
        axes.bar(middles, values, 0.9 * width, color=colour, label=name, **errors)
    numbers = [methods["diagnosis"]["top1"][level]["n"] for level in LEVELS]
    labels = [f"{level}\nn {n}" for level, n in zip(LEVELS, numbers, strict=True)]
    axes.set_xticks(range(len(LEVELS)), labels)
    axes.set(xlim=(-0.5, len(LEVELS) - 0.5), ylim=(0, 1.02))
    axes.set_ylabel("right effect first, single effects\n(share, 95 % interval)")
    axes.grid(axis="y", color="0.9")
    axes.legend(
        frameon=False, ncols=len(methods), loc="lower center", bbox_to_anchor=(0.5, 1)
    )


def _draw_reliability(axes: "Axes", bins: Sequence[Mapping[str, Any]]) -> None:
    axes.plot([0, 1], [0, 1], color="0.6", linestyle="--", linewidth=1)
    if bins:
        rights = [row["right"] for row in bins]
        stated, shares = (
            [row["stated"] for row in bins],
            [one["value"] for one in rights],
        )
        style: dict[str, Any] = {"color": COLOURS[0], "marker": "o", "linestyle": "-"}
        axes.errorbar(stated, shares, yerr=_bars(rights), elinewidth=0.8, **style)
    axes.set(xlim=(0, 1.02), ylim=(0, 1.02))
    axes.set_xlabel("stated probability of the first effect")
    axes.set_ylabel("share of right names")
    axes.grid(color="0.9")


def _bars(figures: Sequence[Mapping[str, Any]]) -> list[list[float]]:
    """Lengths of error bars for Matplotlib: a row below and a row above the values."""
    below = [max(one["value"] - one["low"], 0.0) for one in figures]
    above = [max(one["high"] - one["value"], 0.0) for one in figures]
    return [below, above]
