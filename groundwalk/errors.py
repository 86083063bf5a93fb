"""Errors that a user can cause: one base class, and a common wording.

A message says in one line what was wrong, what would be right and, where a name
was misspelt, the nearest one that exists. The command line turns every
`GroundwalkError` into that line and exit status 2.
"""

import difflib
from collections.abc import Iterable

_LEAST_LIKENESS = 0.5
"""Share of equal letters (`difflib`'s ratio) from which on a name is suggested. Typing
errors give more than 0.8; insensitive between 0.4 and 0.6."""


class GroundwalkError(Exception):
    """An argument, a file or a name cannot be used; the one-line message says why."""


class UnknownNameError(GroundwalkError):
    """A name is not one of those that are known; the message suggests the nearest."""

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        """Word the message.

        Args:
          kind: what the name should stand for, for example "robot".
          name: the name that was given.
          known: every name that would have been right.
        """
        names = sorted(known)
        close = nearest_name(str(name), names)
        nearest = "" if close is None else f"did you mean {close!r}? "
        super().__init__(
            f"unknown {kind} {name!r}: {nearest}known are {', '.join(names)}"
        )
        self.name = name
        self.known = names


def nearest_name(name: str, known: Iterable[str]) -> str | None:
    """The known name that resembles a name most; None if none is like it.

    Capital letters do not count, unless two names resemble it alike.

    Args:
      name: as it was given.
      known: names that exist.

    Example:
      >>> nearest_name("LKnePitch", ["RKneePitch", "LKneePitch"])
      'LKneePitch'
    """

    def likeness(other: str) -> tuple[float, float]:
        pairs = ((name.lower(), other.lower()), (name, other))
        loose, exact = (difflib.SequenceMatcher(None, *pair).ratio() for pair in pairs)
        return loose, exact

    close = max(known, key=likeness, default=None)
    if close is None or likeness(close)[0] < _LEAST_LIKENESS:
        return None
    return close


class BadValueError(GroundwalkError):
    """A value is outside of its allowed range, or of the wrong kind."""


class BadRecordingError(GroundwalkError):
    """A recording cannot be read, or contradicts the recording format."""


class BadModelError(GroundwalkError):
    """A file holds no model, or another kind of model than was asked for."""


class RunFolderError(GroundwalkError):
    """A run folder exists already, is missing, or is not of the expected kind."""
