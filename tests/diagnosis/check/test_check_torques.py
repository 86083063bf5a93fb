"""What recordings of motor torques can show, of an arm whose controller is unknown."""

import numpy as np
import pytest
from torque_arm import arm, moved, rubbing

from diagnosis.check import check
from diagnosis.residuals.torques.torque_evidence import with_motions
from diagnosis.residuals.torques.torque_predictor import predictor_of

DRY_NM = 2.0


@pytest.fixture(scope="module")
def healthy():
    return check(arm(), [moved(), moved(seed=1)])


@pytest.fixture(scope="module")
def rubs():
    change = rubbing((0.0, DRY_NM, 0.0), 0.0)
    return check(arm(), [moved(change), moved(change, seed=1)])


def off(found, joint):
    """By how many times the noise the sim is off in a joint's torque."""
    return found.off[f"torque.{joint}"]


def test_sizes_are_told_of_what_acts_in_the_equation_of_motion(healthy):
    assert healthy.usable
    told = healthy.size("coulomb_friction@elbow").told
    assert 0.0 < told.value < 0.3
    assert "command_latency@commands" not in {one.key for one in healthy.sizes}


def test_the_sim_is_off_where_a_joint_rubs_and_nowhere_else(healthy, rubs):
    assert off(healthy, "shoulder") < 2
    assert off(rubs, "shoulder") > 4 * off(rubs, "yaw")
    assert off(rubs, "yaw") < 2


def test_a_right_model_leaves_means_of_unit_noise():
    made = predictor_of(arm(), with_motions(arm(), [moved()]))
    drawn = made.drawn(np.random.default_rng(1))
    left = made.residual_of(drawn)[made.scored]
    assert left.shape == made.residuals([()])[0][made.scored].shape
    assert np.sqrt(np.mean(left**2)) == pytest.approx(1.0, abs=0.15)


def test_no_motion_is_proposed_where_nobody_knows_the_servos(healthy):
    assert healthy.proposed == ()
    assert any("no motions are proposed" in line for line in healthy.limits)
