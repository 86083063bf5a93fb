"""Makes a doctored case: real recordings, of which one thing is made wrong on purpose.

The recordings are real and stay as they are, noise, friction and delays included. What
is wrong is what is said of them: a label, or the model. The truth is the physics that
would have to be added so that all is right again.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from experiments.concealed.doctored import labels
from experiments.concealed.doctored.information import nats_of
from experiments.concealed.doctored.models import ATTRIBUTES, RealModel, published
from experiments.concealed.doctored.parts import Parts, drawn_parts
from experiments.concealed.doctored.plan import planned_real
from experiments.concealed.doctored.robots import (
    IN_MODEL,
    NOTHING,
    OUTSIDE,
    REAL_SETS,
    RealSet,
)
from experiments.concealed.doctored.sizes import TIME_FACTOR, drawn_size
from experiments.concealed.size_by_information import LEVELS
from experiments.concealed.written import MadeCase
from groundwalk.errors import BadRecordingError
from worlds.recordings import Recording

ENGINE = "real"
"""The engine that made the recordings: none."""
BEFORE = "before"
"""Name, without ending, of the model file of the reference."""
LEAST_NATS = LEVELS["L2"]
"""Least information [nats per recording] on what is doctored: less is rarely seen."""
_ATTEMPTS = 2000
"""Largest number of times that recordings, joint and size are drawn until what is
doctored shows: a delay of SO-101 does in one of 30 draws."""
_ALIKE = 0.5
"""Joints are only swapped if the difference of their motions has at least this share of
the smaller motion's rms: otherwise nothing would be wrong."""


@dataclass(frozen=True)
class Doctoring:
    """What was made wrong in a case, in the words of an answer.

    Attributes:
      name: name of the effect, or one of `OUTSIDE`.
      place: the joint or body; "commands" or "clock" for those.
      parameters: values of the effect in SI units.
      refusal: words that a refusal of the recordings must hold to be right.
    """

    name: str
    place: str
    parameters: dict[str, float]
    refusal: tuple[str, ...] = ()


def doctored_case(data: Path, seed: int, number: int, count: int) -> MadeCase:
    """Make case `number` of `count` from the real recordings in a folder of data.

    Raises:
      BadRecordingError: there are no recordings, or none in which the planned
        doctoring would show.
    """
    name, what = planned_real(data, seed, count, number)
    real = REAL_SETS[name]
    for attempt in range(_ATTEMPTS):
        rng = np.random.default_rng([seed, number, attempt])
        model = RealModel.read(data, real)
        parts = drawn_parts(data, real, model.file, rng)
        if what in IN_MODEL and real.published is not None:
            model.give(published(data / real.published))
        before = model.text
        doctored = _doctored(real, what, model, parts, rng)
        if doctored is None:
            continue
        own, done = doctored
        nats = None
        if done is not None:
            nats = nats_of((before, parts), (model.text, own), real.by_torque)
        if nats is None or what in OUTSIDE or real.is_passive or nats >= LEAST_NATS:
            return _made(name, what, (before, model), own, done, nats)
    raise BadRecordingError(
        f"{data / real.folder}: there is no joint at which {what} would show"
    )


def _made(
    name: str,
    what: str,
    models: tuple[str, RealModel],
    parts: Parts,
    done: Doctoring | None,
    nats: float | None,
) -> MadeCase:
    """The case with its truth.

    `models` are the text of the reference's model file, and the model of the case; nats
    is the information on what was doctored.
    """
    before, model = models
    real = REAL_SETS[name]
    effects = [] if done is None else [_plain(done)]
    kind = "outside" if what in OUTSIDE else "none" if what == NOTHING else "single"
    rate_hz = 1 / labels.tick_s(next(iter(parts.reference.values())))
    truth = {
        "plant": name,
        "engine": ENGINE,
        "kind": kind,
        "effects": effects,
        "nats": [] if nats is None or real.is_passive else [nats],
        "drive": "torques" if real.by_torque else "servos",
        "rate_hz": round(rate_hz, 1),
        "reference": True,
        "refusal": [] if done is None else list(done.refusal),
    }
    file = model.file, model.text
    then = f"{BEFORE}{Path(model.file).suffix}", before
    case = parts.recordings, parts.reference, truth
    return MadeCase(name, file, "fixed", *case, then)


def _plain(done: Doctoring) -> dict[str, Any]:
    return {"name": done.name, "place": done.place, "parameters": done.parameters}


def _doctored(
    real: RealSet, what: str, model: RealModel, parts: Parts, rng: np.random.Generator
) -> tuple[Parts, Doctoring | None] | None:
    """The parts with what is doctored, or None if no place for it moves.

    The model is changed where something is taken out of it.
    """
    moving = parts.moving()
    if what == NOTHING:
        return parts, None
    if what == "payload_mass":
        links = [link for link, joint in real.links.items() if joint in moving]
        return (parts, _lighter(model, links, rng)) if links else None
    if what in ATTRIBUTES:
        joints = [one for one in moving if model.attribute(one, ATTRIBUTES[what][0])]
        return (parts, _smoother(what, model, joints, rng)) if joints else None
    if what == "encoder_offset":
        moving = tuple(joint for joint in moving if joint in real.turned)
    return _relabelled(what, parts, moving, rng) if moving else None


def _lighter(
    model: RealModel, links: Sequence[str], rng: np.random.Generator
) -> Doctoring:
    """Take mass from a link, so that a payload of as much must be found."""
    link = str(rng.choice(links))
    mass_kg = drawn_size("payload_mass", rng) * model.mass_kg(link)
    model.take_mass(link, mass_kg)
    return Doctoring("payload_mass", link, {"mass": mass_kg})


def _smoother(
    what: str, model: RealModel, joints: Sequence[str], rng: np.random.Generator
) -> Doctoring:
    """Take rotor inertia or friction from a joint of the model."""
    joint = str(rng.choice(joints))
    attribute, parameter = ATTRIBUTES[what]
    own = model.attribute(joint, attribute)
    taken = drawn_size(what, rng) * own
    model.give({joint: {attribute: own - taken}})
    return Doctoring(what, joint, {parameter: taken})


def _relabelled(
    what: str, parts: Parts, moving: Sequence[str], rng: np.random.Generator
) -> tuple[Parts, Doctoring] | None:
    """Make a label wrong in all recordings of the case, not in its reference."""
    if what == "joints_swapped":
        return _swapped(parts, moving, rng)
    if what == "time_scale":
        done = Doctoring(what, "clock", {"factor": TIME_FACTOR}, ("time",))
        return _each(parts, lambda one: labels.scale_time(one, TIME_FACTOR)), done
    if what == "command_latency":
        tick_s = labels.tick_s(next(iter(parts.recordings.values())))
        ticks = max(1, round(drawn_size(what, rng) / tick_s))
        done = Doctoring(what, "commands", {"delay": ticks * tick_s})
        return _each(parts, lambda one: labels.hurry_commands(one, ticks)), done
    return _at_joint(what, parts, str(rng.choice(moving)), rng)


def _at_joint(
    what: str, parts: Parts, joint: str, rng: np.random.Generator
) -> tuple[Parts, Doctoring]:
    """Make a joint's zero, declared gain or measured torque wrong, to either side."""
    size = drawn_size(what, rng) * float(rng.choice([-1.0, 1.0]))
    if what == "encoder_offset":
        done = Doctoring(what, joint, {"offset": size})
        return _each(parts, lambda one: labels.shift_zero(one, joint, size)), done
    factor = math.exp(size)
    if what == "servo_gain":
        done = Doctoring(what, joint, {"factor": 1 / factor})
        return _each(parts, lambda one: labels.declare_gain(one, joint, factor)), done
    done = Doctoring("torque_scale", joint, {"factor": factor})
    return _each(parts, lambda one: labels.scale_torque(one, joint, factor)), done


def _swapped(
    parts: Parts, moving: Sequence[str], rng: np.random.Generator
) -> tuple[Parts, Doctoring] | None:
    """Exchange what is measured at two joints that do not move alike."""
    pairs = [
        (one, other)
        for k, one in enumerate(moving)
        for other in moving[k + 1 :]
        if all(_differ(each, one, other) for each in parts.recordings.values())
    ]
    if not pairs:
        return None
    one, other = pairs[int(rng.integers(len(pairs)))]
    words = ("swapped", one, other)
    done = Doctoring("joints_swapped", f"{one}, {other}", {}, words)
    return _each(parts, lambda each: labels.swap_joints(each, one, other)), done


def _differ(recording: Recording, one: str, other: str) -> bool:
    """Whether two joints move differently in a recording."""
    motions = [recording.columns[f"position.{joint}"] for joint in (one, other)]
    spreads = [float(np.std(motion)) for motion in motions]
    apart = float(np.std(motions[0] - motions[1]))
    return apart >= _ALIKE * min(spreads) and min(spreads) > 0


def _each(parts: Parts, change: Callable[[Recording], Recording]) -> Parts:
    """The parts with every recording of the case changed; the reference stays."""
    own, reference = (
        {name: change(one) for name, one in every.items()}
        for every in (parts.recordings, parts.reference)
    )
    return replace(parts, recordings=own, wrong_reference=reference)
