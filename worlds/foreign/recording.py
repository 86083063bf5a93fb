"""`ForeignRecording`: what a file of another program holds, as columns of format 1."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import ForeignFileError, nearest_name
from worlds.recordings.metadata import RecordingMetadata
from worlds.recordings.recording import (
    JOINT_QUANTITIES,
    POSITION,
    TIME,
    Recording,
    joints_with,
)

_CALENDAR_S = 1e6
"""Times above this are those of a calendar, which no float holds to the nanosecond."""


@dataclass(frozen=True, eq=False)
class ForeignRecording:
    """One rollout out of a foreign file, in SI units and radians, not yet checked.

    Attributes:
      name: name for the recording's file, without an ending.
      columns: values (rows,) by the column names of format 1; NaN is a missing value.
      source: where the values come from, for the recording's metadata.
      notes: what was chosen while reading, one line each, for the user to see.
      robot: name of the robot in the file; "" if it tells none.
    """

    name: str
    columns: Mapping[str, FloatArray]
    source: str
    notes: tuple[str, ...] = ()
    robot: str = ""

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints that have positions, in the order of their columns."""
        return joints_with(POSITION, self.columns)

    def renamed(self, new_names: Mapping[str, str]) -> "ForeignRecording":
        """A copy with other names of joints; those that are not named stay.

        A name may have one `*`, which stands for the same text in the old and the new
        name, as in {"fer_*": "panda_*"}.

        Raises:
          ForeignFileError: no joint has an old name, or two joints would share a name.
        """
        names = {joint: joint for joint in self.joints}
        for old, new in new_names.items():
            found = {joint: _renamed(joint, old, new) for joint in self.joints}
            matches = {joint: one for joint, one in found.items() if one is not None}
            if not matches:
                raise ForeignFileError(self._no_joint(old))
            names |= matches
        twice = [one for one in names.values() if list(names.values()).count(one) > 1]
        if twice:
            raise ForeignFileError(
                f"{self.name}: two joints would be called {twice[0]!r}; "
                "give each its own name"
            )
        return self._with_joints(names)

    def numbered(self, names: Sequence[str]) -> "ForeignRecording":
        """A copy with these names of joints, given in the order of the joints.

        Raises:
          ForeignFileError: there are more or fewer joints than names.
        """
        if len(names) != len(self.joints):
            raise ForeignFileError(
                f"{self.name}: {len(names)} names of joints are given, it has "
                f"{len(self.joints)} ({', '.join(self.joints)})"
            )
        if len(set(names)) < len(names):
            raise ForeignFileError("a name of a joint is given twice")
        return self._with_joints(dict(zip(self.joints, names, strict=True)))

    def without(self, joints: Sequence[str]) -> "ForeignRecording":
        """A copy without some joints.

        Raises:
          ForeignFileError: one of them is not there, or none would be left.
        """
        for joint in joints:
            if joint not in self.joints:
                raise ForeignFileError(self._no_joint(joint))
        kept = {joint: joint for joint in self.joints if joint not in joints}
        if not kept:
            raise ForeignFileError(f"{self.name}: no joint would be left")
        return self._with_joints(kept)

    def recording(self, metadata: RecordingMetadata) -> Recording:
        """The recording of format 1; BadRecordingError if its values break the rules.

        Times of a calendar (since 1970) are counted from the first row on.
        """
        columns = dict(self.columns)
        time_s = np.asarray(columns[TIME])
        if time_s.size and abs(time_s[0]) > _CALENDAR_S:
            columns[TIME] = time_s - time_s[0]
        return Recording(columns, metadata)

    def _no_joint(self, name: str) -> str:
        close = nearest_name(name, self.joints)
        hint = f"did you mean {close!r}? " if close else ""
        return (
            f"{self.name}: there is no joint {name!r}: {hint}"
            f"it has {', '.join(self.joints)}"
        )

    def _with_joints(self, names: Mapping[str, str]) -> "ForeignRecording":
        """A copy with the joints in `names` alone, called by its values."""
        columns = {}
        for name, values in self.columns.items():
            quantity, _, joint = name.partition(".")
            if quantity not in JOINT_QUANTITIES:
                columns[name] = values
            elif joint in names:
                columns[f"{quantity}.{names[joint]}"] = values
        return replace(self, columns=columns)


def joint_columns(
    quantity: str, joints: Sequence[str], values: FloatArray
) -> dict[str, FloatArray]:
    """Columns of a quantity such as "position" from values (rows, joints)."""
    return {f"{quantity}.{one}": values[:, k] for k, one in enumerate(joints)}


def since_start(stamps_ns: np.ndarray) -> FloatArray:
    """Seconds from whole nanoseconds (rows,), calendar times from the first one on.

    The difference is taken in whole numbers: seconds since 1970 in floats are only
    known to 0.2 microseconds.
    """
    late = stamps_ns.size and abs(int(stamps_ns[0])) > _CALENDAR_S * 1e9
    counted = stamps_ns - stamps_ns[0] if late else stamps_ns
    seconds: FloatArray = counted * 1e-9
    return seconds


def _renamed(joint: str, old: str, new: str) -> str | None:
    """The new name of a joint if `old`, which may hold one `*`, is its name."""
    before, star, after = old.partition("*")
    if not star:
        return new if joint == old else None
    match = re.fullmatch(f"{re.escape(before)}(.*){re.escape(after)}", joint)
    return new.replace("*", match[1], 1) if match else None
