"""Stepwise regression by the extended BIC, and references for all baselines."""

import math
from dataclasses import replace

import numpy as np
import pytest
from three_sines import swing

from diagnosis.baselines import BASELINES, bic, ebic, sparse, sysid
from diagnosis.baselines.replays import exact_replays
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import STEPS_S, Predictor
from diagnosis.search.fitting import fit_all
from diagnosis.traces.reference import Reference

RUBS = {"coulomb_friction", "viscous_friction", "stribeck_friction", "load_friction"}


def noisy(traces, noise_rad=0.006):
    """More noise than integrators of the same physics differ by."""
    rng = np.random.default_rng(0)
    more = [rng.normal(0, noise_rad, one.position_rad.shape) for one in traces]
    return [
        replace(one, position_rad=one.position_rad + noise)
        for one, noise in zip(traces, more, strict=True)
    ]


@pytest.fixture(scope="module")
def stiff_and_dry(plant):
    return noisy(
        [swing(plant, seed, dry=0.15, gain=1.3, seconds=2.5) for seed in (0, 1)]
    )


def factors(verdict):
    """By the names of effects their first value, a gain's factor."""
    return {
        one.name: next(iter(one.parameters.values())).value for one in verdict.effects
    }


@pytest.mark.slow
def test_it_names_two_effects_where_there_are_two(plant, stiff_and_dry):
    verdict = ebic.answer(plant, stiff_and_dry)
    values = {one.name: one.parameters for one in verdict.effects}
    assert len(set(values) & RUBS) == 1
    (other,) = set(values) - RUBS
    # only torques over inertia show: a lighter pendulum looks like a stiffer servo
    mass_kg = float(plant.model.body_mass.sum())
    true = {"servo_gain": 1.3, "payload_mass": mass_kg / 1.3 - mass_kg}[other]
    assert factors(verdict)[other] == pytest.approx(true, rel=0.02)
    sure = [one.probability for one in verdict.effects]
    assert sure == sorted(sure, reverse=True)
    assert all(0 < one <= 1 for one in sure)


@pytest.mark.slow
def test_it_stops_where_nothing_more_pays(plant, clean, stiff_and_dry):
    assert ebic.answer(plant, noisy(clean)).kind == "none"
    predictor = exact_replays(plant, stiff_and_dry, None, ebic.explained)
    steps = ebic.stepwise(predictor)
    sizes = [len(step.fit.model) for step in steps]
    assert sizes == list(range(1, len(steps) + 1))
    gains = -np.diff([step.fit.energy for step in steps])
    # of one value and without candidates half the logarithm of the samples
    assert (gains > 0.5 * math.log(predictor.scored.sum())).all()
    kept = ebic.without_idle(predictor, steps[-1].fit)
    assert len(kept) == 2 <= len(steps)


def test_each_effect_costs_the_logarithm_of_the_candidates(plant, clean):
    predictor = Predictor(plant, clean)
    one = PlacedEffect("viscous_friction", "swing", (0.01,))
    two = PlacedEffect("coulomb_friction", "swing", (0.01,))
    for model in ((one,), (one, two)):
        (fit,) = fit_all(predictor, [model], steps=1)
        more = ebic.extended(fit, 1000, 50) - bic.criterion(fit, 1000)
        assert more == pytest.approx(2 * len(model) * math.log(50))


def test_baselines_take_the_same_steps_as_a_diagnosis(plant, clean):
    predictor = exact_replays(plant, clean, None, ebic.explained)
    assert predictor.step_s in STEPS_S["fixed"]
    coarse = Predictor(plant, clean)
    left = [np.std(one.residuals([()])[0]) for one in (predictor, coarse)]
    assert left[0] < left[1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "noise_rad", "seconds", "dry_nm"),
    [
        ("bic", 0.006, 2, 0.2),  # weaker friction is usual
        ("ebic", 0.006, 2, 0.3),
        ("sparse", 0.0, 3, 0.1),
        ("sysid", 0.006, 2, 0.1),
    ],
)
def test_what_the_healthy_robot_shows_is_taken_as_given(
    plant,
    name,
    noise_rad,
    seconds,
    dry_nm,
):
    """The servo was stiffer before: friction is new, and what looks like it.

    How stiff it was is known from noisy recordings, so that a little of it may be left.
    """
    before = [swing(plant, seed, gain=1.4, seconds=seconds) for seed in (5, 6)]
    options = {"dry": dry_nm, "gain": 1.4, "seconds": seconds}
    now = [swing(plant, seed, **options) for seed in (0, 1)]
    before, now = noisy(before, noise_rad), noisy(now, noise_rad)
    changed = factors(BASELINES[name](plant, now, Reference(plant, before)))
    assert set(changed) <= RUBS | {"servo_damping", "servo_gain"}
    assert set(changed) & RUBS
    assert changed.get("servo_gain", 1.0) == pytest.approx(1, abs=0.05)
    alone = factors(BASELINES[name](plant, now, None))
    assert not set(alone) <= RUBS


def test_without_commands_sysid_abstains(plant, dry):
    torque_driven = [replace(dry[0], command_rad=None)]
    verdict = sysid.answer(plant, torque_driven)
    assert verdict.kind == "not_identifiable"
    assert sparse.answer(plant, torque_driven).kind == "not_identifiable"
