"""With recordings of when all was well, only what has changed since is named."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from joint_rigs import run_from, ticks, trace_of
from known_arms import SINGLE, measured
from made_up_traces import arm, arm_command, recorded
from swinger_rig import moved, swinger, with_speeds

from diagnosis.effects.parts import PlacedEffect
from diagnosis.pipeline import diagnose
from diagnosis.replay.replay import replay
from diagnosis.residuals.channels import shared_channels
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.residuals.replays import variants_of
from diagnosis.residuals.small_mismatch.usual_errors import is_usual
from diagnosis.search import reference as search_reference
from diagnosis.search.hooks import Hooks
from diagnosis.search.judging import Judge
from diagnosis.search.reference import learn_reference, reference_checks
from diagnosis.traces.reference import Reference
from diagnosis.traces.windows import runs_of
from groundwalk.errors import BadRecordingError

SEED = np.random.SeedSequence(0)


def rubbing(t, q, v):
    """What the arm's model never had."""
    return np.array([0.0, -0.6]) * v


def waving(t, q, v):
    """What no effect describes: a torque from somewhere."""
    return np.array([0.15, 0.0]) * np.sin(9 * t)


@cache
def of_arm(first, gain=(1.0, 1.0)):
    return [
        replace(
            measured(seed, rubbing, duration_s=2.0, gain=gain), name=f"recording {seed}"
        )
        for seed in range(first, first + 3)
    ]


@cache
def of_swinger(first, **options):
    return [moved(seed, duration_s=2.0, **options) for seed in range(first, first + 3)]


def verdict_of(plant, traces, reference, rules=SINGLE):
    healthy = Reference(plant, reference) if reference else None
    return diagnose(plant, traces, SEED, rules, reference=healthy).verdict


@pytest.mark.slow
def test_what_an_arm_lacked_before_is_part_of_it():
    plant, before = arm(), of_arm(0)
    found = diagnose(
        plant, of_arm(10), SEED, SINGLE, reference=Reference(plant, before)
    )
    (given,) = [one for one in found.given if not is_usual(plant, one)]
    assert given.place == "elbow"
    assert given.name in ("viscous_friction", "servo_damping")
    assert found.verdict.kind == "none"
    assert given.name in found.verdict.limits[-1]


@pytest.mark.slow
def test_of_an_arm_only_the_change_is_named():
    verdict = verdict_of(arm(), of_arm(10, gain=(0.8, 1.0)), of_arm(0))
    (found,) = verdict.effects
    assert (found.name, found.place) == ("servo_gain", "shoulder")
    assert found.parameters["factor"].value == pytest.approx(0.8, abs=0.02)


@pytest.mark.slow
def test_without_a_reference_the_arm_still_lacks_its_friction():
    verdict = diagnose(arm(), of_arm(10), SEED, SINGLE).verdict
    assert {found.place for found in verdict.effects} == {"elbow"}


@pytest.mark.slow
def test_a_robot_on_its_feet_with_the_same_old_fault_lacks_nothing():
    before = of_swinger(0, load=waving)
    verdict = verdict_of(swinger(), of_swinger(10, load=waving), before)
    assert verdict.kind == "none"
    assert verdict_of(swinger(), of_swinger(10, load=waving), []).kind != "none"


@pytest.mark.slow
def test_a_robot_on_its_feet_whose_servo_has_become_weak():
    before = of_swinger(0, load=waving)
    weak = of_swinger(10, load=waving, gain=(1.0, 0.8))
    verdict = verdict_of(swinger(), weak, before)
    (found,) = verdict.effects
    assert (found.name, found.place) == ("servo_gain", "right")
    assert found.parameters["factor"].value == pytest.approx(0.8, abs=0.03)


def test_an_unreadable_reference_is_refused():
    trace = moved(0, duration_s=1.0)
    backwards = replace(trace, time_s=trace.time_s[::-1].copy())
    plant = swinger()
    with pytest.raises(BadRecordingError, match="reference"):
        learn_reference(plant, [backwards], shared_channels(plant, [trace]))


@pytest.mark.parametrize("count", [1, 2, 3])
def test_each_half_of_a_reference_is_judged_by_the_other(count):
    plant = swinger()
    traces = [moved(seed, duration_s=1.5) for seed in range(count)]
    none = ReferenceNoise.known((), 8)
    wells = reference_checks(plant, traces, shared_channels(plant, traces), none)
    first, second = ({t.name.split("[")[0] for t in well.traces} for well in wells)
    assert first | second == {f"swing {seed}" for seed in range(count)}
    assert count == 1 or not first & second
    times = [well.traces[0].time_s for well in wells]
    assert count > 1 or times[0][-1] < times[1][0]


def test_what_explains_the_reference_too_gains_nothing():
    """A servo that was weak before, found again as weak as it always was."""
    plant = swinger()
    before, after = ([moved(k, gain=(0.8, 1.0), duration_s=1.5)] for k in (0, 5))
    channels = shared_channels(plant, [*before, *after])
    select = Predictor(plant, after, channels, noise=ReferenceNoise.known((), 8))
    well = Predictor(plant, before, channels, noise=ReferenceNoise.known((), 8))
    for predictor in (select, well):
        predictor.calibrate()
    model = (PlacedEffect("servo_gain", "left", (0.8,)),)
    plain, wise = (
        Judge(select, select, healthy=wells).judged([model])[0].selected
        for wells in ((), (well,))
    )
    nothing = 0.5 * float(np.sum(select.residuals([()]) ** 2))
    assert plain < 0.9 * nothing
    assert wise > nothing - 0.2 * (nothing - plain)


def test_with_a_fixed_base_what_was_learned_leaves_little():
    """What is still unknown of small mismatch is less than what is usual, too."""
    plant, traces = arm(), of_arm(0)[:2]
    channels = shared_channels(plant, traces)
    friction = (PlacedEffect("viscous_friction", "elbow", (0.6,)),)
    noise = learn_reference(plant, traces, channels, known=friction)
    (check,) = reference_checks(plant, traces, channels, noise)
    (left,) = check.residuals([()])
    assert np.mean(left[check.scored] ** 2) < 1.2
    gone = (PlacedEffect("viscous_friction", "elbow", (-0.3,)),)
    (wrong,) = check.residuals([gone])
    assert np.mean(wrong[check.scored] ** 2) > 4
    power = np.linalg.eigvalsh(noise.spread)
    assert 0 < power[0] < 0.1
    assert power[-1] <= 1 + 1e-9


def test_what_recordings_leave_unknown_of_old_effects_is_no_change():
    """The elbow rubs a quarter more; known well that is a change, else it is not."""
    plant, traces = arm(), of_arm(0)[:2]
    channels = shared_channels(plant, traces)
    friction = (PlacedEffect("viscous_friction", "elbow", (0.6,)),)
    noise = learn_reference(plant, traces, channels, known=friction)
    assert [one.key for one in noise.found] == ["viscous_friction@elbow"]
    after = [measured(7, lambda t, q, v: np.array([0.0, -0.75]) * v, duration_s=2.0)]
    left = {}
    for unknown in (0.0, 1.0):
        spread = np.diag([*(len(noise.spread) - 1) * [0.0], unknown])
        some = Predictor(plant, after, channels, noise=replace(noise, spread=spread))
        some.calibrate()
        (residual,) = some.residuals([()])
        left[unknown] = np.mean(residual[some.scored] ** 2)
        (part,) = some.part(0, 1).residuals([()])
        np.testing.assert_allclose(part, residual)
    assert left[0.0] > 20
    assert left[1.0] < 1.5


@pytest.mark.slow
def test_a_fault_as_small_as_usual_errors_is_seen_beside_a_reference():
    """A servo that lost 6 % of its stiffness: a model may be as wrong, a robot not."""
    before, after = of_arm(0), of_arm(10, gain=(0.94, 1.0))
    (found,) = verdict_of(arm(), after, before).effects
    assert (found.name, found.place) == ("servo_gain", "shoulder")
    assert found.parameters["factor"].value == pytest.approx(0.94, abs=0.01)
    assert "servo_gain" not in {
        one.name for one in verdict_of(arm(), after, []).effects
    }


def test_no_window_starts_at_the_edge_of_a_recording():
    """Speeds there are not well known; what is left over is not scored."""
    trace, plant = moved(0, duration_s=0.7), swinger()
    edge, first, second, scrap = runs_of(plant, trace)
    assert [run.trace.ticks for run in (edge, first, second, scrap)] == [5, 30, 30, 5]
    predictor = Predictor(plant, [trace])
    scored = predictor.scored.reshape(trace.ticks, -1).any(axis=1)
    expected = np.ones(trace.ticks, bool)
    expected[[*range(6), 35, *range(65, 70)]] = False
    np.testing.assert_array_equal(scored, expected)


def test_measured_speeds_of_the_base_count_half():
    trace, plant = moved(0, duration_s=1.0), swinger()
    told = with_speeds(trace, (1.0, 0.0, -1.0), (0.0, 2.0, 0.0))
    plain, mixed = (runs_of(plant, one)[1].base[7:] for one in (trace, told))
    expected = (plain + np.array([1.0, 0.0, -1.0, 0.0, 2.0, 0.0])) / 2
    np.testing.assert_allclose(mixed, expected, atol=1e-6)


def test_what_is_larger_than_usual_is_taken_as_given_as_a_whole():
    """On the bound of small mismatch, 0.12 N m, the rest of it would look new."""
    traces = [
        recorded(arm(), ("coulomb_friction", "elbow", 0.16), seed=seed, duration_s=3.0)
        for seed in (0, 1)
    ]
    options = shared_channels(arm(), traces), 1, Hooks()
    sims = search_reference._Simulations.of(arm(), traces, *options)
    found = search_reference._with_small_mismatch(sims, traces, ())
    (large,) = [one for one in found if not is_usual(arm(), one)]
    assert large.key == "coulomb_friction@elbow"
    assert large.values[0] == pytest.approx(0.16, rel=0.05)


def stepping(plant, seed, noise_rad):
    """A plant in very short time steps whose commands jump, so that servos saturate."""
    time_s = ticks(2.0, 0.02)
    jumps = np.sign(arm_command(time_s, seed)) * (time_s > 0.5)[:, None]
    trace = trace_of(plant, time_s, command_rad=0.5 * jumps)
    (run,) = replay([run_from(trace)], variants_of(plant, [()]), 2.5e-5)
    noise = np.random.default_rng(seed).standard_normal((len(time_s), 2))
    position_rad = run.position_rad[0] + noise_rad * noise
    return replace(trace, name=f"steps {seed}", position_rad=position_rad)


@pytest.mark.slow
def test_errors_of_the_simulation_are_not_learned_from_the_healthy_robot():
    """With the steps that do elsewhere, up to 4 times the noise would be left."""
    plant = arm(kp=60.0, kd=1.5, limit=4.0)
    traces = [stepping(plant, seed, 1e-4) for seed in (0, 1)]
    channels = shared_channels(plant, traces)
    small = replace(channels, noise=np.full(2, 1e-4), floor=np.full(2, 1e-4))
    sims = search_reference._Simulations.of(plant, traces, small, 1, Hooks())
    check = sims.predictor(traces)
    (left,) = check.without_tolerances().residuals([()])
    assert np.mean(left[check.scored] ** 2) < 1.1
