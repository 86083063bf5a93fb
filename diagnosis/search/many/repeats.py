"""How much less errors tell that come again whenever a robot does the same.

What a wrong model leaves in one stroke of a joint, it leaves in the next one, too:
strokes are no independent evidence for one more value. How much fewer independent
samples there are says the design effect of samples in clusters (Kish 1965, "Survey
sampling", section 5.4): 1 + (m - 1) r, where each cluster has m samples and r is their
intraclass correlation, found by an analysis of variance (Fisher 1925, "Statistical
methods for research workers", chapter 7). A cluster is here a part of a joint's range
in one direction of motion, a sample what a block of time leaves there in the mean.
"""

import numpy as np

from diagnosis.residuals.predictor import Predictor
from diagnosis.search.chance import independent_blocks
from groundwalk.arrays import FloatArray, IntArray

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
    for joint, state in zip(predictor.plant.joints, _states(predictor), strict=True):
        for column in channels.of_joint(joint):
            own = scored[:, column]
            found += _correlation(left[own, column], state[own], block[own])
    if not found:
        return 1.0
    correlation, samples = np.mean(found, axis=0)
    return float(1 + (samples - 1) * max(correlation, 0.0))


def _states(predictor: Predictor) -> IntArray:
    """(joints, rows) part of each joint's range, and direction of its motion."""
    traces = predictor.traces
    angle = np.concatenate([one.position_rad[one.compared] for one in traces]).T
    rises = np.concatenate(
        [np.gradient(one.position_rad, axis=0)[one.compared] >= 0 for one in traces]
    ).T
    edges = np.quantile(angle, np.arange(1, PARTS) / PARTS, axis=1).T
    parts = [np.digitize(*both) for both in zip(angle, edges, strict=True)]
    return np.asarray(2 * np.array(parts) + rises)


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
