"""What the pages of all transfer studies share: claims, and how they are written."""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from experiments.reports.origin import Origin
from experiments.reports.report import Report
from experiments.runs.folder import RunFolder


@dataclass(frozen=True)
class Claim:
    """Something that the paper says, and whether it came out so.

    Attributes:
      text: what is claimed.
      holds: whether it does.
      found: the numbers that say so, in words.
    """

    text: str
    holds: bool
    found: str

    def to_json(self) -> dict[str, Any]:
        """As plain values."""
        return dataclasses.asdict(self)


def write_transfer_page(
    folder: RunFolder,
    title: str,
    claims: Sequence[Claim],
    body: Sequence[str],
    answer: Sequence[str] = (),
) -> None:
    """Write `result.md` and the HTML: the answer, the claims, and the rest.

    Args:
      folder: the run, which has its pictures already.
      title: what was asked, as a heading.
      claims: what is to be shown.
      body: lines of Markdown.
      answer: in plain words; how many claims hold where there are none.
    """
    lines = [*claim_lines(claims), "", *body]
    answer = answer or claims_answer(claims)
    Report(title, answer, lines, Origin.of_run(folder)).write(folder.path)


def claims_answer(claims: Sequence[Claim]) -> list[str]:
    """How many claims hold."""
    if not claims:
        return []
    every, held = len(claims), sum(claim.holds for claim in claims)
    if every == held:
        return ["All that is claimed below came out so."]
    return [f"Of the {every} claims below, {held or 'none'} came out so."]


def claim_lines(claims: Sequence[Claim]) -> list[str]:
    """A list with the verdict in front of each claim."""
    return [
        f"- **{'holds' if claim.holds else 'does not hold'}**: {claim.text}: "
        f"{claim.found}"
        for claim in claims
    ]
