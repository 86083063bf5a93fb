"""Starting, stopping, rising and crouching."""

import numpy as np
import pytest
from walk_drill import Drill

from walk_engine import Velocity, WalkEngine, WalkState, gaits

WALK2014 = gaits.get("walk2014")
S = WalkState


def sequence(drill):
    """The states in the order in which they were met."""
    states = np.array(drill.states)[:, 0]
    kept = np.concatenate([[True], states[1:] != states[:-1]])
    return [WalkState(state) for state in states[kept]]


def test_walks_and_stops(unlimited):
    engine = WalkEngine(unlimited, [WALK2014])
    drill = Drill(engine)
    drill.run(5, Velocity())
    drill.run(100, Velocity.forward())
    last = drill.run(80, Velocity())[-1]
    walk = [S.READY, S.STARTING, S.WALKING, S.STOPPING, S.READY]
    assert sequence(drill) == walk
    assert np.allclose(last, engine.start_pose(), atol=1e-12)
    assert engine.support[0] == 0


def test_stopping_takes_one_step(unlimited):
    drill = Drill(WalkEngine(unlimited, [WALK2014]))
    drill.run(100)
    drill.run(80, Velocity())
    assert [s[0] for s in drill.states].count(S.STOPPING) == 22


def test_weight_that_moves_early_does_not_cut_the_last_step(unlimited):
    drill = Drill(WalkEngine(unlimited, [WALK2014]), half_period_s=0.18)
    drill.run(100)
    drill.run(80, Velocity())
    assert [s[0] for s in drill.states].count(S.STOPPING) == 22


def test_a_step_that_has_begun_is_not_changed(unlimited):
    fast, slow = (Drill(WalkEngine(unlimited, [WALK2014])) for _ in range(2))
    fast.run(50)
    slow.run(50)
    left = 69 - 50  # the step ends in the tick with index 69
    same = np.array_equal(fast.run(left), slow.run(left, Velocity(0.1)))
    assert same
    fast.run(2)
    slow.run(2, Velocity(0.1))
    assert not np.array_equal(fast.run(10), slow.run(10, Velocity(0.1)))


def test_stands_up_and_crouches_again(unlimited):
    engine = WalkEngine(unlimited, [WALK2014])
    drill = Drill(engine)
    standing = drill.run(60, Velocity(stand=True))[-1, 0]
    crouching = drill.run(60, Velocity())[-1]
    assert sequence(drill) == [S.RISING, S.STANDING, S.CROUCHING, S.READY]
    # Published for hips at 0.248 m: -0.0302, 0.0596, -0.0294.
    assert np.allclose(standing[[2, 3, 4]], (-0.030, 0.060, -0.030), atol=4e-3)
    assert np.allclose(crouching, engine.start_pose(), atol=1e-12)


def test_a_standing_torso_is_upright_whatever_the_gait(unlimited):
    leaning = WALK2014.replace(torso_pitch=0.1, com_offset=0.03, hip_height=0.21)
    poses = [
        Drill(WalkEngine(unlimited, [gait])).run(60, Velocity(stand=True))[-1]
        for gait in (WALK2014, leaning)
    ]
    assert np.allclose(poses[0], poses[1], atol=1e-12)


def test_rising_takes_half_a_second(unlimited):
    drill = Drill(WalkEngine(unlimited, [WALK2014]))
    drill.run(60, Velocity(stand=True))
    assert [s[0] for s in drill.states].count(S.STANDING) == 11


def test_a_walking_robot_that_is_asked_to_stand_stops_first(unlimited):
    drill = Drill(WalkEngine(unlimited, [WALK2014]))
    drill.run(60)
    drill.run(150, Velocity(np.inf, stand=True))
    assert sequence(drill)[1:] == [S.WALKING, S.STOPPING, S.READY, S.RISING, S.STANDING]


def test_a_standing_robot_that_is_asked_to_walk_crouches_first(unlimited):
    drill = Drill(WalkEngine(unlimited, [WALK2014]))
    drill.run(60, Velocity(stand=True))
    drill.run(100)
    assert sequence(drill)[1:] == [
        S.STANDING,
        S.CROUCHING,
        S.READY,
        S.STARTING,
        S.WALKING,
    ]


def test_each_robot_obeys_its_own_request(unlimited):
    engine = WalkEngine(unlimited, [WALK2014] * 3)
    request = Velocity(np.array([0.2, 0.0, 0.0]), stand=np.array([False, False, True]))
    Drill(engine).run(60, request)
    assert list(engine.state) == [S.WALKING, S.READY, S.STANDING]


@pytest.mark.parametrize(("foot", "support"), [("left", -1), ("right", 1)])
def test_first_swing(unlimited, foot, support):
    engine = WalkEngine(unlimited, [WALK2014], first_swing=foot)
    Drill(engine).run(1)
    assert engine.support[0] == support


def test_requests_are_cut_to_the_limits(unlimited):
    def commands(request):
        return Drill(WalkEngine(unlimited, [WALK2014])).run(80, request)

    asked, limit = Velocity(np.inf, -np.inf, 9.0), Velocity(0.3, -0.2, 0.87)
    assert np.array_equal(commands(asked), commands(limit))
    below = Velocity(0.29, -0.2, 0.87)
    assert not np.array_equal(commands(below), commands(limit))
