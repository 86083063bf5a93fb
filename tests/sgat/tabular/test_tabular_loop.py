import numpy as np
import pytest

from groundwalk.errors import BadValueError
from sgat.tabular.grounding import TabularLoop, ground_until_calm
from sgat.tabular.mdp import FiniteMdp

SHORT, LONG, GOAL, HOLE = 1, 2, 4, 5
LOOP = TabularLoop(episodes=3000, known_after=20)


def fork(slip):
    """From 0 over 1 to the goal, where one may slip into a hole, or over 2 and 3."""
    targets = [[SHORT, LONG], [GOAL, HOLE], [3, 3], [GOAL, 3], [GOAL] * 2, [HOLE] * 2]
    transition = np.eye(6)[np.array(targets)]
    transition[SHORT, 0, [GOAL, HOLE]] = 1 - slip, slip
    reward = np.array([-0.1, -0.1, -0.1, -0.1, 9.9, -10.1])
    return FiniteMdp(transition, reward, np.arange(6) >= GOAL)


def settle(slip, samples, loop=LOOP, seed=1):
    luck = np.random.default_rng(seed)
    return ground_until_calm(fork(0), fork(slip), samples, loop, luck)


@pytest.mark.parametrize(
    ("slip", "samples", "way"),
    [
        (0, True, SHORT),
        (0, False, SHORT),
        (0.3, True, LONG),
        (0.3, False, SHORT),  # the likeliest step does not slip
        (0.7, True, LONG),
        (0.7, False, LONG),
        (0.001, True, SHORT),  # the way round costs more than the risk
    ],
)
def test_which_way_is_taken(slip, samples, way):
    settled = settle(slip, samples)
    assert settled.policy[0] == way - 1
    assert settled.calm


def test_what_the_loop_costs():
    none = settle(0, True)
    assert none.steps == LOOP.calm_steps
    some = settle(0.3, True)
    assert none.steps < some.steps <= 6
    assert none.transitions >= none.steps * LOOP.episodes * 2  # 2 steps to the goal


def test_a_loop_that_may_not_go_on_says_so():
    settled = settle(0.3, True, TabularLoop(episodes=3000, most_steps=2))
    assert settled.steps == 2
    assert not settled.calm


def test_the_same_seed_gives_the_same_loop():
    one, again, other = (settle(0.3, True, seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.policy, again.policy)
    assert one.transitions == again.transitions != other.transitions


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"episodes": 0}, "episodes is 0"),
        ({"known_after": 0}, "known_after is 0"),
        ({"calm_steps": 0}, "calm_steps is 0"),
        ({"exploration": 1.5}, "exploration is 1.5"),
    ],
)
def test_impossible_loops_are_refused(settings, message):
    with pytest.raises(BadValueError, match=message):
        TabularLoop(**settings)
