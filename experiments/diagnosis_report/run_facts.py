"""What a report says of the run that made it."""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class ReportFacts:
    """Where a diagnosis comes from.

    Attributes:
      robot: its name, or the model's file.
      base: "fixed" or "floating".
      command: the command line that makes this report again.
      settings: what was chosen, by name.
      versions: of the code and what it stands on, by name.
      files: what else was written, and what it is, by name relative to the report.
      changed: whether reference recordings of the healthy robot were given, so that the
        question is what has changed since them.
    """

    robot: str
    base: str
    command: str
    settings: Mapping[str, str] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    files: Mapping[str, str] = field(default_factory=dict)
    changed: bool = False
