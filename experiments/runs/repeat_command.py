"""The command line that repeats a run."""

import shlex
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args, get_type_hints

from experiments.command_line import VERBS
from experiments.runs.options import options_of

NOT_REPEATED = frozenset({"out", "resume", "json"})
"""Options that are left out, because they do not change a result."""


def repeat_command(verb: str, config: Any) -> str:
    """The command line that repeats a verb's run.

    That is the command line of this process. If the run was started from Python, as in
    a notebook, it is made from the options that differ from their defaults.
    """
    program = _program(Path(sys.argv[0]))
    if program:
        return shlex.join([*program, *sys.argv[1:]])
    words = [verb] if verb in VERBS else verb.split("-", 1)
    return shlex.join(["groundwalk", *words, *_options(config)])


def _program(path: Path) -> list[str]:
    """The words that started this process; none if groundwalk was not the program."""
    if path.name == "groundwalk":
        return ["groundwalk"]
    ours = Path(__file__).parents[1]
    if path.suffix == ".py" and path.is_relative_to(ours):
        words = path.relative_to(ours.parent).with_suffix("").parts
        module = ".".join(words).removesuffix(".__main__")
        commands = module == "experiments.command_line"
        return ["groundwalk"] if commands else ["python", "-m", module]
    return []


def _options(config: Any) -> Iterator[str]:
    """The command-line words for all options that differ from their defaults."""
    import tyro

    hints = get_type_hints(type(config), include_extras=True)
    for field in options_of(config):
        value = getattr(config, field.name)
        if field.name in NOT_REPEATED or value == field.default:
            continue
        if tyro.conf.Positional not in get_args(hints[field.name]):
            yield _flag(field.name, value)
        if not isinstance(value, bool):
            yield from map(str, value if isinstance(value, tuple) else [value])


def _flag(name: str, value: Any) -> str:
    prefix = "--no-" if value is False else "--"
    return prefix + name.replace("_", "-")
