"""How much less errors tell that come again whenever a robot does the same.

What a wrong model leaves in one stroke of a joint, it leaves in the next one, too:
strokes are no independent evidence for one more value. How much fewer independent
samples there are says the design effect of samples in clusters (Kish 1965, "Survey
sampling", section 5.4): 1 + (m - 1) r, where each cluster has m samples and r is their
intraclass correlation, found by an analysis of variance (Fisher 1925, "Statistical
methods for research workers", chapter 7). A cluster is here a part of a joint's range
in one direction of motion, a sample what a block of time leaves there in the mean.
"""

from collections.abc import Sequence

import numpy as np

from diagnosis.residuals.predictor import Predictor
from diagnosis.search.chance import independent_blocks
from diagnosis.traces.trace import Trace
from groundwalk.arrays import BoolArray, FloatArray, IntArray

PARTS = 12
"""Number of parts of a joint's range, each of which is passed equally often."""


def design_effect(predictor: Predictor, residual: FloatArray) -> float:
    """By how many times fewer independent samples an (N,) residual has, at least 1.

    What is left of a right model is noise, which does not come again: then it is 1.
    """
    channels = predictor.channels
    width = len(channels.names)
    block = independent_blocks(predictor, residual).reshape(-1, width)[:, 0]
    left, scored = residual.reshape(-1, width), predictor.scored.reshape(-1, width)
    found = list[tuple[float, float]]()
    for number, joint in enumerate(predictor.plant.joints):
        angle, rises = _motion(predictor.traces, number)
        for column in channels.of_joint(joint):
            own = scored[:, column] & np.isfinite(angle)
            if own.any():
                state = _state(angle[own], rises[own])
                found += _correlation(left[own, column], state, block[own])
    if not found:
        return 1.0
    correlation, samples = np.mean(found, axis=0)
    return float(1 + (samples - 1) * max(correlation, 0.0))


def _motion(traces: Sequence[Trace], number: int) -> tuple[FloatArray, BoolArray]:
    """(rows,) measured angle of a joint, and whether it rises."""
    every = [(one.position_rad[:, number], one.compared) for one in traces]
    angle = np.concatenate([own[rows] for own, rows in every])
    rises = np.concatenate([np.gradient(own)[rows] >= 0 for own, rows in every])
    return angle, rises


def _state(angle: FloatArray, rises: BoolArray) -> IntArray:
    """(n,) number of the part of a joint's range, and of the direction of motion."""
    edges = np.quantile(angle, np.arange(1, PARTS) / PARTS)
    return np.asarray(2 * np.digitize(angle, edges) + rises)


def _correlation(
    left: FloatArray, state: IntArray, block: IntArray
) -> list[tuple[float, float]]:
    """Intraclass correlation of what blocks (n,) leave in states (n,), in the mean.

    And the usual number of blocks of a state. Nothing if no state comes again.
    """
    numbers = np.unique([state, block], axis=1, return_inverse=True)
    (clusters, _), sample = numbers
    means = np.bincount(sample, left) / np.bincount(sample)
    cluster = np.unique(clusters, return_inverse=True)[1]
    counts = np.bincount(cluster)
    between, within = len(counts) - 1, len(means) - len(counts)
    if not (between and within):
        return []
    centres = np.bincount(cluster, means) / counts
    usual = float((len(means) - counts @ counts / len(means)) / between)
    above = float(counts @ (centres - means.mean()) ** 2) / between
    inside = float(np.sum((means - centres[cluster]) ** 2)) / within
    total = above + (usual - 1) * inside
    return [((above - inside) / total, usual)] if total > 0 else []
