import contextlib

import numpy as np
import pytest

import robots
import terrain
import worlds
from experiments.walking.trials import (
    TrialRules,
    Trials,
    course,
    reward_cm_s,
    walk_trials,
)
from groundwalk.errors import BadValueError
from walk_engine import gaits
from worlds import End


def sim(n=1, **options):
    seeds = np.random.SeedSequence(1).spawn(n)
    ground = terrain.make("flat", 0)
    options = worlds.WorldOptions(**options)
    return worlds.make("sim", robots.get("nao"), [ground] * n, seeds, options)


def falling():
    """A gait that leans so far that it must fall."""
    return gaits.get("walk2014").replace(torso_pitch=0.12, com_offset=0.035)


def test_the_2014_constants_walk_in_the_sim():
    # rUNSWift's constants, 20 cm/s commanded: no fall in 7.5 s, at least 14 cm/s
    gait = gaits.get("walk2014").replace(max_forward=0.20)
    trials = walk_trials(sim(), [gait], TrialRules(limit_s=7.5))
    assert trials.ended == (End.NONE,)
    assert 14 <= trials.speed_cm_s[0] <= 21
    assert trials.time_s[0] == pytest.approx(7.5)


def test_a_gait_that_cannot_stand_falls_and_ends_early():
    trials = walk_trials(sim(), [falling()], TrialRules(limit_s=7.5))
    assert trials.ended == (End.FALL,)
    assert trials.fell[0]
    assert trials.time_s[0] < 7.5


def test_a_course_ends_the_trial_where_it_ends():
    rules = TrialRules(limit_s=20, course_m=0.5)
    trials = walk_trials(sim(), [gaits.get("start")], rules)
    assert 0.5 <= trials.distance_m[0] < 0.51
    assert trials.time_s[0] < 5
    assert not trials.fell[0]


def test_a_course_of_any_length_leaves_time_to_walk_it():
    """At 7.5 cm/s; starts differ a little."""
    rules = course(0.4)
    assert (rules.course_m, rules.start_spread_rad) == (0.4, 0.01)
    assert rules.limit_s == pytest.approx(0.4 / 0.075)
    for length_m in (0.0, -1.0, np.nan):
        with pytest.raises(BadValueError, match="must be positive"):
            course(length_m)


def test_each_robot_walks_as_it_would_alone():
    mixed = [gaits.get("start"), falling(), gaits.get("walk2014")]
    rules = TrialRules(limit_s=2)
    together = walk_trials(sim(3), mixed, rules)
    for i, gait in enumerate(mixed):
        alone = walk_trials(sim(), [gait], rules)
        assert alone.distance_m[0] == together.distance_m[i]
        assert alone.time_s[0] == together.time_s[i]


def test_150_robots_on_two_threads_have_the_bits_of_one_alone_on_one():
    gait = gaits.get("start")
    rules = TrialRules(limit_s=0.6)
    many = walk_trials(sim(150, threads=2), [gait] * 150, rules)
    one = walk_trials(sim(1, threads=1), [gait], rules)
    assert set(many.distance_m) == {one.distance_m[0]}


def test_start_poses_spread_only_when_asked():
    gait = [gaits.get("start")] * 2
    seeds = np.random.SeedSequence(3).spawn(2)
    same = walk_trials(sim(2), gait, TrialRules(limit_s=1), seeds)
    assert same.distance_m[0] == same.distance_m[1]
    rules = TrialRules(limit_s=1, start_spread_rad=0.01)
    spread = walk_trials(sim(2), gait, rules, seeds)
    assert spread.distance_m[0] != spread.distance_m[1]


def test_reward_is_speed_over_the_whole_trial_less_fifteen_after_a_fall():
    trials = Trials(
        distance_m=np.array([1.5, 1.5, 0.3]),
        time_s=np.array([7.5, 7.5, 1.5]),
        ended=(End.NONE, End.FALL, End.DIVERGED),
    )
    np.testing.assert_allclose(reward_cm_s(trials, 7.5), [20.0, 5.0, -11.0])


@pytest.mark.parametrize(
    "values",
    [{"limit_s": 0}, {"limit_s": np.nan}, {"course_m": -1}, {"start_spread_rad": -1}],
)
def test_impossible_trials_are_refused(values):
    with pytest.raises(BadValueError, match=next(iter(values))):
        TrialRules(**values)


@pytest.mark.slow
def test_the_2014_constants_walk_on_flat_real_ground():
    # with the real world's latency and noise, 20 cm/s commanded
    gait = gaits.get("walk2014").replace(max_forward=0.20)
    seeds = np.random.SeedSequence(1).spawn(1)
    ground = terrain.make("flat", 0)
    with contextlib.closing(
        worlds.make("real", robots.get("nao"), [ground], seeds)
    ) as world:
        trials = walk_trials(world, [gait], TrialRules(limit_s=7.5))
    assert trials.ended == (End.NONE,)
    assert trials.speed_cm_s[0] > 12
