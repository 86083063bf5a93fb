"""Pulses in words: what was added to a servo's torque, and where it came in."""

from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise

import numpy as np

from diagnosis.verdict.verdict import Pulse
from experiments.diagnosis_report.numbers import percent
from experiments.diagnosis_report.place_words import place_words

_WAYS = {
    "actuator input": "came in at the input of the actuator of {joint}",
    "torque sensor": "came in at the torque sensor of {joint}, which never felt them",
    "position sensor": "came in at the position sensor of {joint} and were no torque",
}


def pulse_sentences(pulses: Sequence[Pulse]) -> Iterator[str]:
    """A sentence for the pulses of each recording, joint and source."""

    def key(pulse: Pulse) -> tuple[str, str, str]:
        return pulse.recording, pulse.joint, pulse.source

    for (recording, joint, source), own in groupby(sorted(pulses, key=key), key):
        alike = list(own)
        way = _WAYS[source].format(joint=place_words(joint))
        yield f"{_amounts(alike)} in {recording} {way}: {_evidence(alike[0])}"


def _amounts(pulses: Sequence[Pulse]) -> str:
    """How many, how large, how long and when."""
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
    """Which signal jumps, and whether the motion obeys."""
    signal = "position" if pulse.source == "position sensor" else "torque"
    jumps = min(max(pulse.jumps[signal], 0.0), 1.0)
    edges = f"{percent(jumps)} of their edges are in the measured {signal}"
    if signal == "position":
        return edges
    return f"{edges}, and the motion obeys {percent(min(max(pulse.felt, 0.0), 1.0))}"
