"""What firmware of servos does with their errors, as other targets for rigid servos.

Commands come late, their speed may be limited, and then the controller acts, on what
its encoder sees: the motor's angle where there is a spring or play. Only then follow
play and springs.
"""

from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from diagnosis.effects.controllers import ON_S
from diagnosis.effects.parts import SIGN_SPEED_RAD_S
from diagnosis.replay.transmission import LEAST_KP
from groundwalk.arrays import FloatArray

CONTROLLED = "integral_1_s", "dead_band_rad", "rate_share"
"""Attributes of `Joints` that are 0 where a servo only has stiffness and damping."""

DERIVATIVE_LAGS = 10.0
"""The lag of a set-point's rate is kd / kp over this number. Usual are 2 to 20 (Astrom
and Hagglund 2006, "Advanced PID control", chapter 3)."""

LEAST_LAG_S = 1e-9
"""Smallest lag [s], to avoid division by zero: shorter than any step."""

LEAST_WAY_RAD = 1e-12
"""Way [rad] in a step up to which a joint counts as resting, to avoid division by 0."""


class BatchControllers:
    """Integral terms, dead bands and derivatives of set-points of servos in a batch.

    With the error e between set-point c and encoder, 0 within a dead band, a servo
    gives kp (e + int e dt / time) + kd (share dc/dt - v). The integral's part is at
    most its largest torque; c is smoothed by a lag for dc/dt.

    Only joints whose servo has any of this are computed, as (g,) arrays.
    """

    def __init__(
        self,
        joints: Mapping[str, FloatArray],
        law: Mapping[str, FloatArray],
        step_s: float,
    ) -> None:
        """Prepare servos of a `law`, which may fade, at (rows, j) `joints`."""
        self._at = np.nonzero(np.any([joints[name] for name in CONTROLLED], axis=0))
        own = (joints[name][self._at] for name in CONTROLLED)
        self._integral_1_s, self._width_rad, self._share = own
        self._law, self._step_s = law, step_s
        gains = (law[name][self._at] for name in ("kp", "kd"))
        self._passed = -np.expm1(-step_s / derivative_lag_s(*gains))
        self._gathered = -np.expm1(-ON_S * self._integral_1_s)
        self._start_nm = np.zeros_like(self._share)
        self._smooth_rad: FloatArray | None = None
        self._summed_rad = np.zeros_like(self._share)

    @property
    def remembers(self) -> bool:
        """Whether some servo integrates its error, so that its start matters."""
        return bool(self._integral_1_s.any())

    def begin(self, start_nm: FloatArray | None = None) -> None:
        """Begin such that servos that integrate give (rows, j) torques [N m] at first.

        None for servos that do not integrate. An integral has grown towards that for
        `ON_S`, by its own time constant. Set-points begin at rest.
        """
        self._smooth_rad = None
        if start_nm is not None:
            self._start_nm = start_nm[self._at]

    def through(
        self,
        asked_rad: FloatArray,
        aim_rad: FloatArray,
        seen_rad: FloatArray,
        speed_rad_s: FloatArray,
    ) -> FloatArray:
        """Step the controllers once; (rows, j) targets at which a stiffness does so.

        `asked_rad` are the targets for rigid servos without controllers, `aim_rad` the
        mean set-points of the step, `seen_rad` and `speed_rad_s` what encoders see.
        """
        kp, kd, most_nm = (self._law[name][self._at] for name in ("kp", "kd", "limit"))
        kp = np.maximum(kp, LEAST_KP)
        aim, seen = aim_rad[self._at], seen_rad[self._at]
        error = aim - seen
        acts = self._acting(error, speed_rad_s[self._at])
        if self._smooth_rad is None:
            self._smooth_rad = aim
            self._summed_rad = self._gathered * (self._start_nm / kp - acts * error)
        more = self._summed_rad + self._integral_1_s * self._step_s * acts * error
        most = most_nm / kp
        self._summed_rad = np.minimum(np.maximum(more, -most), most)
        moved = self._passed * (aim - self._smooth_rad)
        self._smooth_rad = self._smooth_rad + moved
        lead = self._share * kd / kp * moved / self._step_s
        targets = asked_rad.copy()
        own = acts * (asked_rad[self._at] - seen)
        targets[self._at] = seen + own + self._summed_rad + lead
        return targets

    def _acting(self, error_rad: FloatArray, speed_rad_s: FloatArray) -> FloatArray:
        """(g,) share of the step in which errors are outside of dead bands.

        Within the step the encoder moves on at its speed.
        """
        after = error_rad - speed_rad_s * self._step_s
        low, high = np.minimum(error_rad, after), np.maximum(error_rad, after)
        width = self._width_rad
        inside = np.minimum(high, width) - np.maximum(low, -width)
        way = np.maximum(high - low, LEAST_WAY_RAD)
        moving = 1 - np.minimum(np.maximum(inside, 0.0) / way, 1.0)
        moves = high - low > LEAST_WAY_RAD
        return np.where(moves, moving, np.abs(error_rad) >= width)


def derivative_lag_s(kp_nm_rad: FloatArray, kd_nm_s_rad: FloatArray) -> FloatArray:
    """Lag [s] that smooths set-points for their rates, see `DERIVATIVE_LAGS`.

    It is above 0, where a servo has no damping, too.
    """
    ahead_s = kd_nm_s_rad / np.maximum(kp_nm_rad, LEAST_KP)
    return np.maximum(ahead_s / DERIVATIVE_LAGS, LEAST_LAG_S)


class HeldTorques:
    """Torques [N m] with which the joints of simulations move as they do at present."""

    def __init__(self, model: mujoco.MjModel, batch: Any) -> None:
        """Bind what tells them, before the batch computes it: a later view would lag.

        The batch must have states, and have computed their forces, when `at` is called.
        """
        self._model, self._batch = model, batch
        names = "M", "qfrc_bias", "qfrc_passive", "qvel"
        self._state = [np.asarray(batch.bind(name)) for name in names]

    def at(self, acceleration_rad_s2: FloatArray) -> FloatArray:
        """(rows, nv) torques for accelerations (rows, nv) [rad/s^2].

        They are against gravity, inertia, springs, dampers and constant dry friction,
        whose sign is smoothed near standstill.
        """
        mass, bias, passive, speed = self._state
        nv = self._model.nv
        dry_nm = np.asarray(self._batch.expand("dof_frictionloss"))
        rows = np.repeat(np.arange(nv), self._model.M_rownnz)
        cols = self._model.M_colind
        dense = np.zeros((len(mass), nv, nv))
        dense[:, rows, cols] = dense[:, cols, rows] = mass
        pushed = np.einsum("nij,nj->ni", dense, acceleration_rad_s2)
        way = np.tanh(speed / SIGN_SPEED_RAD_S)
        return np.asarray(pushed + bias - passive + way * dry_nm)
