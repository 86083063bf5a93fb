"""Baseline: fits all parameters with mujoco.sysid, and names the largest change.

The free parameters are those that its users usually free: rotor inertia, viscous and
dry friction, stiffness and damping of the servo at every joint, and the mass of every
body. Each is counted in units of its typical size, so that changes can be compared.
"""

import io
import time
from collections.abc import Sequence
from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import norm

from diagnosis.baselines.found import NORMAL_80, found_effect
from diagnosis.baselines.sysid_models import (
    FreeParameter,
    SysidModels,
    free_parameters,
    sequence_of,
)
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import shared_channels
from diagnosis.residuals.predictor import WARM_UP_S
from diagnosis.traces.trace import Trace
from diagnosis.verdict.verdict import Recordings, Verdict
from groundwalk.arrays import FloatArray
from groundwalk.errors import GroundwalkError

if TYPE_CHECKING:
    from types import ModuleType

SECONDS, FLOATING_SECONDS = 8.0, 2.0
"""Motion that is fitted, all recordings together [s]; contacts are slow to simulate."""

SHORT, LONG = 6, 20
"""Iterations of the optimiser: `SHORT` with more than `MANY` parameters."""

MANY = 60
"""Number of parameters above which fewer iterations are made."""

NUDGE = 0.01
"""Step of the finite differences, as a share of a typical size."""

START = 0.002
"""Distance from a bound, as a share of the range, at which parameters start."""

PRIOR = 3.0
"""Standard deviation of a weak prior, in typical sizes. It is needed since the data do
not distinguish some parameters, such as viscous friction and a servo's damping."""

LEAST_CHANGE = 0.1
"""Smallest change, in typical sizes, that counts as a missing effect."""

_NORMAL_95 = float(norm.ppf(0.975))
_WORST = 1e3
"""Largest residual [standard deviations]; larger ones and NaN are replaced by it."""


def answer(plant: Plant, traces: Sequence[Trace]) -> Verdict:
    """Name the parameter that changed most, of those whose interval excludes no change.

    Args:
      plant: the nominal robot model.
      traces: recordings; their beginnings are fitted.

    Raises:
      GroundwalkError: mujoco.sysid is not installed.
    """
    begun_s = time.monotonic()
    recordings = Recordings(fit=tuple(trace.name for trace in traces))
    free = free_parameters(plant, traces)
    change, half = fitted(plant, _beginnings(plant, traces), free)
    moved = (np.abs(change) >= LEAST_CHANGE) & (np.abs(change) > half)
    size = np.where(moved, np.abs(change), 0.0)
    if not moved.any():
        return Verdict(
            "none", recordings=recordings, seconds=time.monotonic() - begun_s
        )
    best = int(np.argmax(size))
    one = free[best]
    placed = replace(one.placed, values=(one.value(change[best]),))
    spread = half[best] * NORMAL_80 / _NORMAL_95
    span = (one.value(change[best] - spread), one.value(change[best] + spread))
    found = found_effect(plant, placed, [span], size[best] / size.sum())
    return Verdict(
        "effects", (found,), recordings=recordings, seconds=time.monotonic() - begun_s
    )


def fitted(
    plant: Plant, traces: Sequence[Trace], free: Sequence[FreeParameter]
) -> tuple[FloatArray, FloatArray]:
    """Fit all p parameters: their changes (p,), and half widths of 95 % intervals (p,).

    Args:
      plant: the nominal robot model.
      traces: recordings that are fitted as a whole.
      free: the p parameters.
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
        output=io.StringIO(),  # what it prints otherwise
    )
    left, _, _ = residual(best.as_vector(), best)
    with np.errstate(all="ignore"):  # directions that nothing depends on
        _, half = sysid.calculate_intervals(left, np.asarray(result.jac))
    return best.as_vector(), np.nan_to_num(half, nan=np.inf)


class _Residual:
    """Measured less predicted positions, in units of noise, and the prior's part."""

    def __init__(self, plant: Plant, traces: Sequence[Trace]) -> None:
        self._traces = len(traces)
        self._columns = [1 + column for column in plant.qpos]  # time comes first
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
        """As mujoco.sysid asks for it."""
        rows = measured.times >= WARM_UP_S
        times, path = measured.times[rows], state[:, self._columns]
        at = np.stack([np.interp(times, state[:, 0], one) for one in path.T], axis=1)
        at = np.nan_to_num(at, nan=_WORST, posinf=_WORST, neginf=-_WORST)
        wrong = (measured.data[rows] - at) / self._noise
        wrong = np.nan_to_num(np.clip(wrong, -_WORST, _WORST))  # 0 if not measured
        prior = parameters.as_vector() / PRIOR / np.sqrt(self._traces)
        return np.concatenate([wrong.reshape(-1), prior]), measured, measured


def _beginnings(plant: Plant, traces: Sequence[Trace]) -> list[Trace]:
    """The beginning of each trace, all together as long as `SECONDS` allows."""
    seconds = SECONDS if plant.base == "fixed" else FLOATING_SECONDS
    some = traces[: int(seconds)]
    each_s = seconds / len(some)
    parts = []
    for trace in some:
        rows = int(np.searchsorted(trace.time_s - trace.time_s[0], each_s))
        parts.append(trace.part(0, max(rows, 2)) if rows < trace.ticks else trace)
    return parts


def _package() -> "ModuleType":
    sysid = import_module("mujoco.sysid")
    if not hasattr(sysid, "optimize"):
        raise GroundwalkError(
            "mujoco.sysid is not complete: pip install 'mujoco[sysid]'"
        )
    return sysid
