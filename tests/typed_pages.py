"""What README and docs tell people to type: their commands and code blocks."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
STANDS_FOR = {
    "DIR": "set", "FOLDER": "data", "DATA=FOLDER": "DATA=data", "NAME": "nao",
    "RECORDING...": "air.parquet", "GAIT...": "start",
}  # fmt: skip
"""Words in capitals on the pages, and what a reader may put there."""


def blocks(page, language):
    """The code blocks of a page in one language; "" is what people type."""
    pattern = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
    found = pattern.findall(page.read_text())
    return [code for known, code in found if known == language]


def typed(page):
    """The command lines of a page in its order, without comments, none twice."""
    text = page.read_text()
    lines = [line for block in blocks(page, "") for line in block.splitlines()]
    mentions = re.findall(r"`((?:groundwalk|make|python) [^`\n]+)`", text)
    lines += [line for line in mentions if len(line.split()) > 2 or "make" in line]
    lines = [line.partition(" #")[0].strip() for line in lines]
    lines = [line for line in lines if line and not re.search(r"\bVERB\b|\[", line)]
    commands = [command for line in lines for command in alternatives(line)]
    return list(dict.fromkeys(commands))


def alternatives(line):
    """A line with "a|b" in it stands for two."""
    words = [STANDS_FOR.get(word, word) for word in line.split()]
    for k, word in enumerate(words):
        if "|" in word:
            choices = [[*words[:k], one, *words[k + 1 :]] for one in word.split("|")]
            return [one for words in choices for one in alternatives(" ".join(words))]
    return [" ".join(words)]
