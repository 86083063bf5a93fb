"""Searches on recordings whose truth is known, and the sizes they can see."""

from copy import copy
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from known_arms import CHANNELS, LEAN, NOISE_RAD, measured
from made_up_search import judged
from made_up_traces import arm, recorded

from diagnosis.conclude.smallest_sizes import smallest_detectable
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.small_mismatch.usual_errors import is_usual
from diagnosis.search.accept import accepted
from diagnosis.search.judging import Judge
from diagnosis.search.result import SearchResult, ranked
from diagnosis.search.search import Search
from diagnosis.traces.usage import Usage

PLANT = arm()


def search_of(*traces, rules=LEAN):
    """The first is fitted, the second selects."""
    predictors = [Predictor(PLANT, [trace], CHANNELS, step_s=0.004) for trace in traces]
    for predictor in predictors:
        predictor.calibrate()
    return Search(Judge(*predictors, rules))


@cache
def searched(*effects, rules=LEAN):
    traces = [
        recorded(PLANT, *effects, duration_s=2.0, seed=seed, noise_rad=NOISE_RAD)
        for seed in range(2)
    ]
    search = search_of(*traces, rules=rules)
    return search, search.run(anyway=True)


@pytest.mark.slow
@pytest.mark.parametrize(
    "truth",
    [
        ("coulomb_friction", "shoulder", 0.4),
        ("payload_mass", "lower", 0.2),
        ("payload_mass", "lower", -0.2),
        ("command_latency", "commands", 0.007),
    ],
)
def test_one_effect_is_found_with_its_value(truth):
    name, place, value = truth
    search, found = searched(truth)
    found = accepted(search.judge, found)  # a search may take one too many
    assert found.chosen == 1
    (placed,) = found.winner.model
    assert placed.key == f"{name}@{place}"
    # as exactly as tolerances of 1 % allow; the final fit is closer
    assert placed.values[0] == pytest.approx(value, rel=0.15)
    assert found.closed(found.winner) > 0.95
    assert found.winner.selected == pytest.approx(found.floor, rel=0.4)


@pytest.mark.slow
def test_two_effects_that_hide_each_other_are_found_together():
    """A servo that is stiffer, and a forearm that is heavier: they sag as before."""
    truth = ("servo_gain", "elbow", 1.6), ("payload_mass", "lower", 0.24)
    _, found = searched(*truth)
    assert found.chosen == 2
    assert found.winner.keys == {"servo_gain@elbow", "payload_mass@lower"}
    values = {placed.name: placed.values[0] for placed in found.winner.model}
    assert values["servo_gain"] == pytest.approx(1.6, rel=0.1)
    assert values["payload_mass"] == pytest.approx(0.24, rel=0.15)


@pytest.mark.slow
def test_a_servo_that_is_much_too_weak():
    """It drops its arm: it can do far less than the motion should have taken."""
    search, _ = searched()
    least_nm = 0.6 * float(Usage.of(PLANT, search.judge.fit.traces).torque_nm[0])
    _, found = searched(("torque_limit", "shoulder", least_nm))
    values = {one.key: one.values[0] for one in found.winner.model}
    assert values.pop("torque_limit@shoulder") == pytest.approx(least_nm, rel=0.02)
    rest = [one for one in found.winner.model if one.key in values]
    assert all(is_usual(PLANT, one) for one in rest)


def test_a_single_effect_is_fitted_to_the_end():
    """A Jacobian that is only followed ends at a third of this spring's stiffness."""
    spring = ("joint_spring", "shoulder", 15.0, 0.5)
    traces = [
        recorded(PLANT, spring, duration_s=2.0, seed=seed, noise_rad=NOISE_RAD)
        for seed in range(2)
    ]
    guess = (PlacedEffect("joint_spring", "shoulder", (2.0, -0.3)),)
    (best,) = search_of(*traces).judge.judged([guess])
    assert best.model[0].values == pytest.approx((15.0, 0.5), rel=0.1)


def test_an_effect_moves_to_its_body_before_more_are_added():
    """Beside it at the wrong body small mismatch would not lead to the noise."""
    truth = ("drag", "lower", 3.0)
    traces = [recorded(PLANT, truth, duration_s=2.0, seed=seed) for seed in range(2)]
    search = search_of(*traces)
    wrong = search.judge.judged([(PlacedEffect("drag", "upper", (3.0,)),)])
    (best, *_) = search._refined(wrong)
    assert best.keys == {"drag@lower"}
    assert best.model[0].values[0] == pytest.approx(3.0, rel=0.05)


@pytest.mark.slow
def test_two_effects_are_found_together():
    truth = ("servo_gain", "elbow", 0.7), ("coulomb_friction", "shoulder", 0.4)
    _, found = searched(*truth)
    assert found.chosen == 2
    values = {placed.key: placed.values[0] for placed in found.winner.model}
    assert set(values) == {"servo_gain@elbow", "coulomb_friction@shoulder"}
    assert values["servo_gain@elbow"] == pytest.approx(0.7, rel=0.02)
    assert values["coulomb_friction@shoulder"] == pytest.approx(0.4, rel=0.1)
    assert found.best[2][0].selected < found.best[1][0].selected - 20


@pytest.mark.slow
def test_a_push_that_another_effect_outshouts():
    """It stands out only from what the weak servo leaves."""
    push = ("external_force", "lower", 0.0, 3.0, 3.0, 1.5, 0.2)
    _, found = searched(("servo_gain", "elbow", 0.6), push)
    assert found.chosen == 2
    assert found.winner.keys == {"servo_gain@elbow", "external_force@lower"}
    values = {placed.name: placed.values for placed in found.winner.model}
    assert values["servo_gain"][0] == pytest.approx(0.6, rel=0.05)
    assert values["external_force"][3:] == pytest.approx((1.5, 0.2), abs=0.05)


def test_where_nothing_is_nothing_is_found():
    _, found = searched()
    assert found.chosen == 0
    assert found.winner is None
    assert found.nothing == pytest.approx(found.floor, rel=0.4)
    assert found.best[1]  # it did look


def model_of(judge, fitted, selected, key="armature@elbow"):
    """A model that gains so much on fitting and on selection data."""
    one = judged(PLANT, judge.nothing - selected, key)
    left = np.sqrt([2 * max(judge.nothing_fit - fitted, 0.0)])
    return replace(one, fit=replace(one.fit, residual=left))


@pytest.mark.parametrize(
    ("fitted", "selected", "believed"),
    [
        (0.5, 0.6, False),  # among many models some fit well by chance
        (0.5, 3.0, True),  # not on data that they do not know
        (-0.5, 1.0, False),
        (2.0, 1.0, True),
        (2.0, 0.0, True),  # a stop need not be met in both
        (2.0, -1.0, False),
    ],
)
def test_what_was_fitted_must_show_it_and_the_rest_not_contradict(
    fitted, selected, believed
):
    judge = searched()[0].judge
    least = judge.least_gain
    assert judge.believes(model_of(judge, fitted * least, selected * least)) is believed


def test_with_a_floating_base_both_kinds_of_data_must_show_it():
    judge = copy(searched()[0].judge)
    least = judge.least_gain
    one = model_of(judge, 2 * least, 0.9 * least)
    assert judge.believes(one)
    floating = SimpleNamespace(base="floating")
    judge.fit = SimpleNamespace(plant=floating, traces=judge.fit.traces)
    assert not judge.believes(one)


def test_more_values_and_free_times_must_gain_more():
    judge = searched()[0].judge
    gain = 1.5 * judge.least_gain
    assert judge.believes(model_of(judge, gain, gain))
    push = "external_force@lower"
    assert not judge.believes(model_of(judge, gain, gain, push))
    assert judge.believes(model_of(judge, gain + 30, gain, push))


def test_a_user_can_ask_for_a_share_of_the_error():
    judge = searched()[0].judge
    asking = Judge(judge.fit, judge.select, replace(LEAN, least_share=0.5))
    asking.nothing = asking.floor + 1000.0
    asking.nothing_fit = asking.floor_fit + 1000.0
    assert not asking.believes(model_of(asking, 400.0, 400.0))
    assert asking.believes(model_of(asking, 600.0, 600.0))


@pytest.mark.slow
def test_what_no_effect_makes_is_not_explained():
    """A torque that hums with time, five times a second."""

    def humming(t, q, v):
        return np.array([0, 0.6]) * np.sin(31 * t)

    traces = [measured(seed, humming) for seed in range(2)]
    found = search_of(*traces).run()
    assert found.nothing > 20 * found.floor
    best = found.winner.selected if found.winner else found.nothing
    assert best - found.floor > 0.5 * (found.nothing - found.floor)


def test_what_acts_above_a_threshold_has_no_smallest_size():
    search, _ = searched()
    sizes = smallest_detectable(
        search.judge.fit, search.signatures, search.judge.least_gain
    )
    names = {key.split("@")[0] for key in sizes}
    assert not names & {"torque_limit", "speed_limit", "end_stop", "joint_elasticity"}
    assert {"backlash", "armature", "payload_mass", "encoder_offset"} <= names
    assert sizes["viscous_friction@elbow"].unit == "N m s/rad"
    more = smallest_detectable(
        search.judge.fit, search.signatures, 4 * search.judge.least_gain
    )
    gain = "servo_gain@elbow"  # a smaller one is usual
    usual = 1 - np.exp(-3 * 0.03)
    assert sizes[gain].value == pytest.approx(usual)
    assert usual <= more[gain].value < 0.18
    for key in ("viscous_friction@elbow", "backlash@elbow"):
        assert more[key].value == pytest.approx(2 * sizes[key].value)


def test_shares_of_what_is_above_the_noise():
    best = judged(PLANT, 200.0, "armature@elbow")
    found = SearchResult(1100.0, 100.0, {1: [best]}, 1)
    assert found.closed(best) == pytest.approx(0.9)
    assert found.closed(judged(PLANT, 90.0, "armature@elbow")) == 1.0
    assert found.winner is best
    assert SearchResult(90.0, 100.0, {1: [best]}, 0).closed(best) == 0.0
    # an effect that hardly shows in the selection data, and much in the others
    both = SearchResult(250.0, 100.0, {1: [best]}, 1, nothing_fit=1e4, floor_fit=0.0)
    assert best.fit.energy == 0
    assert both.closed(best) == pytest.approx((50 + 1e4) / (150 + 1e4))
    here = SearchResult(1100.0, 100.0, {1: [best]}, 1, nothing_fit=1.0, floor_fit=0.0)
    assert here.closed(best) == pytest.approx(901 / 1001)
    assert SearchResult(90.0, 100.0, {1: [best]}, 0).winner is None


def test_rare_effects_and_more_values_must_fit_better():
    one = judged(PLANT, 100.0, "armature@elbow")
    three = judged(PLANT, 100.0, "stribeck_friction@elbow")
    both = judged(PLANT, 100.0, "armature@elbow", "servo_gain@elbow")
    better = judged(PLANT, 90.0, "stribeck_friction@elbow")
    assert ranked([three, one, both], 100.0) == [one, both, three]
    assert ranked([three, one, both, better], 100.0)[0] is better


def test_residuals_that_are_no_noise_tell_less():
    """Of 900 and 906 nats where noise leaves 100 a ninth counts."""
    one = judged(PLANT, 906.0, "armature@elbow")
    both = judged(PLANT, 900.0, "armature@elbow", "servo_gain@elbow")
    assert ranked([one, both], 900.0)[0] is both
    assert ranked([one, both], 100.0)[0] is one


@pytest.mark.parametrize(("weight", "first"), [(0.0, "lucky"), (1.0, "right")])
def test_what_was_fitted_is_evidence_of_names_too(weight, first):
    """Of models with as many values none fits more by chance than another."""

    def leaving(fitted, selected, key):
        one = judged(PLANT, selected, key)
        fit = replace(one.fit, residual=np.sqrt([2 * fitted]))
        return replace(one, fit=fit, weight=weight)

    models = {
        "lucky": leaving(250.0, 97.0, "armature@elbow"),
        "right": leaving(200.0, 100.0, "servo_gain@elbow"),
    }
    best = ranked([*models.values()], 300.0)
    assert best[0] is models[first]
    found = SearchResult(400.0, 100.0, {1: best}, 1, nothing_fit=800.0, floor_fit=200.0)
    gap = {0.0: 3.0, 1.0: 47.0}[weight]
    assert found.worse(best[1]) == pytest.approx(gap)


def test_on_a_floating_base_only_the_selection_data_are():
    search = searched()[0].judge
    fit = judged(PLANT, 0.0, "armature@elbow").fit
    (fixed,) = search.judge([fit])
    assert fixed.weight == 1.0
    free = copy(search.fit)
    free.plant = replace(PLANT, base="floating")
    (floating,) = Judge(free, search.select, LEAN).judge([fit])
    assert floating.weight == 0.0
    assert floating.evidence == floating.selected


@pytest.mark.slow
def test_little_in_the_selection_data_is_enough_if_much_is_fitted():
    """A joint need not move as much in a part that is short."""
    truth = ("viscous_friction", "elbow", 0.5)
    traces = [
        recorded(PLANT, truth, duration_s=seconds, seed=4, noise_rad=NOISE_RAD)
        for seconds in (4.0, 1.0)
    ]
    found = search_of(*traces).run()
    close = [one.keys for one in found.best[1] if found.worse(one) < 3.0]
    assert found.chosen == 1
    assert close[0] & {"viscous_friction@elbow", "servo_damping@elbow"}


@pytest.mark.slow
@pytest.mark.parametrize(("left", "chosen"), [(50.0, 3), (1.1, 1)])
def test_where_much_is_left_two_more_are_tried_together(monkeypatch, left, chosen):
    """Backlash without the friction that damps it explains little alone."""
    judge = searched()[0].judge
    judge = Judge(judge.fit, judge.select, replace(LEAN, largest=3))
    effects = ("armature@elbow", "servo_gain@elbow", "coulomb_friction@elbow")
    energies = [left * judge.floor, 0.9 * left * judge.floor, 0.5 * judge.floor]
    models = []
    for size, energy in enumerate(energies, 1):
        one = judged(PLANT, energy, *effects[:size])
        norm = np.sqrt(2 * left / size**3)
        residual = norm * judge.residual / np.linalg.norm(judge.residual)
        jacobian = np.zeros((len(residual), one.fit.jacobian.shape[1]))
        fit = replace(one.fit, residual=residual, jacobian=jacobian)
        models.append(replace(one, fit=fit))
    judge.nothing = 100 * energies[0]

    def of_the_size(starts, jacobians=None):
        return [models[len(starts[0]) - 1]] if starts else []

    monkeypatch.setattr(judge, "judged", of_the_size)
    assert Search(judge).run().chosen == chosen
