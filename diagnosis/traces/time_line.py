"""What each stretch of the recordings was used for, what was left out, and why."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from diagnosis.traces.outliers import wrong_samples
from diagnosis.traces.split import Split
from diagnosis.traces.stalls import lag_jumps
from diagnosis.traces.trace import Trace
from diagnosis.verdict import Found, Pulse
from groundwalk.arrays import FloatArray

Use = Literal["fitted", "selected", "held out", "not used"]
"""Use of a stretch: values were fitted to it, models were selected by it, it was held
out for the final errors, or it was left out."""

Event = Literal["stall", "pulse", "wrong sample", "effect"]
"""What happened: all joints follow later from a moment on, a torque that no servo asked
for, a reading that jumps away and back, or an effect that acts only for a while."""

SHORT_S = 0.5
"""Longest gap between two uses, or at an end, that is not told: the cuts between parts
take 0.2 s, so that none knows the other's noise."""


@dataclass(frozen=True)
class Stretch:
    """A stretch of time of one recording.

    Attributes:
      recording: name of the recording.
      start_s: its begin, in the recording's time.
      end_s: its end; equal to `start_s` for a moment.
      what: the use of all rows, or what happened.
      channel: for an event, the joint or channel where it happened; "" for all.
      why: reason or size in words; "" if there is nothing to say.

    Example:
      >>> Stretch("a", 0.0, 5.0, "fitted").end_s
      5.0
    """

    recording: str
    start_s: float
    end_s: float
    what: Use | Event
    channel: str = ""
    why: str = ""


def time_line(
    joints: Sequence[str],
    traces: Sequence[Trace],
    parts: Split,
    pulses: Sequence[Pulse] = (),
    effects: Sequence[Found] = (),
) -> tuple[Stretch, ...]:
    """The stretches of all recordings, in order of recording and time.

    Args:
      joints: names of the joints of the traces.
      traces: the whole recordings as they were given.
      parts: those of them that a diagnosis used.
      pulses: torques that it found no servo to ask for.
      effects: what it found; those that act all the time are not told.

    Example:
      >>> time_line(plant.joints, traces, found.parts)[0].what
      'fitted'
    """
    told = list[Stretch]()
    for trace in traces:
        uses = _uses(trace, parts)
        told += [*uses, *_not_used(trace, uses)]
        told += [*_stalls(trace), *_wrong(trace, joints)]
        told += [*_pulses(trace, pulses), *_effects(trace, effects)]
    order = [trace.name for trace in traces]
    return tuple(
        sorted(told, key=lambda one: (order.index(one.recording), one.start_s))
    )


def _uses(trace: Trace, parts: Split) -> list[Stretch]:
    """The parts of a recording that were used, in order of time."""
    uses: tuple[tuple[Use, Sequence[Trace]], ...] = (
        ("fitted", parts.fit),
        ("selected", parts.select),
        ("held out", parts.test),
    )
    found = [
        Stretch(trace.name, *_ends(part.time_s), use)
        for use, some in uses
        for part in some
        if part.recording == trace.name
    ]
    return sorted(found, key=lambda one: one.start_s)


def _not_used(trace: Trace, uses: Sequence[Stretch]) -> list[Stretch]:
    """The gaps between the uses of a recording that are longer than a cut."""
    first_s, last_s = _ends(trace.time_s)
    starts = [first_s, *(one.end_s for one in uses)]
    ends = [*(one.start_s for one in uses), last_s]
    jumps = [jump.time_s for jump in lag_jumps(trace)]
    found = []
    for start_s, end_s in zip(starts, ends, strict=True):
        if end_s - start_s <= SHORT_S:
            continue
        cut = any(start_s <= one <= end_s for one in jumps)
        why = "beside a stall" if cut else "what was used is enough"
        found.append(Stretch(trace.name, start_s, end_s, "not used", why=why))
    return found


def _stalls(trace: Trace) -> Iterable[Stretch]:
    for jump in lag_jumps(trace):
        way = "later" if jump.later_s > 0 else "earlier"
        why = f"from here on all joints follow {abs(jump.later_s):.2g} s {way}"
        yield Stretch(trace.name, jump.time_s, jump.time_s, "stall", why=why)


def _wrong(trace: Trace, joints: Sequence[str]) -> Iterable[Stretch]:
    for channel, times_s in wrong_samples(trace, joints).items():
        for time_s in times_s.tolist():
            yield Stretch(trace.name, time_s, time_s, "wrong sample", channel)


def _pulses(trace: Trace, pulses: Sequence[Pulse]) -> Iterable[Stretch]:
    for one in pulses:
        if one.recording == trace.name:
            why, at = f"{one.torque:.2g} {one.unit} ({one.source})", one.joint
            yield Stretch(trace.name, one.start_s, one.end_s, "pulse", at, why)


def _effects(trace: Trace, effects: Sequence[Found]) -> Iterable[Stretch]:
    first_s, last_s = _ends(trace.time_s)
    for one in effects:
        when = one.when
        if when.kind == "always" or when.recording not in (None, trace.name):
            continue
        start_s = first_s if when.start_s is None else max(when.start_s, first_s)
        end_s = last_s if when.end_s is None else min(when.end_s, last_s)
        if start_s <= end_s:
            at = one.place, one.name
            yield Stretch(trace.name, start_s, end_s, "effect", *at)


def _ends(time_s: FloatArray) -> tuple[float, float]:
    first, last = np.asarray(time_s)[[0, -1]].tolist()
    return first, last
