"""Transitions: what fits together, and that episodes are never torn apart."""

import numpy as np
import pytest

from groundwalk.errors import BadValueError
from sgat.transitions import Transitions


def transitions(lengths, states=3, outcomes=3, first=0):
    n = sum(lengths)
    state = np.arange(n * states, dtype=float).reshape(n, states)
    episode = np.repeat(np.arange(len(lengths)) + first, lengths)
    return Transitions(
        state, np.ones((n, 2)), state[:, :outcomes] + [1, 2, 4][:outcomes], episode
    )


def test_a_change_is_of_the_predicted_columns_only():
    assert transitions([4]).change.tolist() == [[1, 2, 4]] * 4
    with_context = transitions([4], outcomes=2)
    assert with_context.outcomes == 2
    assert with_context.change.tolist() == [[1, 2]] * 4


def test_joining_keeps_everything_and_gives_episodes_new_numbers():
    one, two = transitions([3, 2]), transitions([2, 4])
    joined = one.joined(two)
    assert joined.episode.tolist() == [0, 0, 0, 1, 1, 2, 2, 3, 3, 3, 3]
    for name in ("state", "action", "next_state"):
        both = np.concatenate([getattr(one, name), getattr(two, name)])
        np.testing.assert_array_equal(getattr(joined, name), both)


@pytest.mark.parametrize("share", [0.01, 0.2, 0.5, 0.99])
def test_a_split_is_by_whole_episodes(share):
    whole = transitions([3, 5, 2, 7, 4])
    kept, held_out = whole.split(share, np.random.default_rng(1))
    count = len(np.unique(held_out.episode))
    assert count == min(max(round(share * 5), 1), 4)
    assert not set(kept.episode) & set(held_out.episode)
    assert sorted([*kept.state[:, 0], *held_out.state[:, 0]]) == [*whole.state[:, 0]]


def test_a_split_is_the_generators():
    whole = transitions([3] * 20)
    first, again, other = (
        whole.split(0.3, np.random.default_rng(seed))[1].episode for seed in (1, 1, 2)
    )
    assert first.tolist() == again.tolist() != other.tolist()


def test_a_subset():
    whole = transitions([3, 2])
    some = whole.subset(whole.state[:, 0] > 5)
    assert some.state[:, 0].tolist() == [6, 9, 12]
    assert some.episode.tolist() == [0, 1, 1]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"action": np.ones((4, 2))}, "differ in length"),
        ({"episode": np.zeros(4, int)}, "differ in length"),
        ({"state": np.ones(5)}, "state has the shape"),
        ({"next_state": np.full((5, 3), np.nan)}, "next_state holds"),
        ({"next_state": np.ones((5, 4))}, "wider"),
        ({"episode": np.array([0, 0, 1, 1, 0])}, "consecutive"),
    ],
)
def test_what_does_not_fit_is_refused(change, words):
    arrays = {
        "state": np.ones((5, 3)),
        "action": np.ones((5, 2)),
        "next_state": np.ones((5, 3)),
        "episode": np.array([0, 0, 1, 1, 3]),
    }
    Transitions(**arrays)
    with pytest.raises(BadValueError, match=words):
        Transitions(**(arrays | change))


def test_what_cannot_be_held_out_is_refused():
    rng = np.random.default_rng(0)
    with pytest.raises(BadValueError, match="at least two"):
        transitions([9]).split(0.5, rng)
    for share in (0.0, 1.0):
        with pytest.raises(BadValueError, match="share"):
            transitions([3, 3]).split(share, rng)
