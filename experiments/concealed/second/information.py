"""How much the recordings of set 2 tell of a hidden effect, in nats a recording.

Compared are two simulations with the same small mismatch, without and with the effect.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from experiments.concealed.size_by_information import KEPT
from groundwalk.arrays import FloatArray
from worlds.hidden import Hidden, HiddenPlant
from worlds.hidden.recorded import HiddenSensors
from worlds.hidden.run import Run

MOST_NATS_2 = 1e4
"""Largest information [nats per recording] that is drawn, in the easiest level, L1."""

LASTS_S = 0.25
"""Time [s] for which the error that small mismatch causes stays alike, about that of a
slow motion's quarter turn."""


@dataclass(frozen=True, eq=False)
class Teller:
    """Tells how much recordings say about effects.

    Small mismatch counts as noise that is correlated over `LASTS_S`: at the frequencies
    of the motion it is as strong as white noise of 2 rate `LASTS_S` times its variance.
    An effect that is lost among the mismatch tells nothing.

    Attributes:
      plant: the robot.
      sensors: its sensors, whose noise is the unit of differences.
      inertia_kg_m2: (j,) inertia at each joint, all others free.
      trial_hz, rate_hz: rows per second, of the simulations and of the recordings: in
        between them white noise is averaged.
      jitter_s: rms error of the time stamps, which counts as noise where joints move.
      torques: whether torques are measured, and the controller is unknown.
      mismatch: for each recording, the variance (j,) of white noise that stands for the
        small mismatch, of angles [rad^2] or torques [(N m)^2]; () for none.
    """

    plant: HiddenPlant
    sensors: HiddenSensors
    inertia_kg_m2: FloatArray
    trial_hz: float
    rate_hz: float
    jitter_s: float
    torques: bool
    mismatch: tuple[FloatArray, ...] = ()

    def beside(self, exact: Sequence[Run], real: Sequence[Run]) -> "Teller":
        """A copy that knows how `real` runs differ from those of an exact model."""
        spread = []
        for was, run in zip(exact, real, strict=True):
            first = run.clock.first
            off = (run.encoder_rad - was.encoder_rad)[first:]
            if self.torques:
                off = self._torque_off(was, run, run.encoder_rad[first:])
            variance = np.mean(np.abs(off) ** 2, axis=0)
            spread.append(2 * LASTS_S * self.trial_hz * variance)
        return replace(self, mismatch=tuple(spread))

    def nats(
        self, without: Sequence[Run], runs: Sequence[Run], effects: Sequence[Hidden]
    ) -> float:
        """Median information [nats per recording] on `effects`, which only `runs` have.

        It is infinite if a simulation diverged. As in set 1 six tenths count.
        """
        if not all(run.ok for run in runs):
            return math.inf
        one = self._by_torque if self.torques else self._by_position
        mismatch = self.mismatch or (np.zeros(len(self.inertia_kg_m2)),) * len(runs)
        told = [
            one(was, run, self._misread(run, effects)[run.clock.first :], small)
            for was, run, small in zip(without, runs, mismatch, strict=True)
        ]
        return float(KEPT * np.median(told))

    def _misread(self, run: Run, effects: Sequence[Hidden]) -> FloatArray:
        """(rows, j) angles as they are written down, without noise."""
        rng, read = np.random.default_rng(0), run.encoder_rad.copy()
        for effect in effects:
            if effect.kind.place == "joint":
                joint, time_s = self.plant.joint(effect.place), run.clock.time_s
                own = read[:, joint]
                read[:, joint] = effect.kind.misread(effect.values, time_s, own, rng)
        return read

    def _variance(self, run: Run) -> FloatArray:
        """(rows, j) variance of the encoders' readings [rad^2], as if fewer."""
        first, time_s = run.clock.first, run.clock.time_s
        speed = np.gradient(run.encoder_rad, time_s, axis=0)[first:]
        sensors = self.sensors
        own = sensors.encoder_rad**2 + sensors.quantum_rad**2 / 12
        white = own + (speed * self.jitter_s) ** 2
        return np.asarray(white * self.trial_hz / self.rate_hz)

    def _by_position(
        self, was: Run, run: Run, read: FloatArray, mismatch: FloatArray
    ) -> float:
        """Half the squared difference of both motions in units of the noise."""
        off = read - was.encoder_rad[was.clock.first :]
        return 0.5 * float(np.sum(off**2 / (self._variance(was) + mismatch)))

    def _by_torque(
        self, was: Run, run: Run, read: FloatArray, mismatch: FloatArray
    ) -> float:
        """Information [nats] in the torque that the nominal robot would not need.

        In the spectrum at angular frequency w (Whittle 1953) its noise is that of the
        torques plus (inertia w^2)^2 times that of the angles.
        """
        off = self._torque_off(was, run, read)
        rows = len(read)
        turning = 2 * np.pi * np.fft.rfftfreq(rows, 1 / self.trial_hz)[1:, None]
        spread_nm = self.sensors.torque_share * self.plant.max_torque_nm
        of_angles = (self.inertia_kg_m2 * turning**2) ** 2 * self._variance(was).mean(0)
        noise = spread_nm**2 * self.trial_hz / self.rate_hz + mismatch + of_angles
        # each frequency but the mean stands for two entries of the spectrum; the
        # entries are scaled so that their mean square is that of the series
        return float(np.sum(np.abs(off) ** 2 / noise))

    def _torque_off(self, was: Run, run: Run, read: FloatArray) -> FloatArray:
        """(f, j) spectrum, without mean, of torque that the model does not explain.

        It is the difference of torques plus inertia w^2 times that of angles. Gravity
        and the coupling of joints are left out, since the controller keeps differences
        small.
        """
        first, rows = was.clock.first, len(read)
        window = np.hanning(rows)[:, None]
        window = window / np.sqrt(rows * np.mean(window**2))
        turning = 2 * np.pi * np.fft.rfftfreq(rows, 1 / self.trial_hz)[:, None]
        torque = np.fft.rfft(window * (run.torque_nm - was.torque_nm)[first:], axis=0)
        angle = np.fft.rfft(window * (read - was.encoder_rad[first:]), axis=0)
        return np.asarray((torque + self.inertia_kg_m2 * turning**2 * angle)[1:])
