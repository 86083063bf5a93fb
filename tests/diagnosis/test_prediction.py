"""Predictions of an arm whose truth another library integrated: its friction is known.

The right effect leaves the sensors' noise, which was drawn with a known size.
"""

from functools import cache

import numpy as np
import pytest
from known_arms import NOISE_RAD, measured
from made_up_traces import arm
from torque_arm import arm as torque_arm
from torque_arm import loaded, moved

from diagnosis import PlacedEffect, predict
from groundwalk.errors import BadRecordingError

FRICTION = (PlacedEffect("viscous_friction", "elbow", (0.6,)),)
ELSEWHERE = (PlacedEffect("viscous_friction", "shoulder", (0.6,)),)
SEED = np.random.SeedSequence(0)


def viscous(t, q, v):
    return np.array([0.0, -0.6]) * v


@cache
def prediction(effects, before=()):
    return predict(arm(), [measured(9, viscous)], effects, before)


def errors(found):
    """(2,) errors [rad] before and after in each of both joints."""
    floors = np.array([floor for floor, _ in found.channels.values()])
    return [floors * rms for rms in found.squares().rms()]


def test_the_right_effect_leaves_the_noise():
    found = prediction(FRICTION)
    before, after = errors(found)
    assert after == pytest.approx([NOISE_RAD, NOISE_RAD], rel=0.12)
    assert before[1] > 10 * NOISE_RAD
    ratio, (_, elbow) = found.squares().ratios(SEED)
    assert elbow.value == pytest.approx(before[1] / after[1])
    assert ratio.low > 5
    assert [unit for _, unit in found.channels.values()] == ["rad", "rad"]


def test_the_same_effect_at_another_joint_does_not_help():
    found = prediction(ELSEWHERE)
    ratio, _ = found.squares().ratios(SEED)
    assert ratio.high < 1
    # the sim is the same, whatever it is compared with
    assert errors(found)[0] == pytest.approx(errors(prediction(FRICTION))[0], rel=1e-6)


def test_a_sim_that_had_the_effect_before_is_as_good():
    found = prediction(FRICTION, FRICTION)
    ratio, _ = found.squares().ratios(SEED)
    assert ratio.value == pytest.approx(1.0, abs=1e-6)


def test_what_is_drawn_is_what_was_measured():
    (series,) = prediction(FRICTION).series()
    trace = measured(9, viscous)
    elbow = series.channels["position.elbow"]
    assert elbow.real == pytest.approx(trace.position_rad[:, 1], nan_ok=True)
    left = np.sqrt(np.mean((elbow.corrected - elbow.real)[25:] ** 2))
    assert left < 2 * NOISE_RAD < np.sqrt(np.mean((elbow.sim - elbow.real) ** 2))


def test_each_recording_has_its_own_errors():
    found = prediction(FRICTION)
    own, every = found.squares_by_recording(), found.squares()
    assert own.count.shape == (1, 2)
    assert own.before.sum() == pytest.approx(every.before.sum())


def test_a_recording_that_is_too_short():
    with pytest.raises(BadRecordingError, match="at least 1 s"):
        predict(arm(), [measured(9, viscous, duration_s=0.3)], FRICTION)


def test_where_only_torques_are_known_they_are_compared():
    """A load of 0.5 kg, of which the model knows nothing, and one that is not there."""
    recording = moved(loaded(0.5, "lower"), seed=5)
    right, wrong = (
        predict(torque_arm(), [recording], (PlacedEffect("payload_mass", *one),))
        for one in (("lower", (0.5,)), ("turret", (0.5,)))
    )
    names = [f"torque.{joint}" for joint in ("yaw", "shoulder", "elbow")]
    assert list(right.channels) == names
    assert right.squares().ratios(SEED)[0].low > 5
    _, after = right.squares().rms()
    assert (after < 1.2).all()
    # a turret that turns about its own axis does not feel a load on it
    assert wrong.squares().ratios(SEED)[0].value == pytest.approx(1.0, abs=1e-6)
