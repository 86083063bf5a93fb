"""How much doctored recordings say of what was made wrong, in nats a recording.

Torques are compared, since they need no simulation: those that drive the joints, less
those that the model needs for the recorded motion. A doctoring changes the difference.
It shows if that change is large beside what is left of the difference once everything
is taken out of it that a regression learns from the reference. No code of the
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
_LEAST = 0.02
"""Smallest rms of what is unexplained, as a share of that of all torque: no
gear is better, even where a joint hardly moves."""
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
        """(T, j) torque that the model does not explain."""
        return self.drive_nm - self.needed_nm

    def columns(self, joint: int) -> FloatArray:
        """(T, k) what a joint's unexplained torque may be in proportion to.

        Its speed, with sign, and, of joints that are driven, angle, acceleration and
        torque: friction, a wrong gain, zero, weight, rotor.
        """
        q, v = self.position_rad[:, joint], self.speed[:, joint]
        creeping = _CREEPING * max(float(np.sqrt(np.mean(v**2))), _TINY)
        every = [np.ones_like(q), v, np.tanh(v / creeping)]
        if self.drive_nm[:, joint].any():
            a, needed = self.acceleration[:, joint], self.needed_nm[:, joint]
            every += [q, np.sin(q), np.cos(q), a, needed]
        return np.stack(every, axis=1)

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

    def torques(model: InverseDynamics, one: Recording) -> _Torques:
        return _torques(model, one, driven_by_torque)

    parts = real[1]
    learned = [torques(models[0], one) for one in parts.reference.values()]
    told = []
    for name, one in parts.recordings.items():
        was = torques(models[0], one)
        now = torques(models[1], doctored[1].recordings[name])
        rows = min(len(was.speed), len(now.speed))
        changed = now.missing_nm[:rows] - was.missing_nm[:rows]
        seconds = tick_s(one)
        left = np.stack(
            [_unexplained(was, learned, j) for j in range(was.speed.shape[1])], axis=1
        )
        usual = np.sqrt(np.mean(_means(left, seconds) ** 2, axis=0))
        least = _LEAST * was.most_nm() + _TINY
        shown = _means(changed, seconds) / np.maximum(usual, least)
        told.append(0.5 * float(np.sum(shown**2)))
    return float(np.median(told))


def _unexplained(one: _Torques, learned: Sequence[_Torques], joint: int) -> FloatArray:
    """(T,) what a regression that is learned elsewhere leaves of a joint's torque."""
    columns = np.concatenate([each.columns(joint) for each in learned])
    target = np.concatenate([each.missing_nm[:, joint] for each in learned])
    size = np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-12)
    found = np.linalg.lstsq(columns / size, target, rcond=1e-6)[0] / size
    return np.asarray(one.missing_nm[:, joint] - one.columns(joint) @ found)


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
