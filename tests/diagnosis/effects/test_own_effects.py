"""A limit, a vector and a force of a user's own are searched for like built-in ones."""

import contextvars
import threading

import numpy as np
import pytest
from known_arms import CHANNELS, NOISE_RAD, SINGLE
from made_up_traces import arm, recorded

from diagnosis.effects import (
    Effect,
    EffectWords,
    Parameter,
    PlacedEffect,
    TorqueEffect,
    all_effects,
    also_known,
    effect,
)
from diagnosis.effects.variants import Push
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.judging import Judge
from diagnosis.search.search import Search
from diagnosis.verdict import Estimate, Found
from experiments.diagnosis_report.findings import finding

PLANT = arm()
BRAKE_NM_S = 2.0


class SpeedBrake(TorqueEffect):
    """A brake that grips above a speed of the joint."""

    name = "speed_brake"
    threshold = True
    words = EffectWords(
        "speed brake", "a brake grips {joint} above {speed} {lacking}", "It grips."
    )

    def parameters(self, plant, place):
        return (Parameter("speed", "rad/s", 0.05, 20.0, np.inf, 1.0, True),)

    def torque_nm(self, values, position_rad, velocity_rad_s, time_s):
        limit = values[..., 0]
        beyond = np.maximum(np.abs(velocity_rad_s) - limit, 0.0)
        return np.where(limit > 0, -BRAKE_NM_S * np.sign(velocity_rad_s) * beyond, 0.0)


class OtherGravity(Effect):
    """Gravity of another planet."""

    name, place_kind, native, components = "other_gravity", "world", True, 3

    def places(self, plant, traces):
        return ("world",)

    def parameters(self, plant, place):
        return tuple(Parameter(axis, "m/s^2", -5.0, 5.0, 0.0, 0.3) for axis in "xyz")

    def apply(self, copies, row, place, values):
        copies.field("opt.gravity")[row] += values


class Wind(Effect):
    """A wind that pushes all bodies for some time."""

    name, place_kind, native, components, timed = "wind", "world", False, 3, True

    def places(self, plant, traces):
        return ("world",)

    def parameters(self, plant, place):
        return (
            *(Parameter(axis, "N", -20.0, 20.0, 0.0, 1.0) for axis in "xyz"),
            Parameter("start", "s", -2.0, 600.0, 0.0, 0.2),
            Parameter("duration", "s", 0.0, 600.0, 0.0, 0.2),
        )

    def apply(self, copies, row, place, values):
        force, (start_s, duration_s) = tuple(values[:3]), values[3:]
        for body in ("upper", "lower"):
            if duration_s > 0 and any(force):
                push = Push(body, force, start_s, duration_s)
                copies.outside.pushes[row].append(push)


OWN = SpeedBrake(), OtherGravity(), Wind()


def searched(*truth):
    """The best model for two recordings of an arm with an effect (name, place, ...)."""
    predictors = []
    for seed in range(2):
        trace = recorded(PLANT, truth, duration_s=2.0, seed=seed, noise_rad=NOISE_RAD)
        predictors.append(Predictor(PLANT, [trace], CHANNELS, step_s=0.004))
        predictors[-1].calibrate()
    return Search(Judge(*predictors, SINGLE)).run().winner.model


@pytest.mark.slow
@pytest.mark.parametrize(
    ("truth", "rel"),
    [
        (("speed_brake", "elbow", 0.6), 0.05),
        (("other_gravity", "world", 0.6, 0.0, 0.9), 0.1),
        (("wind", "world", 4.0, 0.0, 0.0, 1.1, 0.7), 0.1),
    ],
)
def test_effects_of_ones_own_are_found_with_their_values(truth, rel):
    name, place, *values = truth
    with also_known(*OWN):
        found = {placed.key: placed for placed in searched(*truth)}
    placed = found[f"{name}@{place}"]
    seen = [i for i, value in enumerate(values) if value]  # nothing moves along y
    assert [placed.values[i] for i in seen] == pytest.approx(
        [values[i] for i in seen], rel=rel
    )


def test_they_get_the_tries_and_sizes_of_their_kind():
    with also_known(*OWN):
        kinds = all_effects()
        wind = kinds["wind"].first_tries(PLANT, "world", None)
        gravity = kinds["other_gravity"].first_tries(PLANT, "world", None)
        brake = PlacedEffect("speed_brake", "elbow", (1.0,))
        sizes = kinds["speed_brake"].sizes_to_scan(PLANT, brake, [])
        assert kinds["speed_brake"].stretched(PLANT, brake, 2.0) == brake
        blown = PlacedEffect("wind", "world", (1.0, 0.0, 0.0, 1.0, 0.5))
        assert kinds["wind"].acted(blown, 0.0, 9.0).kind == "burst"
    assert wind[0][:3] == (1.0, 0.0, 0.0)
    assert len(wind) == len(gravity) == 3
    assert gravity[2] == (0.0, 0.0, 0.3)
    assert len(sizes) == 7
    assert sizes[0].values == (0.6,)


def test_reports_have_words_for_them():
    value = Estimate(0.6, 0.5, 0.7, "rad/s")
    with also_known(*OWN):
        own = finding(Found("speed_brake", "elbow", {"speed": value}, 0.9))
        made = finding(Found("wind", "world", {}, 0.9))
    assert own.startswith("a brake grips the joint elbow above about 0.60 rad/s (0.50")
    assert made == "the robot has wind that the sim lacks"


def test_a_torque_of_ones_own_acts_where_it_was_put_and_nowhere_else():
    """With a gap beside it, and in a motor that no servo drives, it is the same one."""
    with also_known(*OWN):
        brake = ("speed_brake", "elbow", 0.3)
        gap = ("backlash", "shoulder", 0.02)
        kwargs = {"duration_s": 1.0, "noise_rad": 0.0}
        free, braked, both, loose = (
            recorded(PLANT, *some, **kwargs).position_rad
            for some in ((), (brake,), (brake, gap), (gap,))
        )
    assert np.abs(braked - free)[:, 1].max() > 0.01
    assert np.abs(both - loose)[:, 1].max() > 0.01


def test_other_threads_know_them_only_in_a_copy_of_the_context():
    seen = {}

    def look(key):
        seen[key] = "wind" in all_effects()

    with also_known(*OWN):
        context = contextvars.copy_context()
        for thread in (
            threading.Thread(target=look, args=("bare",)),
            threading.Thread(target=context.run, args=(look, "copied")),
        ):
            thread.start()
            thread.join()
        assert effect("wind").timed
    assert seen == {"bare": False, "copied": True}
