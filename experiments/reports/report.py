"""The page of a run in two forms: Markdown for a repository, and one HTML file.

All verbs write their pages with `Report`, except `groundwalk diagnose`, whose figures
need an HTML template of their own with the same style.
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
    """A page: a question, its answer, the tables and pictures behind it, its origin.

    The body is lines of Markdown, in which a picture is the name of a file beside the
    page; the answer is paragraphs in plain words.

    Example:
      >>> report = Report("Does it walk?", ["Yes."], [], Origin.of_run(folder))
      >>> report.write(folder.path)
    """

    question: str
    answer: Sequence[str]
    body: Sequence[str]
    origin: Origin

    def to_markdown(self) -> str:
        """The page as Markdown; its pictures are files beside it."""
        lines = [f"# {self.question}", ""]
        for paragraph in self.answer:
            lines += [paragraph, ""]
        lines += [*self.body, "", "## How this was made", ""]
        return "\n".join([*lines, *self.origin.to_markdown()]) + "\n"

    def to_html(self, folder: Path) -> str:
        """The page as HTML that contains the pictures, read from `folder`."""
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
        """Write the page as Markdown and as `report.html` into the pictures' folder."""
        write_text(folder / page, self.to_markdown())
        write_text(folder / REPORT, self.to_html(folder))


def markdown_table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """A table as lines of Markdown; columns of numbers are aligned to the right.

    Example:
      >>> markdown_table(["gait", "falls"], [["start", "1/10"]])
      ['| gait | falls |', '| --- | ---: |', '| start | 1/10 |']
    """
    cells = list(zip(*rows, strict=True)) or [()] * len(columns)
    ruler = ["---:" if _are_numbers(column) else "---" for column in cells]
    return ["| " + " | ".join(row) + " |" for row in (columns, ruler, *rows)]


def _are_numbers(texts: Sequence[str]) -> bool:
    """Whether every text is "", "-" or begins with a digit, with or without a sign."""
    found = [text for text in texts if text not in ("", "-")]
    return bool(found) and all(text.lstrip("+-")[:1].isdigit() for text in found)
