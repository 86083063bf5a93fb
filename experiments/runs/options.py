"""Options that several verbs share, their check, and the command that repeats a run."""

import dataclasses
import shlex
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, get_args, get_type_hints

from experiments.command_line import VERBS
from groundwalk.errors import BadValueError

RESUMABLE = "; --resume DIR continues the run"
REPEATABLE = "; the same command continues where this one stopped"


class DefaultInt(int):
    """Default of an option, distinguishable from the same number given by a user."""


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """Options of every verb whose runs can be resumed; each verb adds its own.

    Attributes:
      seed: every random number follows from it.
      out: folder of the run; a new one under runs/ by default.
      resume: continue the run of this folder, with its options.
      json: print the result as JSON.

    Example:
      >>> OptimizeGait(out=Path("runs/mine"), seed=2).seed
      2
    """

    if_interrupted: ClassVar[str] = RESUMABLE
    """Text that is printed after "interrupted" on Ctrl-C: how to continue the run."""

    seed: int = 1
    out: Path | None = None
    resume: Path | None = None
    json: bool = False

    def __post_init__(self) -> None:
        """Refuse invalid options before anything is written."""
        check_at_least(self, seed=0)


def check_at_least(options: Any, **least: float) -> None:
    """Refuse options that are smaller than a bound or NaN; those that are None pass.

    Raises:
      BadValueError: an option is smaller, or NaN.

    Example:
      >>> check_at_least(RunOptions(seed=3), seed=0)
    """
    for name, bound in least.items():
        value = getattr(options, name)
        if value is not None and not value >= bound:
            raise BadValueError(f"{name} is {value}; it must be at least {bound:g}")


def options_of(config: Any) -> list["dataclasses.Field[Any]"]:
    """Fields of a dataclass of options: its own, then those of `RunOptions`."""
    return sorted(dataclasses.fields(config), key=lambda field: bool(field.kw_only))


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
