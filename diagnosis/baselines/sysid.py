"""Baseline: fits all parameters with mujoco.sysid, and names the largest change.

The fitted parameters are the usual ones: rotor inertia, viscous and dry friction, servo
stiffness and damping at every joint, and the mass of every body. Each is measured in
units of its typical size, so that changes can be compared.
"""

import io
import time
from collections.abc import Sequence
from dataclasses import replace
from importlib import import_module
from types import ModuleType
from typing import Any

import numpy as np

from diagnosis.baselines.found import NORMAL_80, found_effect, verdict_of
from diagnosis.baselines.sysid_models import (
    FreeParameter,
    SysidModels,
    free_parameters,
    sequence_of,
)
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import shared_channels
from diagnosis.residuals.replays import WARM_UP_S
from diagnosis.traces.reference import Reference
from diagnosis.traces.trace import Trace
from diagnosis.verdict import Verdict
from groundwalk.arrays import FloatArray
from groundwalk.distributions import normal_ppf
from groundwalk.errors import GroundwalkError

SECONDS, FLOATING_SECONDS = 8.0, 2.0
"""Length of motion that is fitted, all recordings together, for a fixed and a floating
base; shorter for the latter, since contacts are slow to simulate."""

SHORT, LONG = 6, 20
"""Number of iterations of the optimiser: `SHORT` if there are more than `MANY`
parameters, to limit the time, else `LONG`."""

MANY = 60
"""Number of parameters above which the optimiser makes fewer iterations."""

NUDGE = 0.01
"""Step of the optimiser's finite differences, as a share of the typical size."""

START = 0.002
"""Least distance of start values from a parameter's bounds, as a share of its range."""

PRIOR = 3.0
"""Standard deviation of a weak prior for each parameter, in typical sizes. It is needed
since data cannot distinguish some parameters, such as viscous friction and servo
damping."""

LEAST_CHANGE = 0.1
"""Smallest change of a parameter, in typical sizes, that counts as a missing effect."""

_NORMAL_95 = normal_ppf(0.975)
_WORST = 1e3
"""Largest residual, in standard deviations of the noise; it replaces larger ones, and
those of simulations that diverge."""


def answer(
    plant: Plant, traces: Sequence[Trace], reference: Reference | None = None
) -> Verdict:
    """Fit all parameters and name the one that changed most, or no effect.

    Only the first seconds of recordings are fitted. Parameters do not count if their
    95 % interval contains the nominal value, or that which the same fit finds in
    recordings of the healthy robot (`reference`). Without position commands there is no
    answer.

    Raises:
      GroundwalkError: mujoco.sysid is not installed.
    """
    begun_s = time.monotonic()
    if any(trace.unheld for trace in traces):
        return verdict_of(traces, begun_s, limits=("it needs position commands",))
    free = free_parameters(plant, traces)
    change, half = fitted(plant, _beginnings(plant, traces), free)
    if reference is not None:
        then = reference.plant
        before, spread = fitted(then, _beginnings(then, reference.traces), free)
        change, half = change - before, np.hypot(half, spread)
    moved = (np.abs(change) >= LEAST_CHANGE) & (np.abs(change) > half)
    size = np.where(moved, np.abs(change), 0.0)
    if not moved.any():
        return verdict_of(traces, begun_s)
    best = int(np.argmax(size))
    one = free[best]
    placed = replace(one.placed, values=(one.value(change[best]),))
    spread = half[best] * NORMAL_80 / _NORMAL_95
    span = (one.value(change[best] - spread), one.value(change[best] + spread))
    found = found_effect(plant, placed, [span], size[best] / size.sum())
    return verdict_of(traces, begun_s, (found,))


def fitted(
    plant: Plant, traces: Sequence[Trace], free: Sequence[FreeParameter]
) -> tuple[FloatArray, FloatArray]:
    """Changes (p,) of p fitted parameters, and half widths (p,) of 95 % intervals.

    Both are in units of the parameters' typical sizes. The whole traces are fitted.
    """
    sysid = _package()
    models = SysidModels(plant, traces, free)
    parameters = sysid.ParameterDict()
    for one in free:
        parameters.add(sysid.Parameter(one.placed.key, 0.0, one.low, one.high))
    parameters.move_off_bounds(START)
    residual = sysid.build_residual_fn(
        models_sequences=[
            sequence_of(sysid, plant, trace, number)
            for number, trace in enumerate(traces)
        ],
        build_model=models.build,
        modify_residual=_Residual(plant, traces),
        n_threads=1,
        resample_true=False,
    )
    best, result = sysid.optimize(
        parameters,
        residual,
        verbose=False,
        max_iters=SHORT if len(free) > MANY else LONG,
        x_scale="jac",
        eps=NUDGE,
        output=io.StringIO(),  # else it prints its progress
    )
    left, _, _ = residual(best.as_vector(), best)
    with np.errstate(all="ignore"):  # parameters may have no influence
        _, half = sysid.calculate_intervals(left, np.asarray(result.jac))
    return best.as_vector(), np.nan_to_num(half, nan=np.inf)


class _Residual:
    """Residuals: measured minus predicted positions in units of noise, and a prior."""

    def __init__(self, plant: Plant, traces: Sequence[Trace]) -> None:
        self._traces = len(traces)
        self._columns = [1 + column for column in plant.qpos]  # column 0 is the time
        self._noise = shared_channels(plant, traces).noise[: len(plant.joints)]

    def __call__(
        self,
        parameters: Any,
        predicted: Any,
        measured: Any,
        model: Any,
        return_all: bool,
        *,
        state: FloatArray,
        **_: Any,
    ) -> tuple[FloatArray, Any, Any]:
        """Residual vector, and measured data twice, as mujoco.sysid requires."""
        rows = measured.times >= WARM_UP_S
        times, path = measured.times[rows], state[:, self._columns]
        at = np.stack([np.interp(times, state[:, 0], one) for one in path.T], axis=1)
        at = np.nan_to_num(at, nan=_WORST, posinf=_WORST, neginf=-_WORST)
        wrong = (measured.data[rows] - at) / self._noise
        wrong = np.nan_to_num(np.clip(wrong, -_WORST, _WORST))  # 0 if not measured
        prior = parameters.as_vector() / PRIOR / np.sqrt(self._traces)
        return np.concatenate([wrong.reshape(-1), prior]), measured, measured


def _beginnings(plant: Plant, traces: Sequence[Trace]) -> list[Trace]:
    """The first seconds of each recording, 8 s in all; for a floating base 2 s."""
    seconds = SECONDS if plant.base == "fixed" else FLOATING_SECONDS
    some = traces[: int(seconds)]
    each_s = seconds / len(some)
    parts = []
    for trace in some:
        rows = int(np.searchsorted(trace.time_s - trace.time_s[0], each_s))
        parts.append(trace.part(0, max(rows, 2)) if rows < trace.ticks else trace)
    return parts


def _package() -> ModuleType:
    sysid = import_module("mujoco.sysid")
    if not hasattr(sysid, "optimize"):
        raise GroundwalkError(
            "mujoco.sysid is not complete: pip install 'mujoco[sysid]'"
        )
    return sysid
