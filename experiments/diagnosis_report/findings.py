"""Words for the findings of a diagnosis: effects with places and values, and pulses."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby, pairwise

import numpy as np

from diagnosis.effects import effect as kind_of
from diagnosis.verdict import Estimate, Found, Pulse
from experiments.diagnosis_report.numbers import estimate_text, percent
from experiments.diagnosis_report.place_words import place_words

MANY = 3
"""Number of places from which on an effect is summed up in one clause for all."""

SHOWN = 0.01
"""A value that is smaller than this share of its interval's width is not mentioned,
because the data do not show it. The exact share does not matter."""

_WAYS = {
    "actuator input": "came in at the input of the actuator of {joint}",
    "torque sensor": "came in at the torque sensor of {joint}, which never felt them",
    "position sensor": "came in at the position sensor of {joint} and were no torque",
}


def findings(effects: Sequence[Found], changed: bool = False) -> list[str]:
    """A clause for each effect; one clause for all places of an effect found at many.

    With `changed` they are called changes since the reference recordings, not physics
    that the sim lacks; the surest effect comes first.
    """
    return [
        at_many(group) if len(group) > 1 else finding(group[0], changed)
        for group in told_together(effects)
    ]


def told_together(effects: Sequence[Found]) -> list[list[Found]]:
    """Group effects, in their order, so that each group can be described in one clause.

    Effects of the same name at `MANY` places or more that act all the time form one
    group; every other effect is a group of its own.
    """
    groups: dict[str, list[Found]] = {}
    for effect in effects:
        alike = [one for one in effects if one.name == effect.name]
        many = len(alike) >= MANY and all(
            one.when.kind == "always" and one.parameters for one in alike
        )
        key = effect.name if many else f"{effect.name}@{effect.place}"
        groups.setdefault(key, []).append(effect)
    return [*groups.values()]


def at_many(alike: Sequence[Found]) -> str:
    """A clause on the same effect at many places: its first parameter, or the range."""
    name = next(iter(alike[0].parameters))
    order = sorted(alike, key=lambda one: one.parameters[name].value)

    def value(effect: Found) -> str:
        one = effect.parameters[name]
        alone = estimate_text(replace(one, low=one.value, high=one.value))
        return f"about {alone} at {place_words(effect.place)}"

    label = at_number(alike)
    if len(alike[0].shared_with) == len(alike) - 1:
        same = estimate_text(alike[0].parameters[name])
        return f"{label}, {name.replace('_', ' ')} about {same} at all of them"
    span = f"{name.replace('_', ' ')} from {value(order[0])} to {value(order[-1])}"
    return f"{label}, {span}"


def at_number(alike: Sequence[Found]) -> str:
    """The name of an effect, and the number of places that have it."""
    return f"{kind_of(alike[0].name).words.label} at {len(alike)} places"


def finding(effect: Found, changed: bool = False) -> str:
    """A clause: "the left knee (LKneePitch) has play of about 0.030 rad (...) ...".

    With `changed` it is called a change since the reference recordings, not physics
    that the sim lacks.
    """
    words, values = kind_of(effect.name).words, dict(effect.parameters)
    clause, first = words.finding, next(iter(values), None)
    if first and words.below and values[first].value < 0:
        clause, values[first] = words.below, _negative(values[first])
    numbers = {
        name: f"about {estimate_text(one)}"
        for name, one in values.items()
        if abs(one.value) > SHOWN * (one.high - one.low)
    }
    known = defaultdict(lambda: "an unknown amount", numbers)
    known["joint"] = place_words(effect.place)
    known["body"] = place_words(effect.place, "body")
    known["lacking"] = "that was not there before" if changed else "that the sim lacks"
    known["usual"] = "before" if changed else "in the sim"
    clause = clause.format_map(known)
    course, start_s, end_s = effect.when.kind, effect.when.start_s, effect.when.end_s
    if course == "always":
        return clause
    doing = "from" if course == "burst" else "growing from"
    only = effect.when.recording
    where = f" of {only} only" if only else ""
    return f"{clause}, {doing} {start_s:.3g} to {end_s:.3g} s{where}"


def _negative(one: Estimate) -> Estimate:
    return replace(one, value=-one.value, low=-one.high, high=-one.low)


def parameter_rows(effect: Found) -> list[tuple[str, str]]:
    """Name, and value with interval, of each parameter of an effect, as texts."""
    return [
        (name.replace("_", " "), estimate_text(one))
        for name, one in effect.parameters.items()
    ]


def pulse_sentences(pulses: Sequence[Pulse]) -> Iterator[str]:
    """Yield a sentence for the pulses of each recording, joint and source."""

    def key(pulse: Pulse) -> tuple[str, str, str]:
        return pulse.recording, pulse.joint, pulse.source

    for (recording, joint, source), own in groupby(sorted(pulses, key=key), key):
        alike = list(own)
        way = _WAYS[source].format(joint=place_words(joint))
        yield f"{_amounts(alike)} in {recording} {way}: {_evidence(alike[0])}"


def _amounts(pulses: Sequence[Pulse]) -> str:
    """Number, mean size, median duration and times of some pulses, as text."""
    size = np.mean([pulse.torque for pulse in pulses])
    length_s = np.median([pulse.end_s - pulse.start_s for pulse in pulses])
    apart = [after.start_s - before.start_s for before, after in pairwise(pulses)]
    every = f" every {np.median(apart):.3g} s" if apart else ""
    count = f"{len(pulses)} pulses" if apart else "A pulse"
    return (
        f"{count} of {size:.4g} {pulses[0].unit}, {length_s:.3g} s long, from "
        f"{pulses[0].start_s:.3f} s on{every}"
    )


def _evidence(pulse: Pulse) -> str:
    """Text: which signal jumps with a pulse, and by how much the motion follows it."""
    signal = "position" if pulse.source == "position sensor" else "torque"
    jumps = min(max(pulse.jumps[signal], 0.0), 1.0)
    edges = f"{percent(jumps)} of their edges are in the measured {signal}"
    if signal == "position":
        return edges
    return f"{edges}, and the motion follows {percent(min(max(pulse.felt, 0.0), 1.0))}"
