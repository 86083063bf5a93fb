"""Places, effects and channels in words, for example "the left knee (LKneePitch)"."""

import re
from collections.abc import Sequence

from diagnosis import PlacedEffect
from diagnosis.effects import effect as kind_of
from diagnosis.verdict import Found
from worlds.recordings.recording import JOINT_QUANTITIES

_SIDED = re.compile(r"([LR])([A-Z][a-z]+(?:[A-Z][a-z]+)*)")
_SIDES = {"L": "left", "R": "right"}


def place_words(place: str, kind: str = "joint") -> str:
    """A joint or body in words: "the left knee (LKneePitch)", "the joint shoulder_pan".

    Args:
      place: name of the joint or body.
      kind: "joint" or "body"; of any other kind of place the name is returned.
    """
    sided = _SIDED.fullmatch(place)
    if kind not in ("joint", "body"):
        return place
    if sided is None:
        return f"the {kind} {place}"
    parts = [part.lower() for part in re.findall(r"[A-Z][a-z]+", sided[2])]
    if parts[0] == "knee":  # a knee has only one joint
        parts = parts[:1]
    return f"the {_SIDES[sided[1]]} {' '.join(parts)} ({place})"


def at_words(effect: PlacedEffect | Found) -> str:
    """An effect with its place: "dry friction at the left knee (LKneePitch)"."""
    words = kind_of(effect.name).words
    if not words.place_kind:
        return words.label
    return f"{words.label} at {place_words(effect.place, words.place_kind)}"


def answer_words(effects: tuple[PlacedEffect, ...]) -> str:
    """The effects of one answer: "dry friction at hip together with late commands"."""
    return " together with ".join(map(at_words, effects))


def choice(answers: Sequence[tuple[PlacedEffect, ...]]) -> str:
    """Join alternative answers, of which one is right, with "; or"."""
    return "; or ".join(map(answer_words, answers))


def channel_words(channel: str) -> str:
    """A channel in words: "the position of the left knee (LKneePitch)"."""
    kind, _, component = channel.partition(".")
    if kind in JOINT_QUANTITIES:
        return f"the {kind} of {place_words(component)}"
    return channel.replace(".", " ").replace("_", " ")


def listing(parts: list[str], word: str) -> str:
    """Join texts, at least one, with a last word such as "and": "a, b and c"."""
    *first, last = parts
    return f"{', '.join(first)} {word} {last}" if first else last


def sentence(text: str) -> str:
    """Make a text a sentence: a capital letter at its start, a full stop at its end."""
    return f"{text[:1].upper()}{text[1:]}".rstrip(".") + "."
