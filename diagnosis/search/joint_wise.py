"""Differences at many joints at the cost of one joint's.

Servos are stiff, so what is changed at one joint hardly moves the others: a parameter
is nudged at all joints in one replay, and each joint's own channels are its column of
the Jacobian (columns that share no row need one difference only: Curtis, Powell and
Reid 1974). What joints do to each other makes the steps a little worse, not the result.
"""

import numpy as np

from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.fitting import Nudges
from groundwalk.arrays import BoolArray


def joint_wise(predictor: Predictor, model: Model) -> Nudges:
    """Nudges of a model with the same effects at many joints, for `fit_all`."""
    return Nudges(_groups(model), _rows(predictor, model))


def _groups(model: Model) -> list[list[int]]:
    """Numbers of the values that are nudged together: of one effect, the same one."""
    groups: dict[tuple[str, int], list[int]] = {}
    number = 0
    for placed in model:
        for k in range(len(placed.values)):
            groups.setdefault((placed.name, k), []).append(number)
            number += 1
    return list(groups.values())


def _rows(predictor: Predictor, model: Model) -> list[BoolArray]:
    """For each value the rows of the residual that are its own: (N,) flags."""
    rows = []
    for placed in model:
        own = predictor.channels.of_joint(placed.place)
        is_joint = placed.place in predictor.plant.joints
        flags = np.isin(predictor.channel, own) | (not is_joint)
        rows += [flags] * len(placed.values)
    return rows
