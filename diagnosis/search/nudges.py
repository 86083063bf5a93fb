"""Which values of a model a fit changes together in finite differences."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.residuals.coordinates import Coordinates
from diagnosis.residuals.predictor import Predictor
from groundwalk.arrays import BoolArray

MANY = 3
"""From this number of joints on, an effect's values are changed at all together."""


@dataclass(frozen=True, eq=False)
class Nudges:
    """Which values of a model are changed together in finite differences (nudged).

    Attributes:
      groups: indices of the values that are changed together; each group takes one
        simulation.
      rows: for each value (N,) flags of the entries of the residual that it changes.
    """

    groups: Sequence[Sequence[int]]
    rows: Sequence[BoolArray]


def nudges_of(predictor: Predictor, coordinates: Coordinates) -> Nudges:
    """Change values of one kind together if many joints have them.

    A change at one joint hardly moves the others, since servos are stiff and compared
    torques belong to one joint each: every joint's own channels are taken as the column
    of its value in the Jacobian (columns without a common row need one difference only:
    Curtis, Powell and Reid 1974). The coupling between joints that is ignored slows
    convergence and hardly changes the result.
    """
    own = [list[str]() for _ in coordinates.parameters]
    kinds = [("", 0) for _ in coordinates.parameters]
    for placed, columns in zip(coordinates.model, coordinates.columns, strict=True):
        for k, column in enumerate(columns):
            own[column].append(placed.place)
            kinds[column] = placed.name, k
    groups: dict[tuple[str, int, int], list[int]] = {}
    rows: list[BoolArray] = []
    plant, channels = predictor.plant, predictor.channels
    for column, (name, k) in enumerate(kinds):
        apart = (
            plant.base == "fixed"
            and kinds.count((name, k)) >= MANY
            and effect(name).joint_by_joint
            and all(place in plant.joints for place in own[column])
        )
        groups.setdefault((name, k, -1 if apart else column), []).append(column)
        mine = [i for place in own[column] for i in channels.of_joint(place)]
        rows.append(np.isin(predictor.channel, mine) | (not apart))
    return Nudges(list(groups.values()), rows)
