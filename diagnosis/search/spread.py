"""At how many joints a model leaves more than noise."""

import numpy as np

from diagnosis.residuals.channels import MORE_THAN_NOISE
from diagnosis.residuals.predictor import Model, Predictor

FEWEST = 2
"""A single joint is never most of them."""


def joints_off(fit: Predictor, model: Model) -> list[str]:
    """Joints in one of whose channels a model leaves much more than noise.

    Small mismatch, fitted beside the model, and its integration error do not count.
    """
    beside = fit.moved_to(model).without_tolerances()
    (left,) = beside.residuals([model], exactly=True)
    squares, channel = left**2, fit.channel[fit.scored]
    count = len(fit.channels.names)
    sums = np.bincount(channel, squares[fit.scored], count)
    off = sums > MORE_THAN_NOISE**2 * np.bincount(channel, minlength=count)
    return [
        joint
        for joint in fit.plant.joints
        if any(off[i] for i in fit.channels.of_joint(joint))
    ]


def is_widespread(fit: Predictor, model: Model, few: int) -> bool:
    """Whether most joints are off, and more than a `few` effects could explain.

    Never on a floating base, whose contacts carry an error at one joint to all others.
    """
    if fit.plant.base == "floating":
        return False
    least = max(len(fit.plant.joints) / 2, few + 1)
    return len(joints_off(fit, model)) >= least
