"""The rows of recordings, an array for each quantity that curves are made of."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import maximum_filter1d

from diagnosis.plant.plant import Plant
from diagnosis.replay.asked import AskedTorques, centred
from diagnosis.replay.inverse import NeededTorques
from diagnosis.residuals.replays import Model, variants_of
from diagnosis.residuals.torques.torque_evidence import (
    SLOW,
    SURE,
    cutoff_hz,
    smoothed,
)
from diagnosis.seen.turns import turns
from diagnosis.traces.motion import Motion
from diagnosis.traces.noise import noise_of
from diagnosis.traces.smoothing import smooth_below
from diagnosis.traces.split import shortened
from diagnosis.traces.trace import Trace
from groundwalk.arrays import BoolArray, FloatArray

CHOSEN_S = 15.0
"""Most seconds of the recordings on which the cut-off frequency is chosen."""

STILL = 0.01
"""Speed, as a share of a joint's rms speed, below which it rests: then dry friction may
have any value up to its largest one."""

LEAST_TURN = 0.005
"""Distance, as a share of a joint's range, by which it must move back for a turn."""

NOISE_TURN = 4.0
"""Standard deviations of a position's noise by which it must move back for a turn."""


@dataclass(frozen=True, eq=False)
class Rows:
    """The T rows of all recordings, one after the other, at j joints.

    Motion and torques are smoothed below one frequency, without delay.

    Attributes:
      recording: (T,) index of the recording.
      position_rad, velocity_rad_s, acceleration_rad_s2: (T, j) motion.
      torque_nm: (T, j) torque that the joints had; NaN where unknown.
      needed_nm: (T, j) torque that the motion needs by the nominal model.
      law_nm: (T, j) what the effects of a verdict change of it; where servos ask for
        torques, what they change of these.
      damping_nm: (T, j) torque against the speed by declared damping and back-EMF.
      error_rad: (T, j) command less position; NaN without commands.
      way: (T, j) direction of motion since the last turn, 1 or -1; NaN before it.
      travel_rad: (T, j) travel since the last turn; NaN before it.
      counts: (T, j) whether a joint moves so fast that the sign of its speed is known,
        and does not change it so soon that smoothing blurs the jump of dry friction.
      moves: (T, j) whether it moves at all.
      step: number of rows in half a period of the cut-off frequency, from row to row
        of which the smoothed motion hardly changes.
      cutoff_hz: the frequency below which motion and torque are kept.
    """

    recording: FloatArray
    position_rad: FloatArray
    velocity_rad_s: FloatArray
    acceleration_rad_s2: FloatArray
    torque_nm: FloatArray
    needed_nm: FloatArray
    law_nm: FloatArray
    damping_nm: FloatArray
    error_rad: FloatArray
    way: FloatArray
    travel_rad: FloatArray
    counts: BoolArray
    moves: BoolArray
    step: int
    cutoff_hz: float

    @property
    def loss_nm(self) -> FloatArray:
        """(T, j) torque that the joints had, less the torque that the motion needs."""
        return self.torque_nm - self.needed_nm


def rows_of(
    plant: Plant,
    traces: Sequence[Trace],
    torques: Sequence[FloatArray],
    by_servo: BoolArray,
    model: Model,
) -> Rows:
    """The rows of recordings of a fixed-base robot with (T, j) torques [N m] each.

    `by_servo` (j,) says at which joints they are what servos ask for. The cut-off
    frequency is chosen as in a diagnosis by torques.
    """
    known = [replace(t, torque_nm=u) for t, u in zip(traces, torques, strict=True)]
    highest_hz = cutoff_hz(plant, shortened(known, CHOSEN_S))
    ready = [_with_motion(trace, highest_hz) for trace in known]
    needed, law = _needed(plant, ready, by_servo, model, highest_hz)
    parts = [_columns(trace, highest_hz) for trace in ready]
    columns = {name: np.concatenate([one[name] for one in parts]) for name in parts[0]}
    moving = [_moving(trace, highest_hz) for trace in ready]
    motions = [one.motion for one in ready if one.motion is not None]
    return Rows(
        recording=np.repeat(np.arange(len(ready)), [one.ticks for one in ready]),
        position_rad=np.concatenate([one.position_rad for one in motions]),
        velocity_rad_s=np.concatenate([one.velocity_rad_s for one in motions]),
        acceleration_rad_s2=np.concatenate(
            [one.acceleration_rad_s2 for one in motions]
        ),
        needed_nm=needed,
        law_nm=law,
        counts=np.concatenate([one.counts for one in motions]),
        moves=np.concatenate(moving),
        step=max(1, max(one.block_rows for one in motions)),
        cutoff_hz=highest_hz,
        **columns,
    )


def _with_motion(trace: Trace, highest_hz: float) -> Trace:
    """A trace with its motion below a frequency."""
    found = smoothed(trace, highest_hz)
    position, velocity, acceleration = map(np.nan_to_num, found)
    inside = _inside(trace, highest_hz)[:, None]
    speed = np.sqrt(np.mean(velocity**2, axis=0))
    slowest = np.maximum(SLOW * speed, SURE * _speed_noise(trace, highest_hz))
    rows = max(1, int(0.5 / (highest_hz * trace.tick_s)))
    counts = (np.abs(velocity) > slowest) & inside & _clear(velocity, rows)
    unused = np.zeros(len(speed))
    motion = Motion(position, velocity, acceleration, counts, rows, unused, unused)
    return replace(trace, motion=motion)


def _clear(velocity_rad_s: FloatArray, rows: int) -> BoolArray:
    """(T, j) whether no joint's speed (T, j) changes its sign within so many rows.

    Smoothing blurs the jump of dry friction there, so that it would seem smaller.
    """
    jumps = np.zeros_like(velocity_rad_s, bool)
    jumps[1:] = velocity_rad_s[1:] * velocity_rad_s[:-1] < 0
    return ~np.asarray(maximum_filter1d(jumps, 2 * rows + 1, axis=0))


def _speed_noise(trace: Trace, highest_hz: float) -> FloatArray:
    """(j,) standard deviation [rad/s] of the noise of speeds below a frequency.

    White noise of positions has the same power at all frequencies; that of speeds grows
    with the square of the frequency, up to the cut-off.
    """
    noise = np.array([noise_of(trace.time_s, q).total for q in trace.position_rad.T])
    share = np.sqrt(2 * highest_hz * trace.tick_s / 3)
    return np.asarray(noise * 2 * np.pi * highest_hz * share)


def _inside(trace: Trace, highest_hz: float) -> BoolArray:
    """(T,) whether a row is measured, and not at the recording's ends."""
    since_s = trace.time_s - trace.time_s[0]
    inner = (since_s >= 1 / highest_hz) & (since_s <= since_s[-1] - 1 / highest_hz)
    return np.asarray(inner & np.isfinite(trace.position_rad).all(axis=1))


def _moving(trace: Trace, highest_hz: float) -> BoolArray:
    """(T, j) whether a joint moves at all, in rows that are inside."""
    assert trace.motion is not None
    speed = np.abs(trace.motion.velocity_rad_s)
    least = STILL * np.sqrt(np.mean(speed**2, axis=0))
    return np.asarray((speed > least) & _inside(trace, highest_hz)[:, None])


def _columns(trace: Trace, highest_hz: float) -> dict[str, FloatArray]:
    """Torques, damping, tracking errors, directions and travels (T, j) of one trace."""
    assert trace.motion is not None
    assert trace.torque_nm is not None
    position, error = (
        trace.motion.position_rad,
        np.full_like(trace.position_rad, np.nan),
    )
    if trace.command_rad is not None:
        late = _below(trace.time_s, centred(trace), highest_hz)
        error = late - position
    found = [
        turns(q, _least_turn(trace.time_s, raw))
        for q, raw in zip(position.T, trace.position_rad.T, strict=True)
    ]
    damping = trace.servo.kd_nm_s_rad + trace.servo.back_emf_nm_s_rad
    return {
        "damping_nm": damping * trace.motion.velocity_rad_s,
        "torque_nm": _below(trace.time_s, trace.torque_nm, highest_hz),
        "error_rad": error,
        "way": np.stack([way for way, _ in found], axis=1),
        "travel_rad": np.stack([travel for _, travel in found], axis=1),
    }


def _least_turn(time_s: FloatArray, position_rad: FloatArray) -> float:
    """The distance by which a joint must move back for a turn."""
    known = position_rad[np.isfinite(position_rad)]
    reach = float(np.ptp(known)) if len(known) else 0.0
    return max(NOISE_TURN * noise_of(time_s, position_rad).total, LEAST_TURN * reach)


def _below(time_s: FloatArray, values: FloatArray, highest_hz: float) -> FloatArray:
    """(T, j) values below a frequency; missing ones stay missing."""
    found = [smooth_below(time_s, one, highest_hz).value for one in values.T]
    return np.where(np.isfinite(values), np.stack(found, axis=1), np.nan)


def _needed(
    plant: Plant,
    traces: Sequence[Trace],
    by_servo: BoolArray,
    model: Model,
    highest_hz: float,
) -> tuple[FloatArray, FloatArray]:
    """(T, j) torques of the nominal model, and what the effects of `model` change.

    That change is smoothed as the torques are that it is compared with. The motors'
    back-EMF, which the model has as damping, is part of the torque that joints have,
    not of the torque that they need.
    """
    needed, law = [], []
    in_model = plant.servo.back_emf_nm_s_rad
    for trace in traces:
        assert trace.motion is not None
        own = tuple(one for one in model if one.recording in (None, trace.recording))
        models = [(), own] if own else [()]
        variants = variants_of(plant, models)
        torques = NeededTorques(plant, [trace]).of(variants)
        changed = torques[-1] - torques[0]
        if own and trace.command_rad is not None:
            asked = AskedTorques([trace], in_model).of(torques, variants)
            changed = np.where(by_servo, asked[-1] - asked[0], changed)
        needed.append(torques[0] - in_model * trace.motion.velocity_rad_s)
        law.append(_below(trace.time_s, changed, highest_hz) if own else changed)
    return np.concatenate(needed), np.concatenate(law)
