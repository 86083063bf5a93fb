"""A diagnosis reports its stages, and goes on from where it was interrupted."""

from dataclasses import replace

import numpy as np
import pytest
from known_arms import SINGLE, measured
from made_up_traces import arm
from swinger_rig import moved, swinger

from diagnosis.pipeline import diagnose
from diagnosis.residuals.channels import shared_channels
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.search.hooks import Hooks
from diagnosis.search.reference import learn_reference, reference_checks
from diagnosis.search.result import pack_noise, unpack_noise


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


def told(plant, traces, store):
    reports = Reports()
    seed = np.random.SeedSequence(3)
    hooks = Hooks(reports, store)
    verdict = diagnose(plant, traces, seed, SINGLE, hooks=hooks).verdict
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


def test_what_was_learned_from_a_reference_is_not_learned_again():
    plant, before = swinger(), [moved(seed, duration_s=1.5) for seed in range(2)]
    channels, store = shared_channels(plant, before), Store()

    def learned():
        reports = Reports()
        hooks = Hooks(reports, store)
        noise = learn_reference(plant, before, channels, hooks=hooks)
        checks = reference_checks(plant, before, channels, noise, hooks=hooks)
        residuals = [check.residuals([()])[0] for check in checks]
        return reports, pack_noise(noise), np.concatenate(residuals)

    first, noise, residual = learned()
    assert len(store.kept) == 3  # the noise, and that of each half
    again, same, same_residual = learned()
    assert same.plain == noise.plain
    assert all((same.arrays[k] == noise.arrays[k]).all() for k in noise.arrays)
    np.testing.assert_array_equal(same_residual, residual)
    assert again.steps < first.steps
    assert all(name.startswith("reference") for name in again.stages)


def test_a_part_that_comes_again_is_stored_apart():
    """Else it would be given what the same part had found before."""
    store = Store()
    hooks = Hooks(checkpoint=store)
    noises = [ReferenceNoise.known((), count) for count in (1, 2)]
    found = [
        hooks.within("reference").saved(lambda one=one: one, pack_noise, unpack_noise)
        for one in noises
    ]
    assert [len(one.scale) for one in found] == [1, 2]
    assert len(store.kept) == 2
