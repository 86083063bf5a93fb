"""What makes tests of whole studies short."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial

import pytest
from short_walks import shorten_searches

from experiments.runs import processes
from experiments.walking.trials import TrialRules
from sgat.models.training import train

EPOCHS = 3
SHORT = TrialRules(limit_s=1.0, start_spread_rad=0.01)
FLAT_TICKS = 40
TO_THE_LUMPS = TrialRules(limit_s=1.4, start_spread_rad=0.01)
"""What is learned of real begins after `FLAT_TICKS`, as if the lumps began there."""


@pytest.fixture
def in_this_process(monkeypatch):
    """Calls of `process_pool` are computed here: processes take seconds to start."""
    monkeypatch.setattr(
        processes, "ProcessPoolExecutor", lambda *_, **__: ThreadPoolExecutor(1)
    )


@pytest.fixture
def short_searches(monkeypatch):
    """See `shorten_searches`."""
    shorten_searches(monkeypatch)


@pytest.fixture
def short_walks(monkeypatch):
    """Walks of the NAO studies that end soon: where they lead to does not matter."""
    from experiments.grounded_walks.walks import walk, walk_in_sim

    def short_walk(place, robot, vectors, seed, exploration_rad=(0.0,), rules=SHORT):
        return walk(place, robot, vectors, seed, exploration_rad, rules)

    short = {
        "grounded_walks.walks.FLAT_TICKS": FLAT_TICKS,
        "grounded_walks.walks.ON_COURSE": TO_THE_LUMPS,
        "grounded_walks.walks.walk": short_walk,
        "grounded_walks.models.ON_COURSE": SHORT,
        "grounded_walks.models.WALK": SHORT,
        "transfer.nao_falls.walk": short_walk,
        "transfer.nao_falls.walk_in_sim": partial(walk_in_sim, rules=SHORT),
    }
    for name, value in short.items():
        monkeypatch.setattr(f"experiments.{name}", value)
    monkeypatch.setattr("sgat.models.scaled_network.train", train_little)


def train_little(outputs, stages, examples, weights, held_out, config, generator):
    """Train networks for a few epochs: what is learned does not matter."""
    little = replace(config, epochs=EPOCHS)
    return train(outputs, stages, examples, weights, held_out, little, generator)
