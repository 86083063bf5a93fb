"""`groundwalk transfer cliff`: cliff walking, grounded by GAT and by SGAT; its page."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from experiments.command_line import run_verb
from experiments.reports.report import markdown_table
from experiments.runs.folder import HISTORY, RESULT, RunFolder, open_run
from experiments.runs.progress import progress
from experiments.transfer.claims import (
    Claim,
    print_study,
    write_picture,
    write_transfer_page,
)
from experiments.transfer.cliff_study import (
    GAT,
    METHODS,
    OPTIMUM,
    SAMPLES,
    SGAT,
    UNGROUNDED,
    Row,
    TransferCliff,
    compare,
)
from sgat.tabular.grounding import TabularLoop
from sgat.tabular.mdp import STEP_LIMIT

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


FIGURE = "transfer_cliff.png"

STYLES: dict[str, dict[str, Any]] = {
    OPTIMUM: {"color": "#56b4e9", "linewidth": 6, "alpha": 0.6},
    UNGROUNDED: {"color": "#7f8894", "linestyle": "--", "marker": "s", "markersize": 9},
    GAT: {"color": "#d55e00", "marker": "^"},
    SGAT: {"color": "#0072b2", "marker": "o"},
}
"""Lines of the methods, in colours that colour-blind people can distinguish (Okabe
and Ito)."""

CLIFF_COLOUR, GOAL_COLOUR = "#f4c7b8", "#bfe3d0"


def cliff_figure(rows: Sequence[Row], grid: tuple[int, int]) -> "Figure":
    """Returns of all methods above; below, paths where GAT and SGAT differ most.

    `grid` is the number of rows and of columns of the grid world.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 6.4), dpi=200, layout="constrained")
    above, below = figure.subplots(2, 1, height_ratios=(2.4, 1))
    _draw_returns(above, rows)
    _draw_paths(below, max(rows, key=lambda row: _more(row, SGAT, GAT, "exact")), grid)
    return figure


def _draw_returns(axes: "Axes", rows: Sequence[Row]) -> None:
    noise = [row["noise"] for row in rows]
    for name, style in STYLES.items():
        scores = [row["methods"][name] for row in rows]
        axes.errorbar(
            noise,
            [score["mean"] for score in scores],
            yerr=[score["standard_error"] for score in scores],
            label=name,
            **style,
        )
    axes.set_xlabel("noise: chance that a move is random")
    axes.set_ylabel("return in the real world\n(mean and standard error)")
    axes.grid(axis="y", color="0.9")
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)


def _draw_paths(axes: "Axes", row: Row, grid: tuple[int, int]) -> None:
    rows, columns = grid
    cells = {
        "cliff": (1, columns - 2, CLIFF_COLOUR),
        "goal": (columns - 1, 1, GOAL_COLOUR),
    }
    for text, (first, width, colour) in cells.items():
        axes.bar(first - 0.5, 1, width, rows - 1.5, align="edge", color=colour)
        axes.text(first - 0.5 + width / 2, rows - 0.56, text, ha="center")
    for name, aside in ((GAT, -0.06), (SGAT, 0.06)):
        path = np.array(row["methods"][name]["path"]) + aside
        axes.plot(
            path[:, 1], path[:, 0], lw=2.5, color=STYLES[name]["color"], label=name
        )
    axes.set_title(
        f"where the policies mean to go at noise {row['noise']:g}", fontsize=10
    )
    axes.set_xticks(np.arange(-0.5, columns), labels=[])
    axes.set_yticks(np.arange(-0.5, rows), labels=[])
    axes.set(xlim=(-0.5, columns - 0.5), ylim=(rows - 0.5, -0.5), aspect="equal")
    axes.grid(color="0.85")
    axes.set_axisbelow(True)
    axes.tick_params(length=0)
    axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))


ROUNDING = 1e-9
"""Largest difference of two returns that counts as rounding."""
TITLE = "Cliff walking: what policies return in a real world of random moves"
NOTES = """
The grid has {rows} x {columns} cells. The paper does not state the size of its own; the
default is that of Sutton and Barto (Reinforcement Learning, example 6.6). The goal pays
100, the cliff -10, and both end the episode; each step costs 0.1, and nothing is
discounted. Noise is the probability that a move is a random one of the four. Returns
are means of {episodes} episodes with their standard errors; all methods share their
random numbers. Exact returns follow from the transition probabilities. Episodes are cut
after {limit} steps; here {cut} were.

GAT and SGAT ground and plan (policy iteration) until {calm} grounding steps in a row
gain no more than {gain:g}. Each step plays {real_episodes} real episodes with the
current policy and {exploration:.0%} random actions. All transitions so far are counted;
where fewer than {known_after} of a state and action were seen, the sim's table is used.
GAT takes the most likely next state, SGAT samples it. "No grounding" plans in the sim,
"optimum" in the real world itself. Of equally good actions the first of up, down, left
and right is taken.
"""


def check_claims(rows: Sequence[Row]) -> list[Claim]:
    """The SGAT paper's claims that these noise values can decide."""
    claims = []
    if ends := [row for row in rows if row["noise"] in (0, 1)]:
        apart = max(map(abs, _gains(ends)))
        text = "at noise 0 and 1 GAT and SGAT return the same"
        claims.append(Claim(text, apart <= ROUNDING, f"at most {apart:.3g} apart"))
    if between := [row for row in rows if row["noise"] not in (0, 1)]:
        more = min(_gains(between))
        text = "in between SGAT returns at least as much as GAT"
        claims.append(Claim(text, more >= -ROUNDING, f"at least {more:.3g} more"))
    return [*claims, _optimal(rows)]


def _gains(rows: Sequence[Row]) -> list[float]:
    """Returns of SGAT minus those of GAT, exact ones and means."""
    return [_more(row, SGAT, GAT, key) for row in rows for key in ("exact", "mean")]


def _more(row: Row, method: str, other: str, value: str) -> float:
    methods = row["methods"]
    return float(methods[method][value] - methods[other][value])


def _optimal(rows: Sequence[Row]) -> Claim:
    found = []
    for row in rows:
        loss = _more(row, OPTIMUM, SGAT, "exact")
        error = row["methods"][SGAT]["standard_error"]
        found.append((loss > error + ROUNDING, loss, error, row["noise"]))
    beyond, loss, error, worst = max(found)
    return Claim(
        "SGAT's policy is within its standard error of the optimum",
        not beyond,
        f"it loses {loss:.3g} with a standard error of {error:.3g} at noise {worst:g}",
    )


def returns_table(
    rows: Sequence[Row], form: str = "{mean:.2f} ± {standard_error:.2f}"
) -> tuple[list[str], list[list[str]]]:
    """Headings and rows: a row for each noise value, a column for each method.

    `form` formats a method's results; by default, mean return and standard error.
    """
    texts = [
        [
            f"{row['noise']:g}",
            *(form.format_map(row["methods"][name]) for name in METHODS),
        ]
        for row in rows
    ]
    return ["noise", *METHODS], texts


def _data_table(rows: Sequence[Row]) -> tuple[list[str], list[list[str]]]:
    texts = []
    for row in rows:
        text = [f"{row['noise']:g}"]
        for name in SAMPLES:
            method = row["methods"][name]
            unsettled = "" if method["calm"] else " (not settled)"
            text.append(f"{method['grounding_steps']}{unsettled}")
            text.append(f"{method['real_transitions']}")
        texts.append(text)
    needed = ("steps", "real transitions")
    return ["noise", *(f"{name}: {what}" for name in SAMPLES for what in needed)], texts


def write_cliff_page(
    folder: RunFolder,
    config: TransferCliff,
    rows: Sequence[Row],
    claims: Sequence[Claim],
) -> None:
    """Write `result.md` and `report.html`; the figure is in the folder already."""
    loop = TabularLoop(config.real_episodes)
    notes = NOTES.format(
        rows=config.rows,
        columns=config.columns,
        episodes=config.episodes,
        limit=STEP_LIMIT,
        cut=sum(method["cut"] for row in rows for method in row["methods"].values()),
        calm=loop.calm_steps,
        gain=loop.gain,
        real_episodes=loop.episodes,
        exploration=loop.exploration,
        known_after=loop.known_after,
    )
    tables = {
        "Mean returns:": returns_table(rows),
        "Exact expected returns:": returns_table(rows, "{exact:.3f}"),
        "Grounding steps, and real transitions that they needed:": _data_table(rows),
    }
    body = [f"![Returns over noise, and the paths]({FIGURE})", ""]
    for heading, table in tables.items():
        body += [heading, "", *markdown_table(*table), ""]
    write_transfer_page(folder, TITLE, claims, [*body, notes.strip()])


VERB = "transfer-cliff"


def main(config: TransferCliff) -> None:
    """Compare the methods for every noise value, and write results and page."""
    folder, config = open_run(VERB, config)
    rows = _compare_all(config, folder)
    claims = check_claims(rows)
    result = {"rows": rows, "claims": [vars(claim) for claim in claims]}
    folder.write_json(RESULT, result)
    write_picture(folder, FIGURE, cliff_figure, rows, (config.rows, config.columns))
    write_cliff_page(folder, config, rows, claims)
    print_study(config.json, folder, result, *returns_table(rows), claims)


def _compare_all(config: TransferCliff, folder: RunFolder) -> list[Row]:
    """Results for all noise values; those that an earlier run has written are kept."""
    rows = folder.read_json(HISTORY)["rows"] if folder.has(HISTORY) else []
    seeds = np.random.SeedSequence(config.seed).spawn(len(config.noise))
    with progress("cliff walking", len(config.noise), done=len(rows)) as bar:
        for k in range(len(rows), len(config.noise)):
            rows.append(compare(config, config.noise[k], seeds[k]))
            folder.write_json(HISTORY, {"rows": rows})
            bar.advance()
    return rows


if __name__ == "__main__":
    run_verb(TransferCliff, main)
