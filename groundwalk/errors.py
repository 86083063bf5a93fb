"""The one base class of the errors that a user can cause, and their wording.

A message says in one line what was wrong, what would be right and, where a name
was misspelt, the nearest one that exists. The command line turns every
`GroundwalkError` into that line and exit status 2.
"""

import difflib
from collections.abc import Iterable


class GroundwalkError(Exception):
    """Something that the caller gave cannot be used; the message says what."""


class UnknownNameError(GroundwalkError):
    """A name that stands for nothing here."""

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        """Word the message.

        Args:
          kind: what the name should stand for, for example "robot".
          name: the name that was given.
          known: every name that would have been right.
        """
        names = sorted(known)
        close = difflib.get_close_matches(str(name).lower(), names, n=1, cutoff=0.5)
        nearest = f"did you mean {close[0]!r}? " if close else ""
        super().__init__(
            f"unknown {kind} {name!r}: {nearest}known are {', '.join(names)}"
        )
        self.name = name
        self.known = names


class BadValueError(GroundwalkError):
    """A value outside of what its meaning allows."""


class BadRecordingError(GroundwalkError):
    """A recording that cannot be read or that contradicts its format."""


class BadModelError(GroundwalkError):
    """A file that holds no model, or not the kind of model that was asked for."""


class RunFolderError(GroundwalkError):
    """A run folder that is in the way, missing or not what it should be."""
