"""How models are judged on data that they were not fitted to."""

import numpy as np
import pytest
from known_arms import CHANNELS, LEAN
from made_up_search import judged
from made_up_traces import arm, recorded

from diagnosis.effects.library import effect
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.judging import Judge, gain_of_noise, places_of_effects, price
from diagnosis.search.result import VALUE_NATS, SearchResult, ranked

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


@pytest.mark.parametrize("correlated", [1.0, 5.0, 10.0])
def test_where_errors_last_more_values_must_gain_more(correlated):
    """Inertia has one value, a push three and a time, but 30 nats more of energy."""
    push = judged(ARM, 100.0, "external_force@upper")
    inertia = judged(ARM, 130.0, "armature@elbow")
    best = ranked([push, inertia], 100.0, correlated)
    dearer = VALUE_NATS * 4 + effect("external_force").rarity_nats
    wins = 30 / correlated > dearer
    assert best[0] is (push if wins else inertia)
    found = SearchResult(400.0, 100.0, {1: best}, 1, correlated=correlated)
    assert found.worse(best[1]) == pytest.approx(abs(30 / correlated - dearer))
    assert wins == (correlated == 1.0)


def test_chance_says_how_many_nats_count_as_one():
    one = judge(0.05)
    independent = gain_of_noise(places_of_effects(one.fit))
    models = [judged(ARM, 50.0, "armature@elbow")]
    models += [judged(ARM, 20.0, "external_force@upper")]
    rows = sum(trace.ticks for trace in one.fit.traces)
    dearer = price(models[1].model, rows) - price(models[0].model, rows)
    for factor, least in ((1.0, 0.5 * independent), (3.0, 3 * independent)):
        one.least_gain = least
        assert one.correlated == pytest.approx(factor)
        enough = least + factor * dearer < 30
        assert one.worth(*models) == enough
        assert enough == (factor == 1.0)
