"""Real robots are far from their models: what changed since is found in torques."""

import numpy as np
import pytest
from rough_arm import SMOOTH_NM, declaring, followed, hurried, stiff_arm
from torque_arm import loaded

from diagnosis.material import Material
from diagnosis.pipeline import diagnose
from diagnosis.residuals.torques.asked_torques import FAR, times_noise
from diagnosis.traces.reference import Reference


@pytest.fixture(scope="module")
def healthy():
    return Reference(stiff_arm(), [followed(seed=seed) for seed in (10, 11, 12)])


@pytest.fixture(scope="module")
def traces():
    return [followed(seed=seed) for seed in (0, 1, 2)]


def verdict_of(traces, healthy):
    random = np.random.SeedSequence(1)
    return diagnose(stiff_arm(), traces, random, reference=healthy).verdict


def only_effect(verdict):
    """Name, place and value of the only effect."""
    assert verdict.kind == "effects"
    (found,) = verdict.effects
    (value,) = (one.value for one in found.parameters.values())
    return found.name, found.place, value


def test_nothing_is_named_where_nothing_changed(traces, healthy):
    verdict = verdict_of(traces, healthy)
    assert verdict.kind == "none"
    assert any("torques for which servos ask" in text for text in verdict.limits)


@pytest.mark.slow
def test_a_servo_that_is_declared_too_stiff_is_found(traces, healthy):
    wrong = [declaring(trace, "shoulder", 1.5) for trace in traces]
    name, place, factor = only_effect(verdict_of(wrong, healthy))
    assert (name, place) == ("servo_gain", "shoulder")
    assert factor == pytest.approx(1 / 1.5, rel=0.05)


@pytest.mark.slow
def test_late_commands_are_found(traces, healthy):
    wrong = [hurried(trace, 3) for trace in traces]
    name, place, delay_s = only_effect(verdict_of(wrong, healthy))
    assert (name, place) == ("command_latency", "commands")
    assert delay_s == pytest.approx(0.03, rel=0.1)


@pytest.mark.slow
def test_a_payload_is_found_at_its_link(healthy):
    heavier = [followed(loaded(1.0, "lower"), seed=seed) for seed in (0, 1, 2)]
    name, place, mass_kg = only_effect(verdict_of(heavier, healthy))
    assert (name, place) == ("payload_mass", "lower")
    assert mass_kg == pytest.approx(1.0, rel=0.1)


@pytest.fixture(scope="module")
def near():
    return [followed(seed=seed, friction_nm=SMOOTH_NM) for seed in (0, 1, 10, 11)]


def test_a_factor_of_two_in_what_is_far_hardly_matters(healthy, near):
    assert times_noise(stiff_arm(), healthy.traces) > 2 * FAR
    assert times_noise(stiff_arm(), near[2:]) < FAR / 2


def test_motions_are_compared_of_a_robot_that_is_near_its_model(near):
    reference = Reference(stiff_arm(), near[2:])
    material = Material.of(stiff_arm(), near[:2], reference, "servos")
    assert all(trace.motion is None for trace in material.traces)
    assert material.channels.names[0].startswith("position.")
