"""The search for effects at all joints, and its parts."""

from types import SimpleNamespace

import numpy as np
import pytest
from known_arms import CHANNELS, SINGLE, measured
from made_up_traces import arm as position_arm
from torque_arm import arm, moved, rubbing

from diagnosis.conclude.answer import gap, probability
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.torques.torque_evidence import with_motions
from diagnosis.residuals.torques.torque_predictor import predictor_of
from diagnosis.search.few_or_many import more_is_missing
from diagnosis.search.fitting import fit_all, ran_into_bound
from diagnosis.search.judging import Judge
from diagnosis.search.many.everywhere import _beside_small_mismatch, everywhere
from diagnosis.search.many.losses import Losses
from diagnosis.search.result import SearchResult
from diagnosis.search.search import Search

MODEL = (
    PlacedEffect("coulomb_friction", "yaw", (0.5,)),
    PlacedEffect("viscous_friction", "shoulder", (1.0,)),
    PlacedEffect("payload_mass", "lower", (0.1,)),
)


@pytest.fixture(scope="module")
def predictor():
    rubs = rubbing((1.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    found = predictor_of(arm(), with_motions(arm(), [moved(rubs)]))
    found.calibrate()
    return found


@pytest.fixture(scope="module")
def fitted(predictor):
    return fit_all(predictor, [MODEL])[0]


def test_gains_are_what_removal_and_another_fit_cost(predictor, fitted):
    gains = [gain for _, gain in Losses(fitted).without_each()]
    for i in range(2):
        rest = tuple(one for k, one in enumerate(fitted.model) if k != i)
        lost = fit_all(predictor, [rest])[0].energy - fitted.energy
        assert gains[i] == pytest.approx(lost, rel=0.2)
    # there is no payload
    assert gains[2] < 0.02 * min(gains[:2])


def test_what_shares_a_value_is_removed_together(predictor):
    shared = tuple(
        PlacedEffect("viscous_friction", joint, (1.0,), tied="shoulder")
        for joint in ("shoulder", "elbow")
    )
    fit = fit_all(predictor, [(MODEL[0], *shared)])[0]
    (first, _), (second, gain) = Losses(fit).without_each()
    assert [one.place for one in first] == ["yaw"]
    assert [one.place for one in second] == ["shoulder", "elbow"]
    lost = fit_all(predictor, [MODEL[:1]])[0].energy - fit.energy
    assert gain == pytest.approx(lost, rel=0.2)


def test_more_is_missing_until_friction_is_known(predictor, fitted):
    nothing = SearchResult(1.0, 1.0, {}, 0)
    assert more_is_missing(predictor, nothing)
    known = predictor_of(arm(), with_motions(arm(), [moved()]))
    assert not more_is_missing(known, nothing)


def test_values_on_bounds_are_noticed(predictor, fitted):
    assert not any(ran_into_bound(fitted, one) for one in fitted.model[:2])
    far = (*fitted.model[:2], PlacedEffect("com_offset", "lower", (0.1, 0.0, 0.0)))
    stuck = fit_all(predictor, [far], 1)[0]
    stuck = type(stuck)(far, stuck.residual, stuck.jacobian, stuck.coordinates)
    assert ran_into_bound(stuck, far[2])
    assert not ran_into_bound(stuck, far[0])


def searched(**truth):
    """A search for a single effect, and what it came to."""
    fit, select = (
        Predictor(position_arm(), [measured(seed, **truth)], CHANNELS)
        for seed in (1, 2)
    )
    fit.calibrate()
    select.calibrate()
    judge = Judge(fit, select, SINGLE)
    return judge, Search(judge).run()


def gains(wide):
    return {
        placed.key: placed
        for placed in wide.winner.model
        if placed.name == "servo_gain"
    }


@pytest.mark.slow
def test_what_joints_share_is_one_value():
    judge, found = searched(gain=(0.85, 0.85), duration_s=2.5)
    wide = everywhere(judge, found)
    both = gains(wide)
    assert set(both) == {"servo_gain@shoulder", "servo_gain@elbow"}
    (values,) = {one.values for one in both.values()}
    assert values == (pytest.approx(0.85, abs=0.01),)
    assert {one.tied for one in both.values()} == {"elbow"}
    assert wide.winner.fit.jacobian.shape[1] == 1


@pytest.mark.slow
def test_what_both_joints_lack_differently_is_untied():
    judge, found = searched(gain=(0.7, 0.5), duration_s=2.5)
    wide = everywhere(judge, found)
    values = {key: placed.values[0] for key, placed in gains(wide).items()}
    assert values == {
        "servo_gain@shoulder": pytest.approx(0.7, abs=0.01),
        "servo_gain@elbow": pytest.approx(0.5, abs=0.01),
    }
    assert len(wide.winner.model) == 2
    assert wide.closed(wide.winner) > 0.99 > found.closed(found.winner)
    # what the model would be without each of them says how sure each is
    assert {judged.keys for judged in wide.best[1]} == {
        frozenset({key}) for key in values
    }
    assert all(0.9 < probability(gap(wide, one)) < 1 for one in wide.winner.model)


@pytest.mark.slow
def test_a_single_effect_is_not_spread():
    judge, found = searched(gain=(0.8, 1.0), duration_s=2.5)
    assert everywhere(judge, found) is found


@pytest.mark.slow
def test_nothing_is_found_where_nothing_is_missing():
    judge, found = searched(duration_s=2.5)
    assert everywhere(judge, found) is found
    assert not np.any(found.chosen)


def test_few_count_beside_small_mismatch_only_where_it_explains_what_is_left():
    """Elsewhere whitening takes out what no small mismatch could explain."""
    few = SimpleNamespace(winner=SimpleNamespace(energy=7.0))
    sizes = np.zeros(2), np.array([0.0, 1.5])
    left = []
    for one in sizes:
        judge = SimpleNamespace(
            fit=SimpleNamespace(nuisance=SimpleNamespace(sizes=one)),
            again=lambda judged: judged,
        )
        left.append(_beside_small_mismatch(judge, few))
    assert left == [np.inf, 7.0]
    # beside no effect small mismatch may stand for the one that is missing
    assert _beside_small_mismatch(judge, SimpleNamespace(winner=None)) == np.inf
