"""What a run found, as one page in two forms: Markdown and HTML.

All verbs write their pages here; the diagnosis, whose figures are of its own, shares
the HTML's frame and style.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from experiments.reports.html import body_html, render, sentence_html
from experiments.reports.origin import Origin
from groundwalk.files import write_text

PAGE, REPORT = "result.md", "report.html"
TEMPLATE = "report.html.jinja"


@dataclass(frozen=True)
class Report:
    """The question, the answer, and what it rests on.

    Attributes:
      question: what was asked, as a heading.
      answer: in plain words, a paragraph each; may be empty.
      body: lines of Markdown: tables, notes, pictures. A picture is the name of a file
        beside the page.
      origin: where it comes from.
    """

    question: str
    answer: Sequence[str]
    body: Sequence[str]
    origin: Origin

    def to_markdown(self) -> str:
        """The page for a repository, its pictures beside it."""
        lines = [f"# {self.question}", ""]
        for paragraph in self.answer:
            lines += [paragraph, ""]
        lines += [*self.body, "", "## How this was made", ""]
        return "\n".join([*lines, *self.origin.to_markdown()]) + "\n"

    def to_html(self, folder: Path) -> str:
        """The page by itself: it holds its pictures and loads nothing.

        Args:
          folder: where the pictures are.
        """
        return render(
            TEMPLATE,
            title=self.question,
            question=self.question,
            answer=[sentence_html(paragraph) for paragraph in self.answer],
            body=body_html("\n".join(self.body), folder),
            command=self.origin.command,
            made=self.origin.rows(),
            files={},
        )

    def write(self, folder: Path, page: str = PAGE) -> None:
        """Write both forms, each file at once.

        Args:
          folder: where the pictures are.
          page: name of the Markdown file.
        """
        write_text(folder / page, self.to_markdown())
        write_text(folder / REPORT, self.to_html(folder))


def markdown_table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Lines of a table; columns of numbers are set to the right.

    Args:
      columns: their headings.
      rows: of as many texts each.
    """
    cells = list(zip(*rows, strict=True)) or [()] * len(columns)
    ruler = ["---:" if _are_numbers(column) else "---" for column in cells]
    return ["| " + " | ".join(row) + " |" for row in (columns, ruler, *rows)]


def _are_numbers(texts: Sequence[str]) -> bool:
    """Whether all begin with a digit, behind a sign; some may be missing."""
    found = [text for text in texts if text not in ("", "-")]
    return bool(found) and all(text.lstrip("+-")[:1].isdigit() for text in found)
