import inspect

import numpy as np
import pytest

import robots
import terrain
import worlds
from experiments.walking.trials import TrialRules, walk_trials
from sgat.walks.wrapped_worlds import WorldWrapper
from walk_engine import gaits
from worlds import World, WorldOptions

MEMBERS = [name for name in vars(World) if not name.startswith("_")]


def sim(n=2):
    seeds = np.random.SeedSequence(1).spawn(n)
    options = WorldOptions(threads=1)
    ground = terrain.make("lumps", 3)
    return worlds.make("sim", robots.get("nao"), [ground] * n, seeds, options)


class Inside:
    """Answers every call with its name and what it was given."""

    def __init__(self):
        for name in MEMBERS:
            if isinstance(vars(World)[name], property):
                setattr(self, name, name)
            else:
                setattr(self, name, lambda *given, name=name: (name, *given))


def test_a_wrapper_has_all_that_a_world_has():
    assert {"step", "reset", "truth", "active", "ended", "stop"} <= set(MEMBERS)
    for name in MEMBERS:
        theirs, ours = vars(World)[name], vars(WorldWrapper)[name]
        assert isinstance(ours, property) == isinstance(theirs, property)
        if not isinstance(ours, property):
            assert inspect.signature(ours) == inspect.signature(theirs)


@pytest.mark.parametrize("name", MEMBERS)
def test_everything_reaches_the_world_inside(name):
    wrapper = WorldWrapper(Inside())
    member = getattr(wrapper, name)
    if isinstance(vars(World)[name], property):
        assert member == name
        return
    given = [object()] * (len(inspect.signature(getattr(World, name)).parameters) - 1)
    answer = member(*given)
    # those that answer nothing are seen below
    assert answer == (name, *given) or name in ("stop", "close")


@pytest.mark.parametrize("name", ["stop", "close"])
def test_what_answers_nothing_is_passed_on_too(name):
    inside, calls = Inside(), []
    setattr(inside, name, lambda *given: calls.append(given))
    given = () if name == "close" else (np.array([True, False]),)
    getattr(WorldWrapper(inside), name)(*given)
    assert calls == [given]


class Keeper(WorldWrapper):
    """Keeps the joints of every tick."""

    def reset(self, pose_rad):
        self.seen = []
        return super().reset(pose_rad)

    def step(self, command_rad):
        observation = super().step(command_rad)
        self.seen.append(observation.position_rad)
        return observation


def test_a_walk_through_a_wrapper_has_the_bits_of_a_bare_one():
    rules = TrialRules(limit_s=1.5, course_m=0.15)
    worn = [gaits.get("start"), gaits.get("walk2014")]
    bare, wrapped = Keeper(sim()), Keeper(WorldWrapper(WorldWrapper(sim())))
    one, other = walk_trials(bare, worn, rules), walk_trials(wrapped, worn, rules)
    assert one.ended == other.ended
    assert (one.distance_m == other.distance_m).all()
    assert (one.time_s == other.time_s).all()
    assert one.time_s.min() < 1.5
    assert (np.array(bare.seen) == np.array(wrapped.seen)).all()
    changed = Keeper(sim())
    walk_trials(changed, [gait.replace(max_forward=0.1) for gait in worn], rules)
    ticks = min(len(changed.seen), len(bare.seen))
    assert (np.array(changed.seen[:ticks]) != np.array(bare.seen[:ticks])).any()
