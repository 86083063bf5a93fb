"""Options that several verbs of the command line share, and their check."""

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

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
      See docs/python.md.
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
