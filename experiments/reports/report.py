"""The page of a run in two forms: Markdown for a repository, and one HTML file.

No script, style or picture of the HTML is loaded from outside. Figures are PNG files.
"""

import base64
import html
import io
import mimetypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from experiments.reports.origin import Origin
from groundwalk.files import write_bytes, write_text

if TYPE_CHECKING:
    from markdown_it import MarkdownIt
    from markdown_it.rules_core import StateCore
    from markdown_it.token import Token
    from matplotlib.figure import Figure


FOLDER = "folder"
TEMPLATES = Path(__file__).parent / "templates"


def render(template: str, **values: Any) -> str:
    """Fill the variables of a Jinja template in `templates/`; texts are escaped."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
    )
    return environment.get_template(template).render(**values)


def body_html(markdown: str, folder: Path) -> str:
    """Convert Markdown with tables to HTML, and embed its pictures from a folder.

    HTML within the Markdown is shown as text. A picture that is missing, or in another
    folder, is replaced by its caption.
    """
    return str(_parser().render(markdown, {FOLDER: folder}))


def sentence_html(markdown: str) -> str:
    """Convert one paragraph of Markdown to HTML without the tags of the paragraph."""
    return str(_parser().renderInline(markdown))


def _parser() -> "MarkdownIt":
    from markdown_it import MarkdownIt

    parser = MarkdownIt("js-default")
    parser.core.ruler.push("pictures", _pictures_stand_alone)
    parser.add_render_rule("image", _figure)
    parser.add_render_rule("table_open", _wide_open)
    parser.add_render_rule("table_close", _wide_close)
    return parser


def _pictures_stand_alone(state: "StateCore") -> None:
    """Hide the tags of paragraphs with only a picture: it is rendered as a figure."""
    for k, token in enumerate([] if state.inlineMode else state.tokens):
        children = [child.type for child in token.children or []]
        if token.type == "inline" and children == ["image"]:
            state.tokens[k - 1].hidden = state.tokens[k + 1].hidden = True


def _figure(
    renderer: object,
    tokens: "Sequence[Token]",
    index: int,
    options: object,
    env: Mapping[str, Path],
) -> str:
    """HTML of a picture with its caption; only the caption if it cannot be embedded."""
    token = tokens[index]
    words = html.escape(token.content)
    name = str(token.attrGet("src"))
    path = env.get(FOLDER, Path()) / name
    if Path(name).name != name or not path.is_file():
        return f"<em>{words}</em>\n"
    kind, _ = mimetypes.guess_type(path.name)
    content = base64.b64encode(path.read_bytes()).decode("ascii")
    source = f"data:{kind or 'application/octet-stream'};base64,{content}"
    return (
        f'<figure><img src="{source}" alt="{words}">'
        f"<figcaption>{words}</figcaption></figure>\n"
    )


def _wide_open(*rule: object) -> str:
    return '<div class="wide"><table>\n'


def _wide_close(*rule: object) -> str:
    return "</table></div>\n"


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


def write_figure(figure: "Figure", path: Path) -> None:
    """Write a figure as a PNG file; after an error no partial file remains.

    The figure must be made without pyplot, so that it need not be closed.
    """
    png = io.BytesIO()
    figure.savefig(png, format="png")
    write_bytes(path, png.getvalue())
