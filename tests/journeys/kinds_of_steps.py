"""What a test does with a command of a page: it runs it, or says why not."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Run:
    """A command that is run.

    Attributes:
      options: put behind the command; where an option stands twice the last one counts.
      without: words that are left out.
      writes: files that must be there afterwards and can be opened, as glob patterns
        below the folder.
      says: part of what must be printed.
    """

    options: str = ""
    without: tuple[str, ...] = ()
    writes: tuple[str, ...] = ()
    says: str = ""


@dataclass(frozen=True)
class NotRun:
    """A command that no test can run, and what stands in for it.

    Attributes:
      reason: why not.
      brother: a smaller command that is run in the same place of the journey.
      status: exit status of the brother.
      says: part of what the brother must print.
    """

    reason: str
    brother: str
    status: int = 0
    says: str = ""


Step = Run | NotRun


def below(folder: str, names: tuple[str, ...]) -> tuple[str, ...]:
    """The names as they are found below a folder."""
    return tuple(f"{folder}/{name}" for name in names)


def make(target: str, reason: str) -> NotRun:
    """A target of the Makefile that takes too long; what it would do is printed."""
    return NotRun(reason, f"make -n {target}", says="groundwalk")
