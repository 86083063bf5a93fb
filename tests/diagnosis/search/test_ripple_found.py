"""Torque ripple of the hidden world: seen before it is simulated, and found."""

from dataclasses import replace

import numpy as np
import pytest
from hidden_arm import errors, fitted, floor, plant, predictor_of, recorded
from joint_rigs import SLED, plant_of, ticks, trace_of
from known_arms import SINGLE

from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.effects.variants import Variants
from diagnosis.pipeline import diagnose
from diagnosis.residuals.torques.ripples import ripples, usage_of
from diagnosis.traces.motion import Motion

SIZES = [(0.05, 30, 1.0), (0.2, 60, -2.0), (0.4, 12, 3.0)]


def truth(torque, per_turn, phase):
    return f"cogging@J2:torque={torque},per_turn={per_turn},phase={phase}"


@pytest.mark.parametrize("values", SIZES)
def test_it_is_seen_and_found(values):
    trace = recorded(truth(*values))
    predictor = predictor_of(trace)
    noise, spread = floor(predictor)
    usage = usage_of(predictor)
    first, *_ = effect("cogging").first_tries(plant(), "J2", usage)
    size, per_turn, _ = first
    assert size == pytest.approx(values[0], rel=0.3)
    assert abs(per_turn - values[1]) < np.pi / np.ptp(trace.position_rad[:, 1])
    fit = fitted(predictor, ("cogging", "J2", *first))
    assert fit.energy < noise + 3 * spread
    at = fit.coordinates.of(fit.model)
    right = fit.coordinates.of((PlacedEffect("cogging", "J2", values),))
    turns = 2 * np.pi * np.round((at[2] - right[2]) / (2 * np.pi))
    assert (np.abs(at - right - [0, 0, turns]) < 5 * errors(fit)).all()
    for others in (
        [("joint_spring", "J2", 2.0, 0.0), ("torque_offset", "J2", 0.1)],
        [("coulomb_friction", "J2", 0.1), ("viscous_friction", "J2", 0.1)],
    ):
        assert fitted(predictor, *others).energy > noise + 500


@pytest.mark.parametrize(
    ("name", "text", "start"),
    [
        ("joint_spring", "joint_spring@J2:stiffness=2,rest=0.3", (1.0, 0.0)),
        ("coulomb_friction", "coulomb_friction@J2:torque=0.3", (0.2,)),
    ],
)
def test_its_neighbours_are_not_mistaken_for_it(name, text, start):
    predictor = predictor_of(recorded(text))
    noise, spread = floor(predictor)
    own = fitted(predictor, (name, "J2", *start))
    assert own.energy < noise + 3 * spread
    tries = effect("cogging").first_tries(plant(), "J2", usage_of(predictor))
    assert len(tries) == 2
    for one in tries:
        assert fitted(predictor, ("cogging", "J2", *one)).energy > own.energy + 20


def test_what_is_seen_without_a_ripple_is_as_small_as_noise():
    """Half a milliradian of a servo with 40 N m/rad, and the share of one wave."""
    seen = ripples(plant(), [recorded()])
    rough = ripples(plant(), [recorded(truth(*SIZES[0]))])
    assert seen["J2"][0][0] < 0.2 * rough["J2"][0][0]


def test_a_joint_that_turns_by_less_than_a_wave_has_none_of_it():
    """A twentieth of the motion leaves only waves that are much shorter."""
    trace = recorded(truth(0.4, 12, 0.0))
    small = replace(
        trace, position_rad=trace.position_rad / 20, command_rad=trace.command_rad / 20
    )
    least = 2 * np.pi / np.ptp(small.position_rad[:, 1])
    assert least > 100
    assert all(one[1] >= least for one in ripples(plant(), [small])["J2"])
    still = replace(small, position_rad=0 * small.position_rad)
    assert ripples(plant(), [still])["J2"] == ()


def test_measured_torques_show_it_too():
    """By the motion itself: torque = needed - A sin(n q + phase)."""
    size, per_turn, phase = 0.3, 20.0, 0.7
    arm = plant()
    time_s = ticks(6.0)
    turns = np.stack([0.5 * np.sin(2 * time_s), 0.6 * np.sin(3 * time_s)], 1)
    rates = np.stack([1.0 * np.cos(2 * time_s), 1.8 * np.cos(3 * time_s)], 1)
    faster = turns * [-4.0, -9.0]
    motion = Motion(turns, rates, faster, turns == turns, 1, np.ones(2), np.ones(2))
    from diagnosis.plant.plant import inverse_dynamics

    torque = inverse_dynamics(arm, arm.model, turns, rates, faster)
    torque[:, 1] -= size * np.sin(per_turn * turns[:, 1] + phase)
    trace = replace(trace_of(arm, time_s, turns, torque_nm=torque), motion=motion)
    (first, *_) = ripples(arm, [trace])["J2"]
    assert first[0] == pytest.approx(size, rel=0.1)
    assert first[1] == pytest.approx(per_turn, abs=np.pi / 1.2 / 4)


def test_ripples_at_one_joint_add_up():
    """Sin and cos of as many waves: 3 sin x + 4 cos x = 5 sin(x + atan(4 / 3))."""
    variants = Variants(plant(), 1)
    for values in ((3.0, 20.0, 0.0), (4.0, 20.0, np.pi / 2)):
        effect("cogging").apply(variants, 0, "J1", np.array(values))
    noted = variants.torques[effect("cogging")][0, 0]
    assert noted == pytest.approx([5.0, 20.0, np.arctan2(4, 3)])


def test_only_what_turns_ripples():
    assert effect("cogging").places(plant(), []) == ("J1", "J2")
    assert effect("cogging").places(plant_of(SLED), []) == ()


@pytest.mark.slow
def test_a_whole_diagnosis_names_it():
    traces = [
        recorded(truth(0.2, 25, 1.0), seed=seed, duration_s=3.0) for seed in range(3)
    ]
    verdict = diagnose(plant(), traces, np.random.SeedSequence(0), SINGLE).verdict
    assert verdict.kind == "effects"
    (found,) = verdict.effects
    assert (found.name, found.place) == ("cogging", "J2")
    for name, true in (("torque", 0.2), ("per_turn", 25.0)):
        assert found.parameters[name].value == pytest.approx(true, rel=0.02)
