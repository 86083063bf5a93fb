"""A diagnosis reports its stages, and goes on from where it was interrupted."""

from dataclasses import replace

import numpy as np
import pytest
from known_arms import SINGLE, measured
from made_up_traces import arm
from swinger_rig import moved, swinger

from diagnosis.pipeline import diagnose
from diagnosis.search.hooks import Hooks


class Reports:
    """Notes the stages, and how many replays they took."""

    def __init__(self):
        self.stages, self.seconds, self.steps = [], None, 0

    def cost(self, seconds):
        self.seconds = seconds

    def stage(self, name, steps):
        self.stages.append(name)

    def advance(self, steps=1):
        self.steps += steps


class Store:
    """Keeps results, and is interrupted when it has a number of them."""

    def __init__(self, most=1000):
        self.most, self.kept = most, {}

    def load(self, key):
        return self.kept.get(key)

    def save(self, key, saved):
        self.kept[key] = saved
        if len(self.kept) == self.most:
            raise KeyboardInterrupt


def weak_arms(first):
    return [
        replace(
            measured(seed, gain=(1.0, 0.8), duration_s=1.5), name=f"recording {seed}"
        )
        for seed in range(first, first + 3)
    ]


def told(plant, traces, store, reference=()):
    reports = Reports()
    seed = np.random.SeedSequence(3)
    hooks = Hooks(reports, store)
    verdict = diagnose(
        plant, traces, seed, SINGLE, reference=reference, hooks=hooks
    ).verdict
    return reports, replace(verdict, seconds=0.0)


@pytest.mark.slow
def test_a_diagnosis_goes_on_after_a_round_to_the_same_verdict():
    traces = weak_arms(0)
    reports, whole = told(arm(), traces, Store())
    assert reports.stages[:3] == ["audit", "fit", "search round 1"]
    assert reports.stages[-2:] == ["comparison", "test"]
    assert reports.seconds > 0
    store = Store(most=2)
    with pytest.raises(KeyboardInterrupt):
        told(arm(), traces, store)
    assert len(store.kept) == 2
    store.most = 1000
    again, resumed = told(arm(), traces, store)
    assert resumed.to_json() == whole.to_json()
    assert again.steps < reports.steps
    assert again.stages == reports.stages


@pytest.mark.slow
def test_what_was_learned_from_a_reference_is_not_learned_again():
    before = [moved(seed, duration_s=1.5) for seed in range(2)]
    now = [moved(seed, gain=(1.0, 0.8), duration_s=1.5) for seed in range(10, 12)]
    store = Store()
    reports, whole = told(swinger(), now, store, before)
    learned = {key: one for key, one in store.kept.items() if "reference" in key}
    assert len(learned) == 3  # the noise, and that of each half
    resumed = Store()
    resumed.kept.update(learned)
    again, verdict = told(swinger(), now, resumed, before)
    assert verdict.to_json() == whole.to_json()
    assert again.steps < reports.steps
    assert any(name.startswith("reference") for name in again.stages)
