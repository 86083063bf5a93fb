"""The score of a set of concealed test cases as a report page, a table and a figure."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from experiments.concealed.size_by_information import LEVELS
from experiments.reports.origin import Origin
from experiments.reports.report import Report, markdown_table, write_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes


COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""Colours of the methods, the diagnosis first: a palette (Okabe and Ito) that
colour-blind people can distinguish."""


def draw_score(score: Mapping[str, Any], path: Path) -> None:
    """Write the figure of a score (the contents of score.json) as a PNG file.

    It shows the share of correct names: for all methods by level of difficulty, and for
    the diagnosis over the stated probability.
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
        axes.bar(
            middles,
            [one["value"] for one in counted],
            0.9 * width,
            color=COLOURS[number % len(COLOURS)],
            label=name,
            yerr=_bars(counted),
            error_kw={"elinewidth": 0.8},
        )
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
        stated, shares = [r["stated"] for r in bins], [one["value"] for one in rights]
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


TITLE = "Concealed physics: how often the diagnosis is right"
NOTES = """
Levels say how easy a case is: the log-likelihood in nats per recording that the true
effects, with fitted values, gain over the nominal model (L1 at least 100, L2 at least
20, L3 at least 5, L4 less). Brackets hold 95 % intervals: Wilson's for shares,
otherwise the bootstrap over cases. A missing answer counts as wrong. Definitions:
docs/concealed.md.
"""


PAIRED = """
Case by case against each other method: in how many cases only one of both answers well,
and the p value of the exact McNemar test that both are alike.
"""
TITLES_OF_PAIRS = {
    "right": "right as a whole, all cases",
    "top1": "right effect first, singles",
    "null": "names nothing where nothing is missing",
    "outside": "names nothing outside the library",
}
"""Words for what `scoring.paired` compares."""


@dataclass(frozen=True)
class Goal:
    """A figure of the score, its keys in score.json, and the range that is wanted."""

    title: str
    path: tuple[str, ...]
    low: float | None = None
    high: float | None = None

    def of(self, figures: Mapping[str, Any]) -> Mapping[str, Any]:
        """The figure, taken from the scores of one method."""
        found: Any = figures
        for key in self.path:
            found = found[key]
        return dict(found)

    def less_than(self, score: Mapping[str, Any]) -> float | None:
        """Limit for a control: half of what the diagnosis closes; None for others."""
        closed = score["closed"]["closed"]["value"]
        is_control = self.path[0] == "closed" and self.path[1] != "closed"
        return 0.5 * closed if is_control and closed is not None else None

    def holds(self, score: Mapping[str, Any]) -> bool | None:
        """Whether the figure meets the goal; None without a goal or a figure."""
        value, limit = self.of(score)["value"], self.less_than(score)
        if value is None or not self.asked(score):
            return None
        below = self.high is None or value <= self.high
        less = limit is None or bool(value < limit)
        return below and less and (self.low is None or value >= self.low)

    def asked(self, score: Mapping[str, Any]) -> str:
        """The goal in words, such as "at least 0.9"; "" without bounds."""
        limit = self.less_than(score)
        if limit is not None:
            return f"less than {limit:.3g}"
        if self.low is not None and self.high is not None:
            return f"{self.low:.0%} to {self.high:.0%}"
        if self.low is not None:
            return f"at least {self.low:.3g}"
        return "" if self.high is None else f"at most {self.high:.3g}"


GOALS = (
    Goal("answers that are right as a whole", ("right",)),
    Goal("right effect first, L1", ("top1", "L1"), low=0.90),
    Goal("right effect first, L2", ("top1", "L2"), low=0.75),
    Goal("right effect first, L3", ("top1", "L3")),
    Goal("right effect first, L4", ("top1", "L4")),
    Goal("right effect first, all singles", ("top1", "all")),
    Goal("right effect first and at its place, all singles", ("there",)),
    Goal("right effect considered, L1", ("in_set", "L1"), low=0.90),
    Goal("right effect considered, L2", ("in_set", "L2"), low=0.90),
    Goal("right effect considered, all singles", ("in_set", "all")),
    Goal("effects considered, mean number", ("set_size",)),
    Goal("right place where the effect is right", ("place",), low=0.95),
    Goal("pairs and triples, F1", ("pairs_f1",), low=0.75),
    Goal("pairs and triples right, faintest at L1", ("compounds", "L1")),
    Goal("pairs and triples right, faintest at L2", ("compounds", "L2")),
    Goal("pairs and triples right, faintest at L3", ("compounds", "L3")),
    Goal("pairs and triples right, faintest at L4", ("compounds", "L4")),
    Goal("parameter error, median", ("parameter_error_median",), high=0.10),
    Goal("80 % intervals that hold the truth", ("coverage80",), low=0.7, high=0.9),
    Goal("... of small effects (L3, L4)", ("coverage80_of", "small")),
    Goal("... of large effects (L1, L2)", ("coverage80_of", "large")),
    Goal("... of several effects at once", ("coverage80_of", "several")),
    Goal("held-out error closed", ("closed", "closed"), low=0.80),
    Goal("closed by the control at a wrong place", ("closed", "wrong_place")),
    Goal("closed by the control with a wrong effect", ("closed", "wrong_effect")),
    Goal("nothing missing, but named", ("null_false_alarms",), high=0.05),
    Goal("outside the library, but named", ("outside_named",), high=0.15),
    Goal("not excited, and said so", ("unexcited_right",)),
    Goal("calibration error (ECE)", ("ece",), high=0.10),
    Goal("Brier score of the probabilities", ("brier",)),
    Goal("Brier score of the best constant", ("brier_constant",)),
)
"""The numbers on the page, each with the goal that the diagnosis should reach. The
control corrections, which are wrong on purpose, should remove less than half of the
error that the diagnosis removes."""


def text_of(figure: Mapping[str, Any]) -> str:
    """A figure as text, such as "0.91 [0.85, 0.95], n 120"."""
    if figure["value"] is None:
        return "-"
    value = f"{figure['value']:.2f}"
    return f"{value} [{figure['low']:.2f}, {figure['high']:.2f}], n {figure['n']}"


def score_rows(score: Mapping[str, Any]) -> tuple[list[str], list[list[str]]]:
    """Headings and rows of the table of figures: goals, diagnosis and baselines."""
    baselines = score["baselines"]
    columns = ["figure", "goal", "holds", "diagnosis", *baselines]
    rows = []
    for goal in GOALS:
        holds = {True: "yes", False: "no", None: ""}[goal.holds(score)]
        others = [text_of(goal.of(each)) for each in baselines.values()]
        row = [goal.title, goal.asked(score), holds, text_of(goal.of(score))]
        rows.append([*row, *others])
    return columns, rows


def score_report(score: Mapping[str, Any], figure: str) -> Report:
    """Make the report page of a score.json; `figure` is its picture's file name."""
    body = markdown_table(*score_rows(score))
    body += ["", f"![Accuracy by level, and calibration]({figure})", "", NOTES.strip()]
    body += ["", "Verdicts by kind of case:", "", *_verdict_table(score["verdicts"])]
    if score["paired"]:
        body += ["", PAIRED.strip(), "", *_paired_table(score["paired"])]
    settings = {
        "cases": score["cases"],
        "set": score["set"],
        "drawn from seed": score["seed"],
        "sha256 of the sealed truth": score["truth_sha256"],
        "diagnosed at commit": score.get("answered_by"),
    }
    origin = Origin.of(score["provenance"], settings)
    return Report(TITLE, _answer(score), [*_unanswered(score), *body], origin)


def _answer(score: Mapping[str, Any]) -> list[str]:
    """A sentence with the main figures and the number of goals that are met."""
    held = [holds for goal in GOALS if (holds := goal.holds(score)) is not None]
    right, wrong = score["top1"]["all"]["value"], score["null_false_alarms"]["value"]
    whole = score["right"]
    told = f"{round(whole['value'] * whole['n'])} answers are right as a whole"
    if right is not None:
        first = f"the right effect is named first in {right:.0%}"
        told += f", {first} of the cases with one effect"
    if wrong is not None:
        named = f"something is named in {wrong:.0%}"
        told += f", {named} of those in which nothing is missing"
    met = f"The diagnosis meets {sum(held)} of the {len(held)} goals that count here."
    return [f"Of {score['cases']} cases: {told}. {met}"]


def _unanswered(score: Mapping[str, Any]) -> list[str]:
    """A line for each method that left test cases unanswered."""
    methods = {"diagnosis": score["missing"]}
    methods |= {name: each["missing"] for name, each in score["baselines"].items()}
    lines = [
        f"- unanswered by {name} (counted as wrong): {', '.join(missing)}"
        for name, missing in methods.items()
        if missing
    ]
    return [*lines, ""] if lines else []


def _paired_table(paired: Mapping[str, Mapping[str, Any]]) -> Sequence[str]:
    rows = [
        [
            name,
            TITLES_OF_PAIRS[what],
            str(one["n"]),
            str(one["only_ours"]),
            str(one["only_theirs"]),
            f"{one['p']:.2g}",
        ]
        for name, every in paired.items()
        for what, one in every.items()
    ]
    heads = ["against", "good answer", "n", "only diagnosis", "only the other", "p"]
    return markdown_table(heads, rows)


def _verdict_table(verdicts: Mapping[str, Mapping[str, int]]) -> Sequence[str]:
    kinds = sorted({kind for row in verdicts.values() for kind in row})
    rows = [
        [case, *(str(row.get(kind, 0)) for kind in kinds)]
        for case, row in verdicts.items()
    ]
    return markdown_table(["case", *kinds], rows)
