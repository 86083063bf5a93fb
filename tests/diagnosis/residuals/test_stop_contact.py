"""End stops in compared torques: they bear what presses a joint against them."""

import numpy as np
import pytest
from torque_arm import arm, moved

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.signatures import signatures
from diagnosis.residuals.torques.torque_evidence import with_motions
from diagnosis.residuals.torques.torque_predictor import predictor_of
from diagnosis.search.candidates import Candidates
from diagnosis.search.fitting import fit_all
from diagnosis.search.rules import Rules
from diagnosis.traces.usage import Usage

REACH_RAD = float(np.max(moved().position_rad[:, 2]))
"""How far the elbow goes without a stop."""

STOP_RAD = REACH_RAD - 0.05


def stopped(model):
    """The true elbow does not go further than that."""
    joint = model.joint("elbow").id
    model.jnt_range[joint] = -10.0, STOP_RAD
    model.jnt_limited[joint] = 1
    model.jnt_solref[joint] = 0.002, 1.0
    model.jnt_solimp[joint] = 0.99, 0.999, 0.001, 0.5, 2


@pytest.fixture(scope="module")
def blocked():
    return predicted(moved(stopped))


@pytest.fixture(scope="module")
def free():
    return predicted(moved())


def predicted(trace):
    some = predictor_of(arm(), with_motions(arm(), [trace]))
    some.calibrate()
    return some


def stop(angle_rad, side=1.0, joint="elbow"):
    return (PlacedEffect("end_stop", joint, (angle_rad, side)),)


def energies(predictor, *models):
    return (0.5 * predictor.residuals([(), *models]) ** 2).sum(axis=1)


def test_the_right_stop_explains_what_presses_against_it(blocked):
    nothing, right, beyond, behind, below, other = energies(
        blocked,
        stop(STOP_RAD),
        stop(STOP_RAD + 0.05),
        stop(STOP_RAD - 0.05),
        stop(STOP_RAD, side=-1.0),
        stop(STOP_RAD, joint="shoulder"),
    )
    assert right < nothing - 100
    assert beyond == pytest.approx(nothing)  # it was never reached
    # joints went beyond these
    assert min(behind, below, other) > nothing


def test_it_is_found(blocked):
    usage = Usage.of(blocked.plant, blocked.traces)
    found = signatures(blocked, (), usage)
    best = Candidates(blocked, found, Rules()).alone(blocked.residuals([()])[0])
    fits = fit_all(blocked, best)
    first = min(fits, key=lambda fit: fit.energy).model[0]
    assert (first.name, first.place) == ("end_stop", "elbow")
    assert first.values[0] == pytest.approx(STOP_RAD, abs=0.005)
    assert first.values[1] > 0


def test_a_robot_without_a_stop_has_none(free):
    angles = [stop(REACH_RAD + far) for far in (-0.02, 0.0, 0.02)]
    nothing, *others = energies(free, *angles)
    assert min(others) > nothing - 1
