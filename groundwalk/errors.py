"""The one base class of the errors that a user can cause, and their wording.

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
    """A value outside of what its meaning allows."""


class BadRecordingError(GroundwalkError):
    """A recording that cannot be read or that contradicts its format."""


class BadModelError(GroundwalkError):
    """A file that holds no model, or not the kind of model that was asked for."""


class RunFolderError(GroundwalkError):
    """A run folder that is in the way, missing or not what it should be."""
