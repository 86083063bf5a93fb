"""Baseline: sparse regression of the joint torque that the nominal model lacks."""

import time
from collections.abc import Sequence

import numpy as np

from diagnosis.baselines.found import NORMAL_80, found_effect, verdict_of
from diagnosis.baselines.sparse_columns import Column, Torques, torque_columns
from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from diagnosis.verdict import Verdict
from groundwalk.arrays import FloatArray, IntArray

THRESHOLD = 0.1
"""Smallest part of the missing torque that a column must explain to be kept: the norm
of the column times its coefficient, divided by the norm of the missing torque."""

MOST_EFFECTS = 3
"""Largest number of effects in an answer."""

_ROUNDS = 20
"""Number of rounds of thresholding; results no longer change after a few."""

_RIDGE = 0.05
"""Ridge penalty for columns of norm one, PySINDy's default. It makes coefficients
slightly too small; without it they diverge, since the equation of motion itself is a
sum of columns."""


def answer(plant: Plant, traces: Sequence[Trace]) -> Verdict:
    """Name the effects whose columns remain after sequential thresholding, or none.

    Contact forces of a floating base are not known, so there is no answer for one.

    Source: Brunton, Proctor and Kutz 2016, "Discovering governing equations from data
    by sparse identification of nonlinear dynamical systems".
    """
    begun_s = time.monotonic()
    if plant.base == "floating" or any(t.command_rad is None for t in traces):
        limit = "inverse dynamics need a fixed base and position commands"
        return verdict_of(traces, begun_s, limits=(limit,))
    torques = Torques.of(plant, traces)
    columns = torque_columns(plant, traces, torques)
    kept, size, error = sequential_threshold(
        np.stack([column.values for column in columns], axis=1), torques.missing
    )
    ranked = _placed(plant, columns, kept, size, error)
    total = sum(part for _, _, part in ranked)
    effects = tuple(
        found_effect(plant, placed, spans, part / total)
        for placed, spans, part in ranked[:MOST_EFFECTS]
    )
    return verdict_of(traces, begun_s, effects)


def sequential_threshold(
    columns: FloatArray, target: FloatArray, threshold: float = THRESHOLD
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Repeat least squares, each time without the columns that contribute little.

    Of (N, k) columns that explain a target (N,) those are dropped whose norm times
    coefficient is below a share of the target's norm.

    Returns:
      Indices of the columns that remain, their coefficients, and the coefficients'
      standard errors for white residual noise.
    """
    length = np.linalg.norm(columns, axis=0)
    whole = float(np.linalg.norm(target))
    kept = np.flatnonzero(length > 1e-9 * max(float(length.max(initial=0.0)), 1e-300))
    unit = columns[:, kept] / length[kept]
    gram, toward = unit.T @ unit, unit.T @ target
    active, size = np.arange(len(kept)), np.zeros(0)
    for _ in range(_ROUNDS):
        size = np.linalg.solve(_square(gram, active), toward[active])
        large = np.abs(size) >= threshold * whole
        active, size = active[large], size[large]
    fitted = gram[np.ix_(active, active)] @ size
    left = max(whole**2 - float(size @ (2 * toward[active] - fitted)), 0.0)
    variance = left / max(len(target) - len(active), 1)
    spread = np.sqrt(variance * np.diag(np.linalg.inv(_square(gram, active))))
    scale = length[kept[active]]
    return kept[active], size / scale, spread / scale


def _square(gram: FloatArray, active: IntArray) -> FloatArray:
    return gram[np.ix_(active, active)] + _RIDGE * np.eye(len(active))


def _placed(
    plant: Plant,
    columns: Sequence[Column],
    kept: IntArray,
    size: FloatArray,
    error: FloatArray,
) -> list[tuple[PlacedEffect, list[tuple[float, float]], float]]:
    """Effects with values, 80 % intervals and norms of their torques, largest first.

    Coefficients out of a parameter's bounds belong to no effect.
    """
    groups: dict[tuple[str, str], dict[int, tuple[float, float, float]]] = {}
    for index, value, spread in zip(kept, size, error, strict=True):
        column = columns[index]
        name, amount, width = column.named(float(value), float(spread))
        part = abs(float(value)) * float(np.linalg.norm(column.values))
        key = (name, column.place)
        groups.setdefault(key, {})[column.parameter] = (amount, width, part)
    ranked = []
    for (name, place), found in groups.items():
        parameters = effect(name).parameters(plant, place) if name else ()
        values, spans = [], []
        for number, parameter in enumerate(parameters):
            start = parameter.neutral if np.isfinite(parameter.neutral) else 0.0
            amount, width, _ = found.get(number, (start, 0.0, 0.0))
            values.append(amount)
            spans.append((amount - NORMAL_80 * width, amount + NORMAL_80 * width))
        if name and parameters[0].low <= values[0] <= parameters[0].high:
            part = float(np.hypot.reduce([one[2] for one in found.values()]))
            ranked.append((PlacedEffect(name, place, tuple(values)), spans, part))
    return sorted(ranked, key=lambda one: -one[2])
