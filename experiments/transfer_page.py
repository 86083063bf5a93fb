"""What the pages of all transfer studies share: claims and tables in Markdown."""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from experiments.result_page import PAGE, origin
from experiments.run_folder import CONFIG, PROVENANCE, RunFolder


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
    folder: RunFolder, title: str, claims: Sequence[Claim], body: Sequence[str]
) -> None:
    """Write `result.md`: where it comes from, the claims, and the rest.

    Args:
      folder: the run.
      title: what was asked, as a heading.
      claims: what is to be shown.
      body: lines of Markdown.
    """
    lines = [f"# {title}", ""]
    lines += origin(folder.read_json(PROVENANCE), folder.read_json(CONFIG))
    lines += ["", *claim_lines(claims), "", *body]
    folder.write_text(PAGE, "\n".join(lines) + "\n")


def claim_lines(claims: Sequence[Claim]) -> list[str]:
    """A list with the verdict in front of each claim."""
    return [
        f"- **{'holds' if claim.holds else 'does not hold'}**: {claim.text}: "
        f"{claim.found}"
        for claim in claims
    ]


def markdown_table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Lines of a table.

    Args:
      columns: their headings.
      rows: of as many texts each.
    """
    ruler = ["---"] * len(columns)
    return ["| " + " | ".join(row) + " |" for row in (columns, ruler, *rows)]
