"""Residuals of torques: their noise, their rows, and what tolerances take out."""

import numpy as np
import pytest
from torque_arm import JOINTS, arm, loaded, moved, rubbing

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.channels import Channels, shared_channels
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.residuals.torques import torque_evidence
from diagnosis.residuals.torques.torque_evidence import with_motions
from diagnosis.residuals.torques.torque_predictor import TorquePredictor, predictor_of
from diagnosis.search.chance import independent_blocks
from diagnosis.search.fitting import fit_all

PAYLOAD = (PlacedEffect("payload_mass", "lower", (1.0,)),)


@pytest.fixture(scope="module")
def trace():
    return with_motions(arm(), [moved(noise_rad=1e-3)])[0]


@pytest.fixture(scope="module")
def right(trace):
    return predictor_of(arm(), [trace])


def test_the_recordings_decide_what_is_compared(trace, right):
    assert isinstance(right, TorquePredictor)
    assert right.channels.names == tuple(f"torque.{name}" for name in JOINTS)
    replayed = predictor_of(arm(), [moved(duration_s=2.0)])
    assert type(replayed) is Predictor


def test_channels_start_from_what_regression_leaves(trace):
    channels = shared_channels(arm(), [trace])
    np.testing.assert_allclose(channels.floor, trace.motion.noise_nm)
    assert (channels.noise >= channels.floor).all()


def test_a_right_model_leaves_noise(right):
    (left,) = right.residuals([()])
    wide = (right.channels.noise / right.channels.floor)[right.channel]
    rms = np.sqrt(np.mean((wide * left)[right.scored] ** 2))
    assert 0.5 < rms < 1.2
    assert not left[~right.scored].any()
    blocks = right.traces[0].ticks / right.traces[0].motion.block_rows
    assert 0.5 * blocks < right.scored.reshape(-1, 3).sum(axis=0).min() < 1.1 * blocks


def test_a_mean_weighs_as_many_rows_as_it_has():
    plant, trace = arm(), with_motions(arm(), [moved(duration_s=4.0)])[0]
    channels = Channels(tuple(f"torque.{name}" for name in JOINTS), np.ones(3))
    motion = trace.motion
    random = np.random.default_rng(0)
    plain = TorquePredictor(plant, [trace], channels)
    noise = random.standard_normal(trace.torque_nm.shape)
    # the noise of a mean over a block counts, not that of a row
    means = plain._means(np.sqrt(motion.block_rows) * noise[None])
    assert np.std(means.reshape(-1)[plain.scored]) == pytest.approx(1.0, abs=0.1)


def test_parts_have_the_residuals_of_the_whole(trace):
    plant, rows = arm(), 60 * trace.motion.block_rows
    parts = [trace.part(0, rows), trace.part(rows, 2 * rows)]
    whole = predictor_of(plant, parts)
    assert whole.calibrate().tolist() == [0, 0, 0]
    bare = whole.nominal()
    both = bare.residuals([PAYLOAD])[0]
    second = whole.part(1, 2).nominal().residuals([PAYLOAD])[0]
    np.testing.assert_allclose(both[3 * 60 :], second, atol=1e-9)


def test_wrong_scales_and_zeros_within_tolerance_are_no_evidence(trace, right):
    plant = arm()
    for wrong in (0.015 * trace.torque_nm, 0.2 * np.ones(3)):
        other = TorquePredictor(plant, [trace], right.channels)
        other._measured = other._measured + wrong
        before, after = (
            float(np.sum(one.residuals([()])[0] ** 2)) for one in (right, other)
        )
        other.calibrate()
        whitened = float(np.sum(other.residuals([()])[0] ** 2))
        assert whitened - before < 0.1 * (after - before)


def test_a_payload_is_no_matter_of_tolerances():
    plant = arm()
    loaded_trace = with_motions(plant, [moved(loaded(1.0, "lower"))])[0]
    predictor = predictor_of(plant, [loaded_trace])
    predictor.calibrate()
    without, with_it = np.sum(predictor.residuals([(), PAYLOAD]) ** 2, axis=1)
    assert without > 5 * with_it


FRICTION = (
    *(PlacedEffect("coulomb_friction", name, (1.0,)) for name in JOINTS),
    *(PlacedEffect("viscous_friction", name, (1.0,)) for name in JOINTS),
)


@pytest.fixture(scope="module")
def rubbed():
    return moved(rubbing((1.0, 2.0, 0.8), (1.5, 3.0, 0.7)), noise_rad=1e-4)


@pytest.mark.parametrize("name", ["SLOW", "SHARE", "ALIKE", "SURE", "WORSE", "HIGHEST"])
@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_a_factor_of_two_in_a_constant_hardly_matters(
    monkeypatch, rubbed, name, factor
):
    value = getattr(torque_evidence, name)
    monkeypatch.setattr(torque_evidence, name, factor * value)
    plant = torque_evidence.with_used_torques(arm(), [rubbed])
    predictor = predictor_of(plant, torque_evidence.with_motions(plant, [rubbed]))
    (fitted,) = fit_all(predictor, [FRICTION])
    values = [one.values[0] for one in fitted.model]
    assert values == pytest.approx([1.0, 2.0, 0.8, 1.5, 3.0, 0.7], rel=0.05)


def test_rows_that_do_not_count_make_no_block_longer(right):
    """Entries lie some rows apart: errors of neighbouring ones must not look apart."""
    shape = right.scored.reshape(-1, 3).shape
    lasting = np.repeat(np.sin(np.arange(shape[0]) / 100), 3) * right.scored
    block = independent_blocks(right, lasting).reshape(shape)[:, 0]
    assert np.bincount(block).min() > 0
    assert block.max() + 1 < 40


def test_errors_of_the_healthy_robot_are_learned_in_means(trace, right):
    (left,) = right.residuals([()])
    scored = right.scored.reshape(-1, 3)
    noise = ReferenceNoise.of((), left.reshape(-1, 3), scored, right.blocks)
    assert noise.power.size > 0
    plant = arm()
    whitened = TorquePredictor(plant, [trace], right.channels, noise=noise)
    assert np.sum(whitened.residuals([()]) ** 2) <= np.sum(left**2) + 1e-9
