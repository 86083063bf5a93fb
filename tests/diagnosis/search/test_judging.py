"""How models are judged on data that they were not fitted to."""

import numpy as np
import pytest
from known_arms import CHANNELS, LEAN
from made_up_traces import arm, recorded

from diagnosis.residuals.predictor import Predictor
from diagnosis.search.judging import Judge

ARM = arm()
NOISE_RAD, STEP_S = 4e-5, 0.004


def judge(friction_nm):
    """A judge of an arm whose shoulder has less friction than would be found."""
    rubs = ("coulomb_friction", "shoulder", friction_nm)
    channels = type(CHANNELS)(CHANNELS.names, np.full(2, NOISE_RAD))
    own = {"duration_s": 3.0, "noise_rad": NOISE_RAD}
    fit, select = (
        Predictor(ARM, [recorded(ARM, rubs, seed=k, **own)], channels, STEP_S)
        for k in range(2)
    )
    for part in (fit, select):
        part.calibrate()
    return Judge(fit, select, LEAN)


def difference(one):
    """Energy [nats] of the nominal sim by its own steps' error and by the one kept."""
    return one.energies([()])[0] - one.energies([()], exactly=True)[0]


def test_the_error_of_steps_is_that_beside_small_mismatch():
    """What was measured without the friction that was fitted since is no longer right.

    Models with the one error and models with the other would not be comparable.
    """
    one = judge(0.05)
    one.calibrate(())
    assert one.fit.nuisance.sizes.any()
    assert difference(one) == pytest.approx(0.0, abs=0.01)
    one.select.correct(())
    known = one.fit.nuisance
    one.select.doubt_beside(known.at(4 * known.sizes), ())
    assert abs(difference(one)) > 1
