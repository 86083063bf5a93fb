"""How much doctored recordings say of what was made wrong, in nats a recording.

Torques are compared, since they need no simulation: those that drive the joints, less
those that the model needs for the recorded motion. A doctoring changes the difference.
It shows if that change is large beside two things, once everything is taken out of the
difference that a regression learns from other recordings: beside what is left, and
beside what undoctored recordings seem to have of the same change by themselves, since
no robot is the same in all recordings. Both are those of the reference, so that the
noise of the case's own recordings does not decide whether it is drawn. No code of the
diagnosis is used: what is drawn must not change with what it judges.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import savgol_filter

from experiments.concealed.doctored.labels import tick_s
from experiments.concealed.doctored.parts import Parts
from groundwalk.arrays import FloatArray
from robots.engine_models.inverse_dynamics import InverseDynamics
from worlds.recordings import Recording

LASTS_S = 0.25
"""Time [s] for which what is unexplained stays alike, as in set 2: its means over as
long are taken as independent."""
_SMOOTHED_S, _DEGREE = 0.1, 3
"""Width [s] of the window, and degree of the polynomials, by which motions are smoothed
(Savitzky and Golay 1964)."""
_CREEPING = 0.05
"""Speed, as a share of the rms, at which dry friction changes its sign gradually."""
_RESTS = 0.15
"""Speed, as a share of the rms, below which a joint rests."""
_LEAST = 0.02
"""Smallest rms of what is unexplained, as a share of that of all torque: no
gear is better, even where a joint hardly moves."""
_DRAWN = 0.1
"""Squared ratio of what regression leaves to what each of its columns usually explains:
that of noise to coefficients in ridge regression."""
_TINY = 1e-12


@dataclass(frozen=True, eq=False)
class _Torques:
    """Torques of a recording's joints, and the motion, as (T, j) arrays."""

    drive_nm: FloatArray
    needed_nm: FloatArray
    position_rad: FloatArray
    speed: FloatArray
    acceleration: FloatArray

    @property
    def missing_nm(self) -> FloatArray:
        """(T, j) torque that the model does not explain, 0 where a joint rests.

        There dry friction may have any value.
        """
        return (self.drive_nm - self.needed_nm) * self.moves

    @property
    def moves(self) -> FloatArray:
        """(T, j) 1 where a joint moves, else 0."""
        usual = np.sqrt(np.mean(self.speed**2, axis=0))
        return np.asarray(np.abs(self.speed) > _RESTS * usual, float)

    def is_driven(self, joint: int) -> bool:
        """Whether anything drives a joint: a servo asks for nothing where it rests."""
        return bool(self.drive_nm[:, joint].any())

    def columns(self, joint: int, is_driven: bool) -> FloatArray:
        """(T, k) what a joint's unexplained torque may be in proportion to.

        Its speed, with sign, and, of joints that are driven in some recording, angle,
        acceleration and torque: friction, a wrong gain, zero, weight, rotor.
        """
        q, v = self.position_rad[:, joint], self.speed[:, joint]
        creeping = _CREEPING * max(float(np.sqrt(np.mean(v**2))), _TINY)
        every = [np.ones_like(q), v, np.tanh(v / creeping)]
        if is_driven:
            a, needed = self.acceleration[:, joint], self.needed_nm[:, joint]
            every += [q, np.sin(q), np.cos(q), a, needed]
        return np.stack(every, axis=1) * self.moves[:, [joint]]

    def most_nm(self) -> FloatArray:
        """(j,) rms of the joints' driving torques, or of those needed if larger."""
        both = self.drive_nm**2, self.needed_nm**2
        most = np.max([one.mean(axis=0) for one in both], axis=0)
        return np.asarray(np.sqrt(most))


def nats_of(
    real: tuple[str, Parts], doctored: tuple[str, Parts], driven_by_torque: bool
) -> float:
    """Median information [nats per recording] on what was doctored.

    Args:
      real: text of the model file, and the recordings, before anything is doctored.
      doctored: the same afterwards, with the same names of recordings.
      driven_by_torque: whether measured torques drive the joints, not servos.
    """
    models = [InverseDynamics.of_text(text) for text, _ in (real, doctored)]
    parts, wrong = real[1], doctored[1]
    own, healthy = (
        [_torques(models[0], one, driven_by_torque) for one in every.values()]
        for every in (parts.recordings, parts.reference)
    )

    def changed(was: _Torques, now: Recording) -> FloatArray:
        then = _torques(models[1], now, driven_by_torque)
        rows = min(len(was.speed), len(then.speed))
        change = then.missing_nm[:rows] - was.missing_nm[:rows]
        return np.asarray(_means(change, tick_s(now)) / noise)

    seconds = [tick_s(one) for one in parts.reference.values()]
    leaves = _left_of_each(healthy, own, seconds)
    most = np.max([one.most_nm() for one in (*own, *healthy)], axis=0)
    rms = np.sqrt(np.mean(np.concatenate(leaves) ** 2, axis=0))
    noise = np.maximum(rms, _LEAST * most + _TINY)
    again = zip(healthy, wrong.reference_as_well.values(), strict=True)
    shown = [changed(was, now) for was, now in again]
    seems = [_size(one / noise, of) ** 2 for one, of in zip(leaves, shown, strict=True)]
    told = []
    for was, now in zip(own, wrong.recordings.values(), strict=True):
        square = float(np.sum(changed(was, now) ** 2))
        told.append(0.5 * square / (1 + square * np.mean(seems)))
    return float(np.median(told))


def _left_of_each(
    healthy: Sequence[_Torques], own: Sequence[_Torques], seconds: Sequence[float]
) -> list[FloatArray]:
    """(blocks, j) means of the torques of each healthy recording that others leave.

    Of a single one it is what the case's `own` recordings leave. The recordings' rows
    are so many `seconds` apart.
    """
    found = []
    for i, one in enumerate(healthy):
        others = [*healthy[:i], *healthy[i + 1 :]] or own
        joints = range(one.speed.shape[1])
        parts = [_unexplained(one, others, j, seconds[i]) for j in joints]
        found.append(np.stack(parts, axis=1))
    return found


def _size(seen: FloatArray, change: FloatArray) -> float:
    """How many times (blocks, j) torques seem to have a change in them."""
    rows = min(len(seen), len(change))
    square = float(np.sum(change[:rows] ** 2))
    product = float(np.sum(change[:rows] * seen[:rows]))
    return product / square if square > 0 else 0.0


def _unexplained(
    one: _Torques, learned: Sequence[_Torques], joint: int, seconds: float
) -> FloatArray:
    """(blocks,) means of what regression that is learned elsewhere leaves of a torque.

    It is ridge regression: motions that the others do not have are not guessed at.
    """
    is_driven = any(some.is_driven(joint) for some in (one, *learned))

    def means(some: _Torques) -> tuple[FloatArray, FloatArray]:
        columns = _means(some.columns(joint, is_driven), seconds)
        return columns, _means(some.missing_nm[:, joint : joint + 1], seconds)[:, 0]

    parts = [means(each) for each in learned]
    columns = np.concatenate([x for x, _ in parts])
    target = np.concatenate([y for _, y in parts])
    own, wanted = means(one)
    both = np.concatenate([columns, own])
    size = np.maximum(np.sqrt(np.mean(both**2, axis=0)), _TINY)
    design = columns / size
    gram = design.T @ design + _DRAWN * np.eye(len(size))
    found = np.linalg.solve(gram, design.T @ target)
    return np.asarray(wanted - own / size @ found)


def _means(values: FloatArray, seconds: float) -> FloatArray:
    """(blocks, j) means of (T, j) values over stretches of `LASTS_S`."""
    rows = max(1, round(LASTS_S / seconds))
    count = len(values) // rows
    parts = values[: count * rows].reshape(count, rows, -1)
    return np.asarray(parts.mean(axis=1))


def _torques(model: InverseDynamics, one: Recording, by_torque: bool) -> _Torques:
    """The torques of a recording, its motion being smoothed."""
    q, v, a = _motion(one)
    drive = np.zeros_like(q)
    for j, joint in enumerate(one.joints):
        if by_torque:
            drive[:, j] = _whole(one.columns.get(f"torque.{joint}", np.zeros(len(q))))
        elif joint in one.metadata.servo and f"command.{joint}" in one.columns:
            servo = one.metadata.servo[joint]
            wanted = _whole(one.columns[f"command.{joint}"])
            pulled = servo.kp * (wanted - q[:, j]) - servo.kd * v[:, j]
            drive[:, j] = np.clip(pulled, -servo.max_torque, servo.max_torque)
    return _Torques(drive, model.of(one.joints, q, v, a), q, v, a)


def _motion(one: Recording) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(T, j) smoothed angles, and their first and second derivative."""
    seconds = tick_s(one)
    angles = np.stack([_whole(one.columns[f"position.{j}"]) for j in one.joints], 1)
    width = max(round(_SMOOTHED_S / seconds) | 1, _DEGREE + 2)
    q, v, a = (
        savgol_filter(angles, width, _DEGREE, order, delta=seconds, axis=0)
        for order in range(3)
    )
    return q, v, a


def _whole(values: FloatArray) -> FloatArray:
    """(T,) values without gaps: missing ones are interpolated."""
    there = np.isfinite(values)
    rows = np.arange(len(values))
    return np.asarray(np.interp(rows, rows[there], values[there]))
