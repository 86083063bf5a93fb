"""What is found is not yet established: guards on made-up errors, and on real fits."""

from dataclasses import replace
from functools import cache

import pytest
from known_arms import CHANNELS, NOISE_RAD
from made_up_traces import arm, recorded

from diagnosis.conclude.guards import established, is_worse, objections
from diagnosis.conclude.held_out_errors import Judgement
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Predictor
from diagnosis.verdict import ChannelFit, Fit

GOOD = Fit(
    nominal=10.0,
    corrected=1.5,
    floor=1.0,
    ceiling=3.0,
    wrong_place=9.0,
    wrong_effect=11.0,
    channels={},
)


def said(timed=False, worse=None, changed=None, follows=None, own=(), **changes):
    errors = replace(GOOD, **changes)
    judged = Judgement(
        errors, worse or {}, changed=changed or {}, follows=follows or {}, own=own
    )
    return " ".join(objections(judged, timed))


def test_a_good_answer_meets_no_objection():
    assert said() == ""
    assert said(ceiling=None, wrong_place=None, wrong_effect=None) == ""


def test_what_predicts_no_better_is_not_established():
    assert "do not predict" in said(corrected=10.0)
    assert "do not predict" in said(corrected=12.0)


def test_what_is_measured_must_not_get_worse_either():
    """Beside wrong starts and small mismatch an answer may look better than it is."""
    assert is_worse(replace(GOOD, nominal=2.3, corrected=4.1), 0.5)
    assert not is_worse(GOOD, 0.5)
    # hardly more than noise: 1.2 squared is 0.44 more than 1, 1.3 squared is 0.69
    assert not is_worse(replace(GOOD, nominal=1.0, corrected=1.2), 0.5)
    assert is_worse(replace(GOOD, nominal=1.0, corrected=1.3), 0.5)


def test_the_error_must_fall_to_a_third():
    """Squares count: of 100, 1 is noise; 3.5 leaves 11.25 of 99, 3.4 leaves 10.6."""
    alone = {"wrong_place": None, "wrong_effect": None}
    assert "something else" in said(corrected=3.5, **alone)
    assert said(corrected=3.4, **alone) == ""
    # what is left is hardly more than noise
    assert said(nominal=1.6, corrected=1.2, ceiling=None, **alone) == ""


@pytest.mark.parametrize("ceiling", [None, 3.4, 7.0])
def test_a_regression_that_explains_less_is_no_excuse(ceiling):
    """Whoever finds little more than a curve fit does may have found no physics."""
    alone = {"wrong_place": None, "wrong_effect": None}
    assert "something else" in said(corrected=3.5, ceiling=ceiling, **alone)


def test_where_hardly_more_than_noise_is_left_a_regression_says_what_is_possible():
    """The noise itself is not known to some percent of its square."""
    near = {"nominal": 1.2, "wrong_place": None, "wrong_effect": None}
    assert said(corrected=1.17, ceiling=None, **near) == ""
    assert said(corrected=1.17, ceiling=1.3, **near) == ""
    assert "less than half" in said(corrected=1.17, ceiling=1.1, **near)
    assert said(corrected=1.13, ceiling=1.1, **near) == ""


@pytest.mark.parametrize(
    ("control", "words"),
    [("wrong_place", "at another place"), ("wrong_effect", "another effect")],
)
def test_a_wrong_answer_must_not_do_about_as_well(control, words):
    """Of 98 explained 1.25 are left; a wrong answer leaves 1.6 at 1.6, 8 at 3.0."""
    assert words in said(**{control: 1.6})
    assert said(**{control: 3.0}) == ""
    # unless it surely leaves more
    assert words in said(worse={control: 2.0}, **{control: 1.6})
    assert said(worse={control: 2.5}, **{control: 1.6}) == ""


@pytest.mark.parametrize("control", ["wrong_place", "wrong_effect"])
def test_what_must_do_as_well_if_the_effect_is_real_says_nothing_against_it(control):
    """A mass one link further explains most of what a mass here explains."""
    assert said(follows={control: 0.51}, **{control: 1.6}) == ""
    assert "about as much" in said(follows={control: 0.49}, **{control: 1.6})


def test_of_several_effects_the_main_one_is_compared():
    """Others explain all but 8 of 99; of these a wrong answer explains 5, or none."""
    assert "another effect" in said(without=3.0, wrong_effect=1.7)
    assert said(without=3.0, wrong_effect=2.9) == ""


def test_an_effect_at_one_of_many_joints_is_judged_by_its_own():
    """Only one of 20 channels is off, so that hardly anything is over all of them."""
    quiet = ChannelFit(
        nominal=2.0, corrected=2.0, floor=2.0, wrong_effect=2.0, unit="rad"
    )
    loud = ChannelFit(
        nominal=6.0, corrected=2.2, floor=2.0, wrong_effect=5.8, unit="rad"
    )
    channels = {f"position.{k}": quiet for k in range(19)} | {"position.own": loud}
    diluted = {"nominal": 1.18, "corrected": 1.01, "wrong_effect": 1.17}
    assert said(wrong_place=None, ceiling=None, channels=channels, **diluted) == ""
    as_good = channels | {"position.own": replace(loud, wrong_effect=2.3)}
    assert "another effect" in said(wrong_place=None, channels=as_good, **diluted)


def test_effects_must_explain_half_at_each_joint_where_they_are():
    """At the elbow 9.75 of 99 go, or 51; of all joints' squares most go in any case."""
    alone = {"wrong_place": None, "wrong_effect": None, "ceiling": None}
    shoulder = ChannelFit(nominal=30.0, corrected=1.0, floor=1.0, unit="rad")
    elbow = ChannelFit(nominal=10.0, corrected=9.5, floor=1.0, unit="rad")
    own = "position.shoulder", "position.elbow"

    def told(own, **changes):
        channels = {
            "position.shoulder": shoulder,
            "position.elbow": replace(elbow, **changes),
        }
        return said(channels=channels, own=own, **alone)

    assert "take away 10% of the squared error above the noise at elbow" in told(own)
    assert told(own[:1]) == ""  # nothing is named at the elbow
    assert told(own, corrected=7.0) == ""
    assert "away 0%" in told(own, nominal=9.0)  # it got worse
    assert "away 0%" in told(own, nominal=0.9, corrected=1.5)
    assert told(own, nominal=1.2, corrected=1.2) == ""  # hardly more than noise


@pytest.mark.parametrize("factor", [0.5, 1.0, 2.0])
def test_an_effect_below_the_noise_is_judged_where_it_shows(factor):
    """Nothing is off by more than noise; regression explains a little everywhere."""
    errors = {"floor": 1.0, "unit": "rad"}
    quiet = ChannelFit(
        nominal=0.7, corrected=0.7, ceiling=0.6, wrong_place=0.69, **errors
    )
    own = ChannelFit(
        nominal=0.7, corrected=0.5, ceiling=0.6, wrong_place=0.69, **errors
    )
    channels = {f"position.{k}": quiet for k in range(19)} | {"position.own": own}
    changed = {name: 0.1 * factor for name in channels} | {"position.own": 0.5}
    diluted = {"nominal": 0.7, "corrected": 0.691, "ceiling": 0.6, "wrong_place": 0.69}
    options = {"wrong_effect": None, "channels": channels, **diluted}
    assert "less than half" in said(**options)
    assert said(changed=changed, **options) == ""
    as_good = channels | {"position.own": replace(own, wrong_place=0.52)}
    options["channels"] = as_good
    assert "at another place" in said(changed=changed, **options)


def test_what_acted_for_a_while_need_not_be_in_the_held_out_data():
    assert said(timed=True, nominal=1.0, corrected=1.0) == ""
    assert "do not predict" in said(timed=True, nominal=1.0, corrected=3.0)


@cache
def predictor(*effects):
    traces = [
        recorded(arm(), *effects, duration_s=2.0, seed=seed, noise_rad=NOISE_RAD)
        for seed in range(2)
    ]
    some = Predictor(arm(), traces, CHANNELS)
    some.calibrate(tuple(PlacedEffect(n, p, tuple(v)) for n, p, *v in effects))
    return some


GAIN = "servo_gain", "elbow", 0.7


def test_an_effect_that_may_be_nothing_is_taken_out():
    both = predictor(GAIN)
    nothing = PlacedEffect("viscous_friction", "shoulder", (0.001,))
    fitted, told = established(both, (PlacedEffect(*GAIN[:2], (0.75,)), nothing))
    (kept,) = fitted.model
    assert kept.key == "servo_gain@elbow"
    assert kept.values[0] == pytest.approx(0.7, rel=0.03)
    assert told == ()


def test_where_nothing_is_left_nothing_is():
    nothing = PlacedEffect("viscous_friction", "shoulder", (0.001,))
    assert established(predictor(), (nothing,)) == (None, ())
    assert established(predictor(), ()) == (None, ())


def test_a_value_that_runs_into_its_bound_is_not_stated():
    """Commands are 0.9 s late, and the library allows for 0.6 s."""
    both = predictor(("command_latency", "commands", 0.9))
    late = PlacedEffect("command_latency", "commands", (0.5,))
    fitted, told = established(both, (late,))
    assert fitted is None
    assert "end of its possible range" in told[0]


@pytest.mark.parametrize("kept", [True, False])
def test_a_limit_that_may_as_well_be_none_is_nothing(kept):
    """No finite speed stands for no limit: one that is never reached does."""
    trace = recorded(arm(), *([("speed_limit", "elbow", 0.8)] if kept else []))
    both = Predictor(arm(), [trace], CHANNELS)
    model = (PlacedEffect("speed_limit", "elbow", (0.8 if kept else 12.0,)),)
    both.calibrate(model, tolerances=False)
    found, said = established(both, model)
    assert (found is not None) == kept
    assert not said


@pytest.mark.parametrize("off", [True, False])
def test_a_motor_that_was_off_for_perhaps_no_time_is_nothing(off):
    """An elbow that jumps out of place, and back in three rows, is no motor off."""
    trace = recorded(arm(), *([("servo_off", "elbow", 1.0, 1.5, 0.3)] if off else []))
    if not off:
        jumped = trace.position_rad.copy()
        jumped[40:43, 1] -= 0.02, 0.013, 0.006
        trace = replace(trace, position_rad=jumped)
    both = Predictor(arm(), [trace], CHANNELS)
    values = (1.0, 1.5, 0.3) if off else (0.9, 0.77, 0.06)
    model = (PlacedEffect("servo_off", "elbow", values),)
    both.calibrate(model, tolerances=False)
    found, said = established(both, model)
    assert (found is not None) == off
    assert not said


@pytest.mark.parametrize("sticks", [True, False])
def test_friction_is_stated_in_its_simplest_form(sticks):
    """More friction near standstill is stated only where it shows."""
    form = "stribeck_friction" if sticks else "coulomb_friction"
    values = (1.0, 0.8, 0.1) if sticks else (1.0,)
    both = predictor((form, "elbow", *values))
    fitted, told = established(
        both, (PlacedEffect("stribeck_friction", "elbow", (1.0, 0.1, 0.05)),)
    )
    (kept,) = fitted.model
    assert kept.name == form
    assert kept.values[0] == pytest.approx(1.0, rel=0.05)
    assert told == ()
