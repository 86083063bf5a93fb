import numpy as np
import pytest

from experiments.grounded_walks.models import GroundingStep
from experiments.grounded_walks.walks import (
    WALK,
    GroundedSim,
    random_dynamics,
    rate_in_sim,
    rate_randomised,
    walk_in_sim,
)
from groundwalk.errors import UnknownNameError
from sgat.walks.gait_cloud import GaitCloud
from walk_engine import gaits

SEED = np.random.SeedSequence(4)


def vectors(*speeds_m_s):
    start = gaits.get("start")
    return np.stack([start.replace(max_forward=v).to_vector() for v in speeds_m_s])


@pytest.mark.slow
def test_in_the_plain_sim_a_faster_gait_earns_more():
    slow, fast = rate_in_sim(GroundedSim(), 1, WALK, vectors(0.1, 0.2), SEED)
    # cm/s of a walk that starts from rest, without a fall
    assert slow == pytest.approx(10, abs=1.5)
    assert fast == pytest.approx(18.5, abs=2.5)


@pytest.mark.slow
def test_equal_gaits_get_equal_random_numbers():
    first, second = rate_randomised(2, vectors(0.15, 0.15), np.random.SeedSequence(4))
    assert first == second
    again = rate_randomised(2, vectors(0.15), np.random.SeedSequence(5))
    assert again[0] != first


def test_dynamics_are_drawn_within_their_ranges():
    rng = np.random.default_rng(1)
    options = [random_dynamics(rng) for _ in range(200)]
    latencies = np.array([o.latency_s for o in options])
    frictions = np.array([o.friction for o in options])
    assert latencies.min() >= 0
    assert latencies.max() <= 0.06
    assert latencies.std() == pytest.approx(0.06 / np.sqrt(12), rel=0.2)
    assert frictions.min() >= 0.4
    assert frictions.max() <= 1.0


def test_an_unknown_grounding_is_refused_before_anything_walks():
    step = GroundingStep(gaits.get("start"), GaitCloud(), (2, 2), SEED)
    with pytest.raises(UnknownNameError, match="did you mean 'sgat'"):
        step.rater("SGATT", 1)
    assert "records" not in vars(step)


@pytest.mark.parametrize("fails", [False, True])
def test_worlds_are_closed_after_a_walk_and_after_an_error(monkeypatch, fails):
    closed = []

    class Inside:
        def close(self):
            closed.append(True)

    def walked(*_):
        if fails:
            raise RuntimeError

    name = "experiments.grounded_walks.walks."
    monkeypatch.setattr(name + "world_at", lambda *_: Inside())
    monkeypatch.setattr(name + "walk_trials", walked)
    if fails:
        with pytest.raises(RuntimeError):
            walk_in_sim(GroundedSim(), vectors(0.1), 1, SEED)
    else:
        walk_in_sim(GroundedSim(), vectors(0.1), 1, SEED)
    assert closed == [True]
