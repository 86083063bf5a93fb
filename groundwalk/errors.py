"""Errors that a user can cause: one base class, and messages of one form.

A message says in one line what was wrong, what would be right and, where a name
was misspelt, the nearest one that exists. The command line turns every
`GroundwalkError` into that line and exit status 2.
"""

import difflib
from collections.abc import Iterable

_LEAST_LIKENESS = 0.5
"""Smallest similarity, `difflib.SequenceMatcher.ratio` from 0 to 1, at which a known
name is suggested. Typing errors give more than 0.8; any value from 0.4 to 0.6 works."""


class GroundwalkError(Exception):
    """An argument, a file or a name cannot be used; the one-line message says why."""


class UnknownNameError(GroundwalkError):
    """A name is unknown; the message lists the known ones and suggests the nearest."""

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        """Compose the message; `kind` is what the name should be, such as "robot"."""
        names = sorted(known)
        close = nearest_name(str(name), names)
        nearest = "" if close is None else f"did you mean {close!r}? "
        super().__init__(
            f"unknown {kind} {name!r}: {nearest}known are {', '.join(names)}"
        )


def nearest_name(name: str, known: Iterable[str]) -> str | None:
    """Find the known name most similar to a given one; None if none is similar.

    Upper and lower case count only to choose between two names that are equally similar
    without them.

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


class ForeignFileError(GroundwalkError):
    """A file of another program cannot be turned into a recording as it is."""


class BadModelError(GroundwalkError):
    """A file holds no robot model, or another kind of model than the caller needs."""


class RunFolderError(GroundwalkError):
    """The folder of a run exists already, is missing or belongs to another command."""
