import numpy as np
import pytest

import robots
import terrain
import worlds
from experiments.walking.trials import TrialRules, walk_trials
from groundwalk.errors import BadValueError
from sgat.walks.walk_senses import HISTORY_TICKS, WalkSenses
from sgat.walks.wrapped_worlds import (
    EXPLORATION_MEMORY,
    SETTLING_TICKS,
    WatchedWorld,
    WorldWrapper,
)
from walk_engine import gaits
from worlds import End, WorldOptions

# no coupled ones: the motor of a pair takes the mean of two commands
JOINTS = [3, 4, 9, 10]
TICKS = 300
MOST_S = TICKS / 100


def sim(n, **options):
    seeds = np.random.SeedSequence(1).spawn(n)
    options = WorldOptions(threads=1, **options)
    ground = terrain.make("flat", 0)
    return worlds.make("sim", robots.get("nao"), [ground] * n, seeds, options)


def falling():
    """A gait that leans so far that it must fall."""
    return gaits.get("walk2014").replace(torso_pitch=0.12, com_offset=0.035)


class Notebook(WorldWrapper):
    """Keeps what each tick was given and gave."""

    def reset(self, pose_rad):
        self.given, self.seen = [], [super().reset(pose_rad)]
        return self.seen[0]

    def step(self, command_rad):
        self.given.append(command_rad.copy())
        self.seen.append(super().step(command_rad))
        return self.seen[-1]


def positions(notebook):
    return np.array([now.position_rad for now in notebook.seen])


@pytest.fixture(scope="module")
def fall():
    """(watched, inside): robot 1 falls, robot 0 does not."""
    inside = Notebook(sim(2))
    watched = WatchedWorld(inside, WalkSenses(JOINTS))
    walk_trials(watched, [gaits.get("start"), falling()], TrialRules(limit_s=MOST_S))
    assert watched.ended == [End.NONE, End.FALL]
    return watched, inside


def test_what_an_action_led_to_is_the_next_state(fall):
    seen = fall[0].transitions()
    same = seen.episode[1:] == seen.episode[:-1]
    assert seen.outcomes == len(JOINTS) + 5
    assert np.unique(seen.episode).tolist() == [0, 1]
    following = seen.state[1:, : seen.outcomes] == seen.next_state[:-1]
    assert following[same].all()
    assert not following[~same].all()


def test_a_fallen_robot_ends_with_its_true_last_state(fall):
    watched, inside = fall
    seen = watched.transitions()
    last = seen.next_state[seen.episode == 1][-1]
    ticks = round(inside.seen[-1].time_s[1] * 100)
    assert SETTLING_TICKS < ticks < TICKS
    end = inside.seen[ticks]
    j = len(JOINTS)
    assert (last[:j] == end.position_rad[1, JOINTS]).all()
    assert (last[j : j + 3] == end.gyroscope_rad_s[1]).all()
    # a robot one tick before its end is another, and so is the other robot's start
    assert (last[:j] != inside.seen[ticks - 1].position_rad[1, JOINTS]).all()
    assert (last[:j] != inside.seen[0].position_rad[1, JOINTS]).all()


def test_an_ended_robot_adds_nothing(fall):
    watched, inside = fall
    seen = watched.transitions()
    counts = np.bincount(seen.episode) + SETTLING_TICKS
    assert counts.tolist() == np.rint(inside.seen[-1].time_s * 100).tolist()
    assert counts[0] == TICKS > counts[1]


def test_a_stopped_robot_adds_nothing():
    watched = WatchedWorld(sim(2), WalkSenses(JOINTS))
    rules = TrialRules(limit_s=1.5, course_m=0.1)
    slow = gaits.get("start").replace(max_forward=0.05)
    trials = walk_trials(watched, [gaits.get("start"), slow], rules)
    counts = np.bincount(watched.transitions().episode) + SETTLING_TICKS
    assert counts == pytest.approx(100 * trials.time_s)
    assert counts[0] < counts[1] == 150


def test_a_robot_that_blew_up_leaves_out_its_last_tick():
    watched = WatchedWorld(sim(2), WalkSenses(JOINTS))
    pose = np.zeros((2, 20))
    watched.reset(pose)
    for tick in range(20):
        command = pose.copy()
        command[1, 0] = np.nan if tick == 15 else 0
        watched.step(command)
    assert watched.ended == [End.NONE, End.DIVERGED]
    counts = np.bincount(watched.transitions().episode) + SETTLING_TICKS
    assert counts.tolist() == [20, 15]


def test_states_and_actions_are_those_before_the_tick(fall):
    watched, inside = fall
    seen = watched.transitions()
    mine = seen.episode == 0
    j, past_ticks = len(JOINTS), HISTORY_TICKS - 1
    at = positions(inside)[:, 0][:, JOINTS]
    given = np.array(inside.given)[:, 0][:, JOINTS]
    assert (seen.state[mine, :j] == at[SETTLING_TICKS:-1]).all()
    assert (seen.action[mine] == (given - at[:-1])[SETTLING_TICKS:]).all()
    assert (seen.next_state[mine, :j] == at[SETTLING_TICKS + 1 :]).all()
    # nothing of the history of the first one noted is made up
    first = seen.state[mine][0, -past_ticks * j :].reshape(past_ticks, j)
    asked = given[SETTLING_TICKS - past_ticks : SETTLING_TICKS]
    assert (first == asked - at[SETTLING_TICKS]).all()


def test_the_history_holds_the_commands_with_their_noise():
    inside = Notebook(sim(1, fixed_base=True))
    seed = np.random.SeedSequence(6)
    watched = WatchedWorld(inside, WalkSenses(JOINTS), 0.02, seed)
    pose = np.zeros((1, 20))
    watched.reset(pose)
    for _ in range(20):
        watched.step(pose)
    last = watched.transitions().state[-1]
    j, past_ticks = len(JOINTS), HISTORY_TICKS - 1
    given = np.array(inside.given)[-HISTORY_TICKS:-1, 0][:, JOINTS]
    past = last[-past_ticks * j :].reshape(past_ticks, j)
    assert (past == given - last[:j]).all()
    assert (past != pose[0, JOINTS] - last[:j]).all()


def test_to_watch_changes_no_bit(fall):
    rules = TrialRules(limit_s=MOST_S)
    worn = [gaits.get("start"), falling()]
    bare = Notebook(sim(2))
    walk_trials(bare, worn, rules)
    assert (positions(bare) == positions(fall[1])).all()
    explored = Notebook(sim(2))
    seed = np.random.SeedSequence(2)
    walk_trials(WatchedWorld(explored, WalkSenses(JOINTS), 0.001, seed), worn, rules)
    ticks = min(len(bare.seen), len(explored.seen))
    assert (positions(explored)[:ticks] != positions(bare)[:ticks]).any()


def exploration(exploration_rad, n=8, ticks=1000, seed=3):
    """Noise (ticks, n, j) on the commands of robots that hang in the air."""
    inside = Notebook(sim(n, fixed_base=True))
    seed = np.random.SeedSequence(seed)
    watched = WatchedWorld(inside, WalkSenses(JOINTS), exploration_rad, seed)
    pose = np.zeros((n, 20))
    watched.reset(pose)
    for _ in range(ticks):
        watched.step(pose)
    given = np.array(inside.given)
    others = [k for k in range(20) if k not in JOINTS]
    assert (given[..., others] == 0).all()
    # actions say what was really done
    action = watched.transitions().action.reshape(n, ticks - SETTLING_TICKS, -1)
    at = positions(inside)[SETTLING_TICKS:-1][..., JOINTS]
    assert (action == (given[SETTLING_TICKS:][..., JOINTS] - at).swapaxes(0, 1)).all()
    return given[50:][..., JOINTS]


def lag_one(noise):
    return np.corrcoef(noise[:-1].ravel(), noise[1:].ravel())[0, 1]


def test_exploration_is_as_strong_and_as_slow_as_it_says():
    # 30,400 numbers, about 1,600 of them independent: 4 standard errors
    noise = exploration(0.02)
    assert noise.std() == pytest.approx(0.02, rel=0.07)
    assert abs(noise.mean()) < 4 * 0.02 / np.sqrt(1600)
    assert lag_one(noise) == pytest.approx(EXPLORATION_MEMORY, abs=0.015)
    white = np.random.default_rng(0).normal(size=noise.shape)
    assert abs(lag_one(white)) < 0.1
    # no two joints and no two robots have the same
    of_each = np.corrcoef(noise.reshape(len(noise), -1).T)
    assert np.abs(of_each - np.eye(len(of_each))).max() < 0.6


def test_every_robot_may_have_its_own_exploration():
    asked = np.array([[0.0], [0.01], [0.04]])
    noise = exploration(asked, n=3)
    assert (noise[:, 0] == 0).all()
    assert noise[:, 1].std() == pytest.approx(0.01, rel=0.25)
    assert noise[:, 2].std() == pytest.approx(0.04, rel=0.25)


def test_exploration_is_its_seeds():
    one, same, other = (exploration(0.02, 1, 60, seed) for seed in (4, 4, 5))
    assert (one == same).all()
    assert (one != other).all()


@pytest.mark.parametrize("amount", [0.01, np.array([[0.0], [0.01]])])
def test_exploration_needs_a_seed(amount):
    with pytest.raises(BadValueError, match="seed"):
        WatchedWorld(sim(2), WalkSenses(JOINTS), amount)
    WatchedWorld(sim(2), WalkSenses(JOINTS), amount, np.random.SeedSequence(0))
    WatchedWorld(sim(2), WalkSenses(JOINTS), 0 * amount)


@pytest.mark.parametrize("amount", [-0.01, np.nan, np.array([[0.01], [-0.01]])])
def test_exploration_is_no_less_than_none(amount):
    with pytest.raises(BadValueError, match="negative"):
        WatchedWorld(sim(2), WalkSenses(JOINTS), amount, np.random.SeedSequence(0))


def test_the_start_is_not_noted():
    watched = WatchedWorld(sim(2), WalkSenses(JOINTS))
    pose = np.zeros((2, 20))
    watched.reset(pose)
    for _ in range(SETTLING_TICKS):
        watched.step(pose)
    with pytest.raises(BadValueError, match="nothing was noted"):
        watched.transitions()
    watched.step(pose)
    assert watched.transitions().n == 2
    watched.reset(pose)
    with pytest.raises(BadValueError, match="nothing was noted"):
        watched.transitions()
