"""Claims, tables and result page of the study of cliff walking."""

from collections.abc import Sequence

from experiments.reports.report import markdown_table
from experiments.runs.folder import RunFolder
from experiments.transfer.claims import Claim, write_transfer_page
from experiments.transfer.cliff_study.figure import FIGURE
from experiments.transfer.cliff_study.study import (
    GAT,
    METHODS,
    OPTIMUM,
    SAMPLES,
    SGAT,
    Row,
    TransferCliff,
)
from sgat.tabular.grounding import TabularLoop
from sgat.tabular.mdp import STEP_LIMIT

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
