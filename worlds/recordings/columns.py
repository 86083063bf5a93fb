"""Column names of a recording: those that exist, and checks that none is missing."""

import difflib
from collections import Counter
from collections.abc import Iterable, Sequence

from groundwalk.errors import BadRecordingError

TIME = "time"
SUPPORT = "support"
ORIENTATION = "base.orientation"
POSITION = "position"
DRIVES = ("command", "command_torque", "torque")
"""Quantities that show what drove a joint: position target, torque target and measured
torque. A recording has at least one of their columns, such as command.knee."""
JOINT_QUANTITIES = (POSITION, "velocity", *DRIVES)
VECTORS = {
    "base.position": ("x", "y", "z"),
    ORIENTATION: ("w", "x", "y", "z"),
    "base.linear_velocity": ("x", "y", "z"),
    "base.angular_velocity": ("x", "y", "z"),
    "gyroscope": ("x", "y", "z"),
    "accelerometer": ("x", "y", "z"),
    "foot_force": ("left", "right"),
    "foot_force.left": ("front_left", "front_right", "rear_left", "rear_right"),
    "foot_force.right": ("front_left", "front_right", "rear_left", "rear_right"),
}


def vector_columns(vector: str) -> tuple[str, ...]:
    """Column names of a vector, such as gyroscope.x, .y and .z of "gyroscope"."""
    return tuple(f"{vector}.{component}" for component in VECTORS[vector])


FIXED = (
    TIME,
    SUPPORT,
    *(name for vector in VECTORS for name in vector_columns(vector)),
)


def joints_with(quantity: str, names: Iterable[str]) -> tuple[str, ...]:
    """The joints that have a column `<quantity>.<joint>` in `names`, in their order."""
    prefix = f"{quantity}."
    return tuple(name[len(prefix) :] for name in names if name.startswith(prefix))


def check_names(names: Sequence[str]) -> None:
    """Check that columns with these names can make up a recording.

    Raises:
      BadRecordingError: a column is unknown, there twice or missing.
    """
    _check_each(names)
    _check_required(names)
    _check_joints(names)
    _check_vectors(names)


def nearest(name: str, known: Iterable[str]) -> str:
    """Hint for an error message: "; did you mean 'x'?", or "" if no name is similar."""
    close = difflib.get_close_matches(name, list(known), n=1)
    return f"; did you mean {close[0]!r}?" if close else ""


def _check_each(names: Sequence[str]) -> None:
    for name, times in Counter(names).items():
        if times > 1:
            raise BadRecordingError(f"column {name!r} is there {times} times")
        quantity, _, joint = name.partition(".")
        is_of_joint = quantity in JOINT_QUANTITIES and joint and joint.isprintable()
        if name not in FIXED and not is_of_joint:
            of_joint = [f"{quantity}.{joint}" for quantity in JOINT_QUANTITIES]
            hint = nearest(name, (*FIXED, *of_joint)) or (
                f"; columns are {TIME}, {SUPPORT}, those of the vectors "
                f"{', '.join(VECTORS)}, and {', '.join(JOINT_QUANTITIES)} of a joint, "
                f"such as '{POSITION}.knee'"
            )
            raise BadRecordingError(f"unknown column {name!r}{hint}")


def _check_required(names: Sequence[str]) -> None:
    if TIME not in names:
        raise BadRecordingError(f"no column {TIME!r}")
    if not joints_with(POSITION, names):
        raise BadRecordingError(f"no column '{POSITION}.<joint>'")
    if not any(joints_with(quantity, names) for quantity in DRIVES):
        raise BadRecordingError(
            "no column says what drove the joints; one of "
            f"{', '.join(f'{quantity}.<joint>' for quantity in DRIVES)} is needed"
        )


def _check_joints(names: Sequence[str]) -> None:
    measured = dict.fromkeys(joints_with(POSITION, names))
    for quantity in JOINT_QUANTITIES:
        for joint in joints_with(quantity, names):
            if joint not in measured:
                raise BadRecordingError(
                    f"column '{quantity}.{joint}' has no '{POSITION}.{joint}' "
                    f"beside it{nearest(joint, measured)}"
                )


def _check_vectors(names: Sequence[str]) -> None:
    for vector in VECTORS:
        columns = vector_columns(vector)
        missing = [name for name in columns if name not in names]
        if missing and len(missing) < len(columns):
            raise BadRecordingError(
                f"column {missing[0]!r} is missing; {vector} is only of use whole "
                f"({', '.join(columns)})"
            )
