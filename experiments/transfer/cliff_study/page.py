"""Tables and result page of the study of cliff walking."""

from collections.abc import Sequence

from experiments.reports.report import markdown_table
from experiments.runs.folder import RunFolder
from experiments.transfer.claims import Claim, write_transfer_page
from experiments.transfer.cliff_study.figure import FIGURE
from experiments.transfer.cliff_study.study import METHODS, SAMPLES, CliffStudy, Row
from sgat.tabular.rollouts import STEP_LIMIT

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


def returns_table(rows: Sequence[Row]) -> tuple[list[str], list[list[str]]]:
    """Headings and rows of each method's mean return with its standard error."""
    return _table(rows, "{mean:.2f} ± {standard_error:.2f}")


def _table(rows: Sequence[Row], form: str) -> tuple[list[str], list[list[str]]]:
    """Headings and rows: a row for each noise value, a column for each method.

    `form` formats a method's results, for example "{exact:.3f}".
    """
    texts = [
        [f"{row['noise']:g}"]
        + [form.format_map(row["methods"][name]) for name in METHODS]
        for row in rows
    ]
    return ["noise", *METHODS], texts


def _data_table(rows: Sequence[Row]) -> tuple[list[str], list[list[str]]]:
    columns = ["noise"]
    for name in SAMPLES:
        columns += [f"{name}: steps", f"{name}: real transitions"]
    texts = []
    for row in rows:
        text = [f"{row['noise']:g}"]
        for name in SAMPLES:
            method = row["methods"][name]
            unsettled = "" if method["calm"] else " (not settled)"
            text.append(f"{method['grounding_steps']}{unsettled}")
            text.append(f"{method['real_transitions']}")
        texts.append(text)
    return columns, texts


def write_cliff_page(
    folder: RunFolder, study: CliffStudy, rows: Sequence[Row], claims: Sequence[Claim]
) -> None:
    """Write `result.md` and `report.html`; the figure is in the folder already.

    `rows` has one entry of results for each noise value.
    """
    cut = sum(method["cut"] for row in rows for method in row["methods"].values())
    notes = NOTES.format(
        rows=study.rows,
        columns=study.columns,
        episodes=study.episodes,
        limit=STEP_LIMIT,
        cut=cut,
        calm=study.loop.calm_steps,
        gain=study.loop.gain,
        real_episodes=study.loop.episodes,
        exploration=study.loop.exploration,
        known_after=study.loop.known_after,
    )
    body = [f"![Returns over noise, and the paths]({FIGURE})", ""]
    body += ["Mean returns:", "", *markdown_table(*returns_table(rows)), ""]
    body += [
        "Exact expected returns:",
        "",
        *markdown_table(*_table(rows, "{exact:.3f}")),
        "",
    ]
    body += [
        "Grounding steps, and real transitions that they needed:",
        "",
        *markdown_table(*_data_table(rows)),
        "",
    ]
    write_transfer_page(folder, TITLE, claims, [*body, notes.strip()])
