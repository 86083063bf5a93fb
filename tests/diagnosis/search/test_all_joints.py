import pytest
from known_arms import CHANNELS, SINGLE, measured
from made_up_traces import arm

from diagnosis.conclude.answer import probability
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.all_joints import all_joints, kinds_to_add
from diagnosis.search.judging import Judge
from diagnosis.search.screening import Guess
from diagnosis.search.search import Search


def guess(effect, place, gain):
    return Guess((PlacedEffect(effect, place, (1.0,)),), gain)


GUESSES = [
    guess("viscous_friction", "a", 40.0),
    guess("servo_gain", "a", 30.0),
    guess("servo_gain", "b", 25.0),
    guess("viscous_friction", "b", 5.0),
]


def test_kinds_are_ranked_by_what_all_their_joints_explain():
    added = kinds_to_add(GUESSES, 15.0, ())
    assert [[placed.key for placed in model] for model in added] == [
        ["servo_gain@a", "servo_gain@b"],
        ["viscous_friction@a"],
    ]


def test_what_the_model_has_is_not_added_again():
    model = (PlacedEffect("servo_gain", "b", (0.9,)),)
    added = kinds_to_add(GUESSES, 15.0, model)
    assert [placed.key for placed in added[0]] == ["viscous_friction@a"]
    assert [placed.key for placed in added[1]] == ["servo_gain@a"]


def test_what_gains_most_for_its_size_is_tried_too():
    joints = "abcde"
    large = [
        guess(kind, joint, 100.0)
        for kind in ("servo_gain", "coulomb_friction", "armature", "load_friction")
        for joint in joints
    ]
    late = guess("command_latency", "commands", 90.0)
    small = [guess("backlash", joint, 20.0) for joint in joints]
    added = kinds_to_add([*large, *small, late], 15.0, ())
    assert [model[0].name for model in added[4:]] == ["command_latency", "backlash"]


def searched(**truth):
    """A search for a single effect, and what it came to."""
    fit, select = (
        Predictor(arm(), [measured(seed, **truth)], CHANNELS) for seed in (1, 2)
    )
    fit.calibrate()
    select.calibrate()
    judge = Judge(fit, select, SINGLE)
    return judge, Search(judge).run()


@pytest.mark.slow
def test_what_both_joints_lack_is_found_at_both():
    judge, found = searched(gain=(0.9, 0.8), duration_s=2.5)
    wide = all_joints(judge, found)
    values = {placed.key: placed.values[0] for placed in wide.winner.model}
    assert values == {
        "servo_gain@shoulder": pytest.approx(0.9, abs=0.01),
        "servo_gain@elbow": pytest.approx(0.8, abs=0.01),
    }
    assert wide.closed(wide.winner) > 0.99 > found.closed(found.winner)
    # what the model would be without each of them says how sure each is
    assert {judged.keys for judged in wide.best[1]} == {
        frozenset({key}) for key in values
    }
    assert all(0.9 < probability(wide, one) < 1 for one in wide.winner.model)


@pytest.mark.slow
def test_a_single_effect_is_not_spread():
    judge, found = searched(gain=(0.9, 1.0), duration_s=2.5)
    assert all_joints(judge, found) is found
