"""Claims of a paper, checked by a study, and the page that shows them."""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from experiments.reports.origin import Origin
from experiments.reports.report import Report
from experiments.runs.folder import RunFolder


@dataclass(frozen=True)
class Claim:
    """Something that the paper says, and whether the study confirms it.

    Attributes:
      text: the claim.
      holds: whether the study confirms it.
      found: the numbers that decide it, in words.
    """

    text: str
    holds: bool
    found: str

    def to_json(self) -> dict[str, Any]:
        """The claim as plain values."""
        return dataclasses.asdict(self)


def write_transfer_page(
    folder: RunFolder,
    title: str,
    claims: Sequence[Claim],
    body: Sequence[str],
    answer: Sequence[str] = (),
) -> None:
    """Write `result.md` and `report.html`: answer, claims, then the body.

    Args:
      folder: of the run; the pictures are in it already.
      title: the study's question, as a heading.
      claims: what the study checks.
      body: lines of Markdown.
      answer: in plain words; if empty, the number of claims that hold.
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
    """A Markdown list of the claims, each with its verdict in front."""
    return [
        f"- **{'holds' if claim.holds else 'does not hold'}**: {claim.text}: "
        f"{claim.found}"
        for claim in claims
    ]
