"""Pushes on bodies, and their drag, in a batch of simulations."""

import numpy as np
from mujoco.batch import Batch

from diagnosis.effects.variants import Variants
from groundwalk.arrays import FloatArray


class OutsideForces:
    """Pushes and drag at the centres of mass of bodies in all simulations."""

    def __init__(
        self, batch: Batch, variants: Variants, runs: int, step_s: float
    ) -> None:
        """Find the bodies that forces act on in simulations of variants in R `runs`."""
        model = variants.plant.model
        self._step_s, self._runs = step_s, runs
        pushes = [
            (row, model.body(push.body).id, push)
            for row, own in enumerate(variants.outside.pushes)
            for push in own
        ]
        self._row = np.array([row for row, _, _ in pushes], int)
        self._body = np.array([body for _, body, _ in pushes], int)
        self._start_s = np.array([push.start_s for _, _, push in pushes])
        self._end_s = self._start_s + [push.duration_s for _, _, push in pushes]
        self._newton = np.array([push.force_n for _, _, push in pushes]).reshape(-1, 3)
        self._drag = np.repeat(variants.outside.drag_n_s_m, runs, axis=0)
        self._dragged = np.argwhere(self._drag).T
        if pushes or self._dragged.size:
            self._force = batch.bind("xfrc_applied")
            self._centres = batch.bind("xipos")
        self.begin()

    def begin(self) -> None:
        """Forget the forces of earlier steps, as the simulations start again."""
        self._share = np.zeros((len(self._row), self._runs))
        self._pushed_n = np.zeros((*self._drag.shape, 3))
        self._last_m: FloatArray | None = None

    def apply(self, time_s: FloatArray) -> None:
        """Set the forces of the step that begins at (R,) times [s], one for a run."""
        if len(self._row):
            self._push(time_s)
        if self._dragged.size:
            self._resist()

    def _push(self, time_s: FloatArray) -> None:
        """Apply each push, scaled by the share of the step in which it acts."""
        begin = np.maximum(time_s, self._start_s[:, None])
        end = np.minimum(time_s + self._step_s, self._end_s[:, None])
        share = np.maximum(end - begin, 0.0) / self._step_s
        if (share == self._share).all():
            return
        self._share = share
        pushed = self._row[:, None] * self._runs + np.arange(self._runs)
        bodies = np.broadcast_to(self._body[:, None], pushed.shape)
        self._pushed_n[pushed, bodies] = 0.0
        force = share[:, :, None] * self._newton[:, None]
        np.add.at(self._pushed_n, (pushed, bodies), force)
        self._force[pushed, bodies, :3] = self._pushed_n[pushed, bodies]

    def _resist(self) -> None:
        """Apply drag, computed from the bodies' mean velocities over the last step."""
        rows, bodies = self._dragged
        centres = self._centres.reshape(*self._drag.shape, 3)[rows, bodies]
        if self._last_m is not None:
            velocity = (centres - self._last_m) / self._step_s
            drag = self._drag[rows, bodies, None] * velocity
            force = self._pushed_n[rows, bodies] - drag
            self._force[rows, bodies, :3] = force
        self._last_m = centres
