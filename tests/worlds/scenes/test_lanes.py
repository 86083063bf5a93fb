from itertools import pairwise

from worlds.scenes.lanes import SHORTEST_S, lane_of


def test_states_begin_and_end():
    lane = lane_of("pulses", [(3.0, 4.0, "b"), (1.0, 2.0, "a")])
    assert lane.changes == [(1.0, "a"), (2.0, ""), (3.0, "b"), (4.0, "")]


def test_a_moment_is_long_enough_to_be_seen():
    lane = lane_of("stalls", [(1.0, 1.0, "a")])
    assert lane.changes == [(1.0, "a"), (1.0 + SHORTEST_S, "")]


def test_of_two_that_overlap_the_later_one_is_shown():
    lane = lane_of("pulses", [(1.0, 5.0, "a"), (2.0, 3.0, "b")])
    assert lane.changes == [(1.0, "a"), (2.0, "b"), (3.0, "")]


def test_times_increase_strictly():
    spans = [(0.1 * k, 0.1 * k + 0.3, str(k)) for k in range(9)]
    times = [time_s for time_s, _ in lane_of("many", spans).changes]
    assert all(one < other for one, other in pairwise(times))
