"""Sizes with which a search begins."""

import numpy as np
import pytest
from known_arms import CHANNELS, LEAN
from made_up_traces import arm, recorded

from diagnosis.effects.effect import PlacedEffect
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.candidates import LIMITED, WEAKER, Candidates


def sizes(limit, effect, first):
    plant = arm(limit=limit)
    fit = Predictor(plant, [recorded(plant, duration_s=1.0)], CHANNELS)
    tried = Candidates(fit, [], LEAN)._sizes(PlacedEffect(effect, "elbow", (first,)))
    return [placed.values[0] for placed in tried]


def test_a_motor_may_be_weak_only_where_jumps_ask_for_all_of_it():
    """Quiet motions take half a newton metre, and the servo has eight."""
    tried = sizes(8.0, "torque_limit", 0.5)
    assert tried == pytest.approx([0.5 * k for k in LIMITED] + [8 * s for s in WEAKER])


@pytest.mark.parametrize(
    ("limit", "effect"), [(np.inf, "torque_limit"), (8.0, "speed_limit")]
)
def test_what_has_no_limit_is_no_weaker(limit, effect):
    assert sizes(limit, effect, 0.5) == pytest.approx([0.5 * k for k in LIMITED])
