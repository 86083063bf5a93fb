"""Decides whether the torques that servos ask for are compared with those needed.

A replay follows a robot's motion to the noise of its sensors, if the model does. Where
the model of a real robot leaves many times as much, even of the healthy robot, errors
of all joints mix in replays, and what is left of them goes with nothing. Torques do not
mix: what a joint's servo asks for by its declared gains, less what the motion needs, is
that joint's own error, and how it goes with the joint's motion is learned from the
healthy robot (`healthy_torques.py`).
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.replay.asked import by_servos
from diagnosis.residuals.doubted import no_nuisance
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.torques.torque_evidence import with_motions
from diagnosis.traces.split import shortened, thinned
from diagnosis.traces.trace import Trace

FAR = 5.0
"""Multiple of the sensors' noise that replays of the healthy robot leave, beside what
small mismatch of its model explains to first order, from which on it is far from its
model. Where small mismatch is all there is, 1 to 4 times the noise is left; of four
real robots 8 to 40 times."""

MOST_S = 10.0
"""Most seconds of the healthy robot's recordings that are replayed for that."""

LASTS_S = 0.25
"""Time [s] for which torque that no effect explains stays alike: its means over as long
count as independent."""

ASKED = (
    "the healthy robot moves otherwise than its model, by {times:.0f} times the "
    "sensors' noise beside small mismatch: the torques for which servos ask by their "
    "declared gains are compared with those that the recorded motion needs, and what "
    "the healthy robot shows of their difference is taken as given"
)
"""Sentence for the report where asked torques are compared."""


def with_asked_torques(
    plants: tuple[Plant, Plant], traces: Sequence[Trace], healthy: Sequence[Trace]
) -> tuple[tuple[Trace, ...], tuple[Trace, ...], str] | None:
    """Traces with smoothed motions and asked torques; None if motions are compared.

    `plants` are the nominal model now, and that of the healthy robot, of which
    `healthy` are recordings. Needed are a fixed base, and at all joints servos with
    known gains and commands. Returns both kinds of traces, and a sentence.
    """
    ready = asked_motions(plants[0], (*traces, *healthy)) if healthy else ()
    times = times_noise(plants[1], healthy) if ready else 0.0
    if times < FAR:
        return None
    now, before = tuple(ready[: len(traces)]), tuple(ready[len(traces) :])
    return now, before, ASKED.format(times=times)


def asked_motions(plant: Plant, traces: Sequence[Trace]) -> tuple[Trace, ...]:
    """Traces with the torques that servos ask for, and smoothed motions that need them.

    None of them if the base floats, or some joint lacks a servo with known gains and a
    command.
    """
    if plant.base == "floating" or not all(map(_is_asked, traces)):
        return ()
    torques = [_with_asked(one, plant) for one in traces]
    return tuple(
        replace(one, motion=replace(one.motion, by_servo=True))
        for one in with_motions(plant, torques, LASTS_S)
        if one.motion is not None
    )


def _with_asked(trace: Trace, plant: Plant) -> Trace:
    """A trace, and the rows before it, with the torques that its servos ask for."""
    before = None if trace.before is None else _with_asked(trace.before, plant)
    asked_nm = by_servos(trace, plant.servo.back_emf_nm_s_rad)
    return replace(trace, torque_nm=asked_nm, before=before)


def times_noise(plant: Plant, healthy: Sequence[Trace]) -> float:
    """Rms of what replays of the healthy robot leave beside small mismatch [noise].

    The likeliest small mismatch is that of ridge regression on what each usual error of
    the model changes, which is right to first order.
    """
    some = thinned(plant, shortened(healthy, MOST_S), len(plant.joints))
    predictor = Predictor(plant, some)
    predictor.correct()
    errors = predictor.nuisance_fit(()).seen(no_nuisance(predictor))
    (left,) = predictor.residuals([()])
    changes = errors.changes
    products = np.eye(len(changes)) + changes.products()
    known = np.asarray(np.linalg.solve(products, changes.on(left)))
    rest = (left - changes.by(known))[predictor.scored]
    return float(np.sqrt(np.mean(rest**2)))


def _is_asked(trace: Trace) -> bool:
    """Whether servos with known gains follow commands at all joints of a recording."""
    known = trace.command_rad is not None and trace.command_torque_nm is None
    return known and not trace.unheld and bool((trace.servo.kp_nm_rad > 0).all())
