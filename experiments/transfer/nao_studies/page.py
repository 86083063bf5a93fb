"""The NAO study's figure, its table, its claims and its page."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from experiments.grounded_walks.courses import RealCourse
from experiments.grounded_walks.models import GAT, LUMPS_MARGIN, NONE, SGAT, UNEVEN
from experiments.grounded_walks.walks import FALL_PENALTY_WALK_CM_S, ON_COURSE, WALK
from experiments.reports.report import markdown_table
from experiments.reports.statistics import wilson
from experiments.runs.folder import RunFolder
from experiments.transfer.claims import Claim, write_transfer_page
from experiments.walking.trials import FALL_PENALTY_CM_S
from sgat.transformers.catalogue import groundings
from terrain import Flat, Lumps, configuration, parse

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


CELLS = "cells"
DIAGNOSED = "diagnosed"
"""Word in the names of methods whose sim a diagnosis has corrected."""
DIAGNOSED_SIM = f"{DIAGNOSED} sim"
HEADINGS = ("method", "step", "speed [cm/s]", "falls", "95 % interval", "real walks")
GOAL_SPEED_CM_S, GOAL_FALLS, SIGNIFICANT = 18.0, 0.1, 0.05
"""The aim of the study: speed [cm/s] and share of falls that a gait must reach, from
the SGAT paper; and the p value below which a difference is called significant."""

Cell = Mapping[str, Any]
"""Result of one method after one grounding step: its gait, speed [cm/s] and falls."""


def table_of(cells: Sequence[Cell]) -> list[list[str]]:
    """A row of texts for each cell, under `HEADINGS`; a cell is a method's result."""
    rows = []
    for cell in sorted(cells, key=lambda cell: cell["step"]):
        low, high = wilson(cell["falls"], cell["trials"])
        speed = f"{cell['speed_mean']:.1f} ± {cell['speed_std']:.1f}"
        falls = f"{cell['falls']}/{cell['trials']}", f"{low:.0%} to {high:.0%}"
        walks = str(cell["real_walks"])
        rows.append([cell["method"], str(cell["step"]), speed, *falls, walks])
    return rows


def more_falls_p(often: Cell, seldom: Cell) -> float:
    """One-sided p value that the first gait falls more often (Fisher's exact test)."""
    from scipy.stats import fisher_exact

    table = [
        [cell["falls"], cell["trials"] - cell["falls"]] for cell in (often, seldom)
    ]
    return float(fisher_exact(table, alternative="greater").pvalue)


def faster_p(fast: Cell, slow: Cell) -> float:
    """One-sided p value that the first method's gait is faster (Welch's test)."""
    from scipy.stats import ttest_ind_from_stats

    numbers = [
        cell[key]
        for cell in (fast, slow)
        for key in ("speed_mean", "speed_std", "trials")
    ]
    test = ttest_ind_from_stats(*numbers, equal_var=False, alternative="greater")
    return float(test.pvalue)


def claims_of(cells: Sequence[Cell]) -> list[Claim]:
    """Claims of the SGAT paper's table; none if a method they need was not tried."""
    at = {(cell["method"], cell["step"]): cell for cell in cells}
    if all((name, 1) in at for name in (NONE, DIAGNOSED_SIM)):
        return [_better_than_nominal(at[DIAGNOSED_SIM, 1], at[NONE, 1])]
    if not all((name, 2) in at for name in (GAT, SGAT, UNEVEN)):
        return []
    gat, sgat, best = (at[name, 2] for name in (GAT, SGAT, UNEVEN))
    p = more_falls_p(gat, sgat)
    return [
        Claim(
            f"after two steps SGAT walks at least {GOAL_SPEED_CM_S:.0f} cm/s and falls "
            f"in at most {GOAL_FALLS:.0%} of its trials",
            _is_good(sgat),
            _walked(sgat),
        ),
        Claim(
            "after two steps SGAT on an uneven sim does, too",
            _is_good(best),
            _walked(best),
        ),
        Claim(
            "GAT falls significantly more often",
            p < SIGNIFICANT,
            f"{_walked(gat)}; Fisher's exact test, one-sided: p = {p:.2g}",
        ),
        Claim(
            "on an uneven sim SGAT tunes a better gait than on the flat",
            worth_cm_s(best) > worth_cm_s(sgat),
            f"{_walked(best)} against {_walked(sgat)}",
        ),
    ]


def _better_than_nominal(diagnosed: Cell, nominal: Cell) -> Claim:
    return Claim(
        "the gait tuned on the diagnosed sim walks better than the one tuned on the "
        "nominal sim",
        worth_cm_s(diagnosed) > worth_cm_s(nominal),
        f"{_walked(diagnosed)} against {_walked(nominal)}; one-sided, Fisher's exact "
        f"test of the falls: p = {more_falls_p(nominal, diagnosed):.2g}, Welch's test "
        f"of the speeds: p = {faster_p(diagnosed, nominal):.2g}",
    )


def write_nao_page(
    folder: RunFolder,
    cells: Sequence[Cell],
    planned: int,
    ratings: int,
    course: RealCourse,
) -> None:
    """Write `result.md` and `report.html` with the results so far.

    `planned` is the number of cells that the study will have, `ratings` the number of
    times that a mean gait was rated after a search.
    """
    trials = cells[0]["trials"]
    missing = planned - len(cells)
    body = [
        *([f"Not finished: {missing} of {planned} rows are to come."] * (missing > 0)),
        f"Every gait walked the same grounds, courses of {course.length_m:g} m "
        f"{_ground(course)},",
        f"{trials} trials. Speed is forward, until the fall where the robot",
        "fell; its spread is the standard deviation over trials. Intervals are",
        "Wilson's.",
        *_hidden(course, cells),
        "",
        f"![Speed and falls of every gait]({FIGURE})",
        "",
        *markdown_table(HEADINGS, table_of(cells)),
        "",
        *_groundings(cells),
        "All groundings learn from the same real walks, half of them with noise on the",
        "commands.",
        f"A search pays {FALL_PENALTY_WALK_CM_S:.0f} cm/s for a fall in a walk of",
        f"{WALK.limit_s:g} s, or {ON_COURSE.limit_s:g} s where the ground has lumps.",
        "What a search finds is the best of its generations' mean gaits, each rated",
        f"{ratings} times more.",
        "*real walks*: number of real walks that the method used before its trials.",
    ]
    title = "Do gaits from grounded sims hold in the real world?"
    write_transfer_page(folder, title, claims_of(cells), body, answer_of(cells))


def _ground(course: RealCourse) -> str:
    name, parameters = parse(course.terrain)
    match configuration(name, **parameters):
        case Flat():
            return "on flat ground"
        case Lumps(amplitude_m=height_m, wavelength_m=length_m):
            return (
                f"on lumps of {1000 * height_m:.0f} mm that are "
                f"{100 * length_m:.0f} cm long"
            )
        case _:
            return f"of `{course.terrain}`"


def _groundings(cells: Sequence[Cell]) -> list[str]:
    """Markdown lines on SGAT's noise, and on groundings that the SGAT paper lacks."""
    tried = {cell["method"] for cell in cells}
    lines = []
    if SGAT in tried:
        lines.append(f"{SGAT}'s noise is white, as in the SGAT paper.")
    for one in groundings().values():
        if tried & {one.title, f"{one.title}, {DIAGNOSED}"}:
            lines += one.means
            if one.uneven_sim:
                lines.append(
                    f"In a search the lumps are {LUMPS_MARGIN:g} times as high, as a "
                    "safety margin."
                )
    return lines


def _hidden(course: RealCourse, cells: Sequence[Cell]) -> list[str]:
    """Markdown lines on the physics that the sim lacks, and on diagnosed sims."""
    if not course.hidden:
        return []
    found = any(DIAGNOSED in cell["method"] for cell in cells)
    return [
        "",
        "Besides its latency, real has physics that the model lacks: "
        + "; ".join(effect.to_text() for effect in course.hidden)
        + ".",
        *(["A *diagnosed* sim has what a diagnosis of recordings found."] * found),
    ]


def answer_of(cells: Sequence[Cell]) -> list[str]:
    """Sentences on the best gait, the plain sim's, and whether the goal is reached."""
    best = max(cells, key=worth_cm_s)
    step = f", step {best['step']}" if best["step"] else ""
    good = "It reaches" if _is_good(best) else "It does not reach"
    said = f"The best gait is that of {best['method']}{step}: {_walked(best)}."
    for cell in cells:
        if cell["method"] == NONE and cell is not best:
            said += f" The gait tuned in the plain sim: {_walked(cell)}."
    return [
        said,
        f"{good} the goal of {GOAL_SPEED_CM_S:.0f} cm/s with falls in at most "
        f"{GOAL_FALLS:.0%} of the trials.",
    ]


def _is_good(cell: Cell) -> bool:
    share = cell["falls"] / cell["trials"]
    return bool(cell["speed_mean"] >= GOAL_SPEED_CM_S and share <= GOAL_FALLS)


def _walked(cell: Cell) -> str:
    return (
        f"{cell['speed_mean']:.1f} ± {cell['speed_std']:.1f} cm/s, "
        f"{cell['falls']} falls of {cell['trials']}"
    )


def worth_cm_s(cell: Cell) -> float:
    """Speed minus the SGAT paper's cost of falls [cm/s], by which gaits are compared.

    Searches charge four times as much for a fall, since their walks are short.
    """
    falls = FALL_PENALTY_CM_S * cell["falls"] / cell["trials"]
    return float(cell["speed_mean"] - falls)
