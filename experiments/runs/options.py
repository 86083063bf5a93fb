"""The options that all runs share which can be resumed."""

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from groundwalk.errors import BadValueError


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """What every such run can be told; a verb's configuration adds its own options.

    Attributes:
      seed: every random number follows from it.
      out: the run's folder; a new one under runs/ by default.
      resume: continue the run of this folder.
      json: print the result as JSON.
    """

    seed: int = 1
    out: Path | None = None
    resume: Path | None = None
    json: bool = False

    def __post_init__(self) -> None:
        """Refuse what no run can do, before anything is written."""
        if self.seed < 0:
            raise BadValueError(f"seed is {self.seed}; it must not be negative")


def options_of(config: Any) -> list["dataclasses.Field[Any]"]:
    """The fields of a configuration: its own, and then those of `RunOptions`."""
    return sorted(dataclasses.fields(config), key=lambda field: bool(field.kw_only))
