"""Worlds small enough to know everything about them."""

import numpy as np

from sgat.transitions import Transitions

A = np.array([[1.0, 0.1, 0.0], [-0.2, 0.95, 0.1], [0.0, -0.1, 0.9]])
B = np.array([[0.0, 0.02], [0.3, 0.0], [0.1, 0.4]])
LIGHT = {"epochs": 40, "learning_rate": 5e-3}
"""Training that is good enough for these worlds."""
LOW, HIGH = np.full(2, -1.0), np.full(2, 1.0)


def linear(state, action, _rng=None):
    """s' = A s + B a."""
    return state @ A.T + action @ B.T


def bent(state, action, _rng=None):
    """s' = A s + a pull + B h(a), h growing everywhere."""
    pull = 0.1 * np.sin(2 * state[:, ::-1])
    return linear(state, action + 0.3 * action**3) + pull


def noisy_actions(world, deviation):
    """The world with a + N(0, deviation^2), clipped, in place of the action."""

    def step(state, action, rng):
        noisy = action + deviation * rng.standard_normal(action.shape)
        return world(state, np.clip(noisy, LOW, HIGH))

    return step


def noisy_states(world, factor):
    """The world with N(0, factor factor^T) added to the next state."""

    def step(state, action, rng):
        return world(state, action) + rng.standard_normal(state.shape) @ factor.T

    return step


def roll(step, episodes, ticks, seed):
    """Transitions from random first states with uniformly random actions."""
    rng = np.random.default_rng(seed)
    state, rows = rng.standard_normal((episodes, 3)), []
    for _ in range(ticks):
        action = rng.uniform(LOW, HIGH, (episodes, 2))
        after = step(state, action, rng)
        rows.append((state, action, after))
        state = after
    stacked = [
        np.stack(column, axis=1).reshape(episodes * ticks, -1)
        for column in zip(*rows, strict=True)
    ]
    return Transitions(*stacked, np.repeat(np.arange(episodes), ticks))


def seeds(n, root=5):
    return [np.random.SeedSequence([root, i]) for i in range(n)]


def action_bias(transformed, ideal):
    """(a,) how far transformed actions (N, a) are off the ideal ones in the mean.

    The ideal is known where the difference between the worlds is: if real only adds
    noise to the action, it is the noisy action.
    """
    return np.asarray((transformed - ideal).mean(axis=0))


def spread_ratio(transformed, ideal, action):
    """(a,) spread of what the transformer adds to an action, over the ideal spread.

    1 is right; a transformer without noise has 0, one whose inverse model shrinks
    has less than 1.
    """
    got = (transformed - action).std(axis=0)
    return np.asarray(got / (ideal - action).std(axis=0))
