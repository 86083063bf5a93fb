"""Claims that a study checks, most of them the SGAT paper's, and what it writes."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from experiments.reports.origin import Origin
from experiments.reports.report import Report, write_figure
from experiments.reports.tables import print_folder, print_json, print_table
from experiments.runs.extras import extra
from experiments.runs.folder import RunFolder

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Claim:
    """A statement, mostly of the SGAT paper, and whether a study confirms it.

    `found` has the numbers that decide it, as text.
    """

    text: str
    holds: bool
    found: str


def write_picture(
    folder: RunFolder, name: str, draw: Callable[..., "Figure"], *results: Any
) -> None:
    """Write the figure `draw(*results)`, or print why not: the results are kept."""
    with extra(name):
        write_figure(draw(*results), folder.path / name)


def print_study(
    as_json: bool,
    folder: RunFolder,
    result: Mapping[str, Any],
    headings: Sequence[str],
    rows: Sequence[Sequence[str]],
    claims: Sequence[Claim] = (),
) -> None:
    """Print a study's result as JSON, or its table, its claims and the run's folder."""
    if as_json:
        print_json(result)
        return
    print_table(headings, rows)
    if claims:
        print(*claim_lines(claims), sep="\n")
    print_folder(folder.path)


def write_transfer_page(
    folder: RunFolder,
    title: str,
    claims: Sequence[Claim],
    body: Sequence[str],
    answer: Sequence[str] = (),
) -> None:
    """Write a study's `result.md` and `report.html`: answer, claims, then the body.

    The title is the study's question. The answer is sentences; if there are none, it
    says how many claims hold. The pictures are in the run's folder already.
    """
    lines = [*claim_lines(claims), "", *body]
    answer = answer or claims_answer(claims)
    Report(title, answer, lines, Origin.of_run(folder)).write(folder.path)


def claims_answer(claims: Sequence[Claim]) -> list[str]:
    """One sentence on how many of the claims hold; nothing if there are none."""
    if not claims:
        return []
    every, held = len(claims), sum(claim.holds for claim in claims)
    if every == held:
        return ["All that is claimed below came out so."]
    return [f"Of the {every} claims below, {held or 'none'} came out so."]


def claim_lines(claims: Sequence[Claim]) -> list[str]:
    """A Markdown list of claims; each begins with whether it holds."""
    return [
        f"- **{'holds' if claim.holds else 'does not hold'}**: {claim.text}: "
        f"{claim.found}"
        for claim in claims
    ]
