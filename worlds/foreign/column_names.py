"""What a column of a foreign table means, read off its name."""

import re
from dataclasses import dataclass

from worlds.foreign.units import known_unit
from worlds.recordings.recording import TIME

_WORDS = {
    TIME: ("time, t, timestamp, stamp, sec, secs, time stamp, elapsed time, elapsed"),
    "position": (
        "position, pos, q, angle, joint position, joint pos, joint angle, joint "
        "q, dof pos, dof position, actual position, actual pos, actual q, "
        "measured position, q actual, q meas, q measured, pos actual, position "
        "actual, present position, theta, qpos, joint positions, positions"
    ),
    "command": (
        "command, cmd, target, goal, action, setpoint, ref, reference, desired, "
        "des, q des, q cmd, q target, q ref, q desired, target q, des q, cmd q, "
        "target position, target pos, goal position, goal pos, desired position, "
        "desired pos, des pos, des dof pos, pos cmd, pos des, position command, "
        "position target, command position, position reference, pos ref, pos "
        "target, joint target, joint pos target, joint command, joint cmd, "
        "position cmd"
    ),
    "velocity": (
        "velocity, vel, qd, dq, qvel, speed, qdot, joint velocity, joint vel, dof "
        "vel, actual velocity, present velocity, omega, actual qd, velocities"
    ),
    "torque": (
        "torque, tau, effort, trq, joint torque, joint effort, measured torque, "
        "actual torque, tau meas, tau est, tau measured, dof torque, efforts, "
        "torques"
    ),
    "command_torque": (
        "command torque, torque command, torque cmd, tau cmd, tau des, tau ff, "
        "target torque, desired torque, torque target, effort command, effort cmd"
    ),
}
"""Names that programs give to the columns of each quantity."""
_PHRASES = {
    tuple(phrase.split()): quantity
    for quantity, phrases in _WORDS.items()
    for phrase in phrases.split(", ")
}
_LONGEST = max(map(len, _PHRASES))

OPEN = {("q", "d"): "a velocity (dq) or a target (desired q)"}
"""Names that are used for two things."""

_BRACKETED_UNIT = re.compile(r"[\[(<]\s*([^\[\]()<>0-9][^\[\]()<>]*)[\])>]\s*$")
_LETTERS_AND_INDEX = re.compile(r"([A-Za-z]+?)_?(\d+)")


@dataclass(frozen=True)
class ColumnMeaning:
    """What a name says.

    Attributes:
      quantity: "time", "position", "command" and so on.
      joint: the joint's name or number; "" for times, and where the name has none.
      unit: the unit in the name; "" if there is none.
      open_between: two things that the name is used for; "" if it is clear.
    """

    quantity: str
    joint: str = ""
    unit: str = ""
    open_between: str = ""

    @property
    def column(self) -> str:
        """The name of the column in format 1."""
        return TIME if self.quantity == TIME else f"{self.quantity}.{self.joint}"


def meaning(name: str) -> ColumnMeaning | None:
    """Guess what a column means from its name; None if the name says nothing.

    The quantity is the longest known phrase with which the name begins or ends; the
    rest of the name is the joint.

    Example:
      >>> meaning("elbow_pos_deg")
      ColumnMeaning(quantity='position', joint='elbow', unit='deg', open_between='')
    """
    bare, unit_text = _without_bracket(name)
    words = _words(bare)
    for count in (0, 1, 2):  # words of a unit at the end, as in `vel_deg_s`
        if count >= len(words):
            break
        rest, tail = words[: len(words) - count], words[len(words) - count :]
        ending = "_".join(tail) if count else unit_text
        found = _quantity(rest)
        if found is None:
            continue
        quantity, joint = found
        if count == 0 and len(words) > 1 and _ends_with_unit(words, quantity):
            continue
        column = TIME if quantity == TIME else f"{quantity}.x"
        unit = known_unit(ending, column) if ending else ""
        if unit is None or (quantity == TIME and joint):
            continue
        open_between = next(
            (why for phrase, why in OPEN.items() if _holds(rest, phrase)), ""
        )
        return ColumnMeaning(quantity, joint, unit, open_between)
    return None


def _ends_with_unit(words: list[str], quantity: str) -> bool:
    """Whether the last word, or the last two, are a unit of the quantity."""
    column = TIME if quantity == TIME else f"{quantity}.x"
    tails = ("_".join(words[-1:]), "_".join(words[-2:]))
    return any(len(one) > 1 and known_unit(one, column) for one in tails) or (
        quantity == TIME and words[-1] == "s"
    )


def _without_bracket(name: str) -> tuple[str, str]:
    match = _BRACKETED_UNIT.search(name)
    return (name[: match.start()], match[1]) if match else (name, "")


def _words(name: str) -> list[str]:
    """The words of a name; a known word with a number, such as q2, is two."""
    words = []
    for word in re.split(r"[^A-Za-z0-9°µ]+", name):
        match = _LETTERS_AND_INDEX.fullmatch(word)
        if match and (match[1].lower(),) in _PHRASES:
            words += [match[1], match[2]]
        elif word:
            words.append(word)
    return words


def _quantity(words: list[str]) -> tuple[str, str] | None:
    """Quantity and joint of words; the longest phrase counts, one in front first."""
    lower = [word.lower() for word in words]
    for size in range(min(_LONGEST, len(words)), 0, -1):
        front, back = tuple(lower[:size]), tuple(lower[-size:])
        if front in _PHRASES:
            return _PHRASES[front], "_".join(words[size:])
        if back in _PHRASES:
            return _PHRASES[back], "_".join(words[:-size])
    return None


def _holds(words: list[str], phrase: tuple[str, ...]) -> bool:
    lower = [word.lower() for word in words]
    return any(
        tuple(lower[k : k + len(phrase)]) == phrase
        for k in range(len(lower) - len(phrase) + 1)
    )
