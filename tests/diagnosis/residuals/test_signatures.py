import numpy as np
import pytest
from known_arms import CHANNELS
from made_up_traces import arm, recorded

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals import signatures as tries
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.residuals.signatures import (
    signatures,
    signatures_apart,
    signatures_of,
)
from diagnosis.traces.usage import Usage


@pytest.mark.parametrize("few", [True, False])
def test_limits_are_tried_joint_by_joint_where_joints_are_few(few, monkeypatch):
    """A shoulder that collapses takes the elbow along: together they tell little."""
    if not few:
        monkeypatch.setattr(tries, "FEW_JOINTS", 1)
    predictor = Predictor(arm(), [recorded(arm(), duration_s=2.0)], CHANNELS)
    predictor.calibrate()
    assert len(found_in(predictor, "torque_limit")) == 6
    assert (wrong(predictor, "torque_limit") < 1e-6) == few


@pytest.mark.parametrize("reference", [True, False])
def test_all_is_tried_joint_by_joint_beside_errors_of_all_joints(reference):
    """The healthy robot's joints go wrong together, by 30 times the noise."""
    predictor = Predictor(arm(), [recorded(arm(), duration_s=2.0)], CHANNELS)
    if reference:
        rng, scored = np.random.default_rng(3), predictor.scored.reshape(-1, 2)
        left = rng.standard_normal(scored.shape)
        for block in predictor.blocks:
            far = block.waves @ (30 * rng.standard_normal(block.waves.shape[1]))
            left[block.rows] += far[:, None]
        noise = ReferenceNoise.of((), left, scored, predictor.blocks)
        predictor = Predictor(arm(), predictor.traces, CHANNELS, noise=noise)
    predictor.calibrate()
    assert (wrong(predictor, "viscous_friction") < 1e-6) == reference


def test_what_a_joint_changes_at_others_is_simulated_apart():
    predictor = Predictor(arm(), [recorded(arm(), duration_s=2.0)], CHANNELS)
    predictor.calibrate()
    some = [PlacedEffect("armature", joint, (0.05,)) for joint in arm().joints]
    limits = [PlacedEffect("torque_limit", joint, (20.0,)) for joint in arm().joints]
    assert wrong_of(predictor, signatures_of(predictor, some)) > 1
    own = signatures_apart(predictor, [*some, *limits])
    assert {one.placed for one in own} == {*some, *limits}
    apart = [one for one in own if one.placed in some]
    assert wrong_of(predictor, apart) < 1e-6
    assert all(len(one.rows) == len(predictor.scored) for one in apart)
    assert not any(len(one.rows) == len(predictor.scored) for one in own[:2])


def found_in(predictor, name):
    usage = Usage.of(predictor.plant, predictor.traces)
    return signatures(predictor, (), usage, names=[name])


def wrong(predictor, name):
    """The largest error of an effect's signatures, in units of noise."""
    return wrong_of(predictor, found_in(predictor, name))


def wrong_of(predictor, found):
    """The largest error of signatures, in units of noise."""
    nominal, *alone = predictor.residuals([(), *((one.placed,) for one in found)])
    return max(
        float(np.abs(padded(one, len(own)) - (own - nominal)).max())
        for one, own in zip(found, alone, strict=True)
    )


def padded(signature, entries):
    change = np.zeros(entries)
    change[signature.rows] = signature.change
    return change
