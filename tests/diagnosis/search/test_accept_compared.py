"""The best models of a search, each with its own integrator's error."""

import numpy as np
from known_arms import CHANNELS, LEAN
from made_up_search import found
from made_up_traces import arm, recorded

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.accept import CLOSE_NATS, compared_exactly, recombined
from diagnosis.search.judging import Judge
from diagnosis.search.result import SearchResult, keys_of

ARM = arm()
NOISE_RAD = 4e-5
DRAG, OIL = "drag@upper", "viscous_friction@shoulder"


def selected(judged):
    return {key: one.selected for one in judged for key in one.keys}


def test_what_is_the_same_physics_does_as_well():
    """A drag on what one joint turns is that joint's friction, stepped otherwise."""
    effect = ("viscous_friction", "shoulder", 0.6)
    channels = type(CHANNELS)(CHANNELS.names, np.full(2, NOISE_RAD))
    fit, select = (
        Predictor(
            ARM,
            [recorded(ARM, effect, duration_s=3.0, seed=k, noise_rad=NOISE_RAD)],
            channels,
            step_s=0.004,
        )
        for k in range(2)
    )
    models = [
        (PlacedEffect("drag", "upper", (9.0,)),),
        (PlacedEffect("viscous_friction", "shoulder", (0.6,)),),
    ]
    for part in (fit, select):
        part.calibrate(models[0], tolerances=False)
    judge = Judge(fit, select, LEAN)
    before = judge.judged(models)
    # unfair: the error of the one's steps is taken out of both
    assert selected(before)[OIL] > selected(before)[DRAG] + 20
    after = compared_exactly(
        judge, SearchResult(1e6, judge.floor, {1: before}, 1)
    ).best[1]
    assert abs(selected(after)[OIL] - selected(after)[DRAG]) < 3
    assert after[0].keys == {OIL}  # as friction is what is there more often


def test_parts_of_two_answers_may_make_a_third():
    close, far = 100 + 0.5 * CLOSE_NATS, 100 + 2 * CLOSE_NATS
    both = found(
        ARM,
        (100.0, "servo_gain@shoulder", "coulomb_friction@elbow"),
        (close, "servo_gain@elbow", "viscous_friction@elbow"),
        (far, "armature@elbow", "viscous_friction@shoulder"),
    )
    keys = {keys_of(model) for model in recombined(both)}
    assert frozenset({"servo_gain@shoulder", "viscous_friction@elbow"}) in keys
    assert both.winner.keys not in keys
    assert not any("armature@elbow" in own for own in keys)
    assert all(len(own) == 2 for own in keys)


def test_nothing_is_compared_where_nothing_was_found():
    nothing = SearchResult(102.0, 100.0, {1: []}, 0)
    assert compared_exactly(None, nothing) is nothing
