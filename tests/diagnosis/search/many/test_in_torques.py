"""First models of robots that are far from theirs, found in asked torques."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from known_arms import CHANNELS, measured
from made_up_traces import arm

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.judging import Judge
from diagnosis.search.many.everywhere import best_of_all, is_far
from diagnosis.search.many.fits import Fits
from diagnosis.search.many.in_torques import (
    STRONG,
    _as_well_known,
    from_asked_torques,
    in_asked_torques,
)
from diagnosis.search.result import SearchResult
from diagnosis.search.search import Search


def fits_of(*traces):
    """Fits of recordings of the arm, the last of which selects."""
    some = [replace(trace, name=str(i)) for i, trace in enumerate(traces)]
    parts = [Predictor(arm(), one, CHANNELS) for one in (some[:-1], some[-1:])]
    for part in parts:
        part.calibrate()
    return Fits(Judge(*parts))


def found(model):
    return {one.key: one.values[0] for one in model}


@pytest.fixture(scope="module")
def rubs():
    """The arm with dry friction of 1 and 0.6 N m at its joints."""

    def friction_nm(t, q, v):
        return -np.array([1.0, 0.6]) * np.tanh(v / 0.01)

    return fits_of(*(measured(seed, friction_nm) for seed in range(3)))


@pytest.mark.slow
def test_friction_at_all_joints_is_found_before_any_replay(rubs):
    (model, *_) = in_asked_torques(rubs)
    dry = {k: value for k, value in found(model).items() if k.startswith("coulomb")}
    assert dry == {
        "coulomb_friction@shoulder": pytest.approx(1.0, rel=0.1),
        "coulomb_friction@elbow": pytest.approx(0.6, rel=0.1),
    }


@pytest.mark.slow
def test_a_first_model_is_fitted_to_the_motions(rubs):
    """Nearly the same at all angles: a first model may have the more general form."""
    model = from_asked_torques(rubs).model
    names = "coulomb_friction", "angle_friction"
    dry = {one.place: one.values for one in model if one.name in names}
    assert {joint: torque for joint, (torque, *_) in dry.items()} == {
        "shoulder": pytest.approx(1.0, rel=0.02),
        "elbow": pytest.approx(0.6, rel=0.02),
    }
    factors = [factor for _, *more in dry.values() for factor in more]
    assert factors == pytest.approx([1.0] * len(factors), abs=0.05)
    (left,) = rubs.fit.residuals([model])
    assert np.sqrt(np.mean(left**2)) < 3.0


@pytest.mark.slow
def test_stated_gains_are_doubted_for_strong_evidence():
    """Half the stiffness: no friction or mass does that."""
    both = fits_of(*(measured(seed, gain=(0.5, 0.5)) for seed in range(3)))
    declared, doubted = in_asked_torques(both)
    assert not any(one.name == "servo_gain" for one in declared)
    for model in (doubted, from_asked_torques(both).model):
        gains = {k: v for k, v in found(model).items() if k.startswith("servo_gain")}
        assert gains == {
            "servo_gain@shoulder": pytest.approx(0.5, abs=0.02),
            "servo_gain@elbow": pytest.approx(0.5, abs=0.02),
        }


class Name(str):
    """An effect of which only the name counts."""

    @property
    def name(self):
        return self


def chosen(monkeypatch, *, better_by, stuck=(), none=1e3, scaling=("doubted",)):
    """Which of two models a search ends with, by their scores.

    Effects of the names `scaling` scale a servo's torque.
    """
    scores = {"none": none, "declared": 100.0, "doubted": 100.0 - better_by}
    judged = {
        name: SimpleNamespace(model=() if name == "none" else (Name(name),), fit=None)
        for name in scores
    }

    def score(one):
        return scores[(*one.model, "none")[0]]

    ebic = SimpleNamespace(
        score=score, prefers=lambda one, other: score(one) < score(other)
    )
    fits = SimpleNamespace(
        nominal=lambda: judged["none"],
        fitted=lambda model: judged[(*model, "none")[0]],
        exact=lambda best: best,
        ebic=lambda best: ebic,
    )
    own = "diagnosis.search.many.in_torques"
    models = [("declared",), ("doubted",)]
    kinds = {one: SimpleNamespace(scales_servo=one in scaling) for one in scores}
    monkeypatch.setattr(f"{own}.effect", kinds.__getitem__)
    monkeypatch.setattr(f"{own}.in_asked_torques", lambda fits: models)
    monkeypatch.setattr(f"{own}.ran_into_bound", lambda fit, one: one in stuck)
    monkeypatch.setattr(f"{own}.shared_first", lambda fits, first: judged[first[0]])
    monkeypatch.setattr(f"{own}.pruned", lambda fits, best: best)
    best = from_asked_torques(fits)
    return best and best.model


def test_weak_evidence_against_stated_gains_does_not_count(monkeypatch):
    assert chosen(monkeypatch, better_by=0.9 * STRONG) == ("declared",)
    assert chosen(monkeypatch, better_by=1.1 * STRONG) == ("doubted",)


def test_where_both_doubt_stated_gains_any_evidence_counts(monkeypatch):
    both = "declared", "doubted"
    assert chosen(monkeypatch, better_by=0.1, scaling=both) == ("doubted",)
    assert chosen(monkeypatch, better_by=-0.1, scaling=both) == ("declared",)


def test_what_runs_into_a_bound_is_left_out_of_a_first_model(monkeypatch):
    both = "declared", "doubted"
    assert chosen(monkeypatch, better_by=-9.0, stuck=both[:1]) == ("doubted",)
    assert chosen(monkeypatch, better_by=9.0, stuck=both[1:]) == ("declared",)
    assert chosen(monkeypatch, better_by=9.0, stuck=both) is None


def test_a_first_model_must_be_better_than_none(monkeypatch):
    assert chosen(monkeypatch, better_by=9.0, none=95.0) == ("doubted",)
    assert chosen(monkeypatch, better_by=0.0, none=50.0) is None


def test_without_commands_nothing_is_asked():
    torques = [
        replace(one, command_rad=None, torque_nm=np.zeros_like(one.position_rad))
        for one in (measured(1), measured(2))
    ]
    assert in_asked_torques(fits_of(*torques)) == []


class Recording:
    """One whose torques have a noise, in rows that count or in none."""

    def __init__(self, name, noise, counts=True):
        self.name = name
        self.motion = SimpleNamespace(
            noise_nm=noise * np.ones(2), counts=np.full((5, 2), counts)
        )


def test_recordings_whose_torques_are_known_far_worse_are_left_out():
    noise = {"a": 1.0, "b": 1.2, "quick": 9.0, "c": 0.9}
    traces = [Recording(name, one) for name, one in noise.items()]
    short = Recording("short", 0.0, counts=False)
    assert set(_as_well_known([short, *traces])) == {"a", "b", "c"}
    assert _as_well_known([short]) == {}


def test_in_recordings_too_short_to_be_smoothed_nothing_is_found(monkeypatch):
    """Smoothing below 2 Hz has edges of half a second."""
    own = "diagnosis.residuals.torques.torque_evidence.cutoff_hz"
    monkeypatch.setattr(own, lambda plant, traces: 2.0)
    short = [measured(seed, gain=(0.5, 0.5), duration_s=0.8) for seed in range(2)]
    assert in_asked_torques(fits_of(*short)) == []


@pytest.mark.slow
def test_of_a_promising_model_no_first_one_is_searched_for(rubs, monkeypatch):
    monkeypatch.setattr("diagnosis.search.many.everywhere.from_asked_torques", None)
    dry = {"shoulder": 0.5, "elbow": 0.5}
    start = tuple(PlacedEffect("coulomb_friction", k, (v,)) for k, v in dry.items())
    best = best_of_all(Fits(rubs.judge, weighs=True), start)
    values = found(best.model)
    assert values["coulomb_friction@shoulder"] == pytest.approx(1.0, rel=0.02)
    assert values["coulomb_friction@elbow"] == pytest.approx(0.6, rel=0.02)


def test_a_search_knows_the_promising_model_with_many_effects(rubs):
    few = (PlacedEffect("viscous_friction", "elbow", (0.1,)),)
    many = tuple(PlacedEffect("coulomb_friction", str(k), (0.1,)) for k in range(9))
    assert Search(rubs.judge, [few]).large == ()
    assert Search(rubs.judge, [few, many]).large == many


def test_far_is_many_times_the_noise_beside_few_effects():
    judge = SimpleNamespace(floor=100.0, floor_fit=300.0)
    for times, wanted in ((4.9, False), (5.1, True)):
        energy = times**2 * 400.0
        nothing = SearchResult(0.3 * energy, 100.0, {}, 0, 0.7 * energy, 300.0)
        assert is_far(judge, nothing) is wanted
