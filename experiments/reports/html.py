"""Self-contained HTML pages: no script, style or picture is loaded from outside."""

import base64
import html
import mimetypes
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from markdown_it import MarkdownIt
    from markdown_it.rules_core import StateCore
    from markdown_it.token import Token

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
