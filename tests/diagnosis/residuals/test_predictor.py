"""Residuals in units of noise, without what the integrator's step costs."""

from dataclasses import replace

import numpy as np
import pytest
from joint_rigs import ARM, arm_law, integrated, plant_of, ticks, trace_of
from made_up_traces import arm, arm_command, recorded

from diagnosis.effects.gears import Backlash, JointElasticity
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals import models_around
from diagnosis.residuals import predictor as predictor_module
from diagnosis.residuals.predictor import WORST, Channels, Predictor
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.residuals.replays import WARM_UP_S

NOISE_RAD = 4e-4
CHANNELS = Channels(("position.shoulder", "position.elbow"), np.full(2, NOISE_RAD))


def measured(kp, kd, noise_rad):
    """A recording of another library's integrator, and its plant."""
    plant = plant_of(ARM, kp=kp, kd=kd)
    time_s = ticks(2.5, 0.02)
    command = arm_command(time_s)
    law = arm_law(lambda t, q, v, k: kp * (command[k] - q) - kd * v)
    truth = integrated(law, time_s, [0, 0, 0, 0])[:, :2]
    noise = noise_rad * np.random.default_rng(5).standard_normal(truth.shape)
    return plant, trace_of(plant, time_s, truth + noise, command_rad=command)


@pytest.fixture(scope="module")
def pendulum():
    return measured(8.0, 0.2, NOISE_RAD)


def rms(predictor, model=()):
    residual = predictor.residuals([model])[0]
    return float(np.sqrt(np.mean(residual[predictor.scored] ** 2)))


def test_calibration_takes_out_what_the_step_costs():
    plant, trace = measured(8.0, 0.2, noise_rad=0.0)
    predictor = Predictor(plant, [trace], CHANNELS)
    assert rms(predictor) > 2
    assert predictor.calibrate().max() < 0.05
    assert rms(predictor) < 0.05


def test_what_the_step_costs_counts_beside_errors_of_the_healthy_robot():
    """Where these make the noise twice as large, the share left by steps is half."""
    plant, trace = measured(8.0, 0.2, noise_rad=0.0)
    known = replace(ReferenceNoise.known((), 2), scale=np.array([2.0, 1.0]))
    left = [Predictor(plant, [trace], CHANNELS, noise=one) for one in (None, known)]
    alone, beside = (one.correct() for one in left)
    assert beside[0] == pytest.approx(alone[0] / 2)
    assert beside[1] == pytest.approx(alone[1])
    assert alone.min() > 0


def test_another_step_is_of_the_same_traces():
    plant, trace = measured(8.0, 0.2, noise_rad=0.0)
    predictor = Predictor(plant, [trace], CHANNELS)
    finer = predictor.stepped(predictor.step_s / 4)
    assert finer.traces == predictor.traces
    assert rms(finer) == pytest.approx(rms(predictor) / 4, rel=0.1)


def test_steps_may_be_finer_in_some_traces():
    plant, trace = measured(8.0, 0.2, noise_rad=0.0)
    other = recorded(plant, duration_s=2.0, seed=1)
    predictor = Predictor(plant, [trace, other], CHANNELS, step_s=0.004)
    some = predictor.stepped(0.004, finer=[1, 2])
    assert some.steps_s == [0.004, 0.002]
    assert some.part(1, 2).steps_s == [0.002]
    coarse, mixed, fine = (
        one.residuals([()])[0] for one in (predictor, some, predictor.stepped(0.002))
    )
    second = predictor.trace == 1
    np.testing.assert_array_equal(mixed, np.where(second, fine, coarse))
    assert np.abs(mixed - fine).max() > 1


def test_of_a_right_model_only_noise_is_left():
    plant, trace = measured(8.0, 1.0, NOISE_RAD)
    predictor = Predictor(plant, [trace], CHANNELS)
    assert rms(predictor) > 1.5
    predictor.calibrate()
    assert rms(predictor) == pytest.approx(1, abs=0.15)


def test_the_noise_is_found_on_the_traces(pendulum):
    plant, trace = pendulum
    channels = Predictor(plant, [trace]).channels
    assert channels.names == CHANNELS.names
    np.testing.assert_allclose(channels.noise, NOISE_RAD, rtol=0.4)


def test_calibration_at_one_model_serves_others(pendulum):
    """The step's error hardly depends on the model."""
    plant, trace = pendulum
    near = (PlacedEffect("servo_gain", "elbow", (0.8,)),)
    here, there = (Predictor(plant, [trace], CHANNELS) for _ in range(2))
    here.calibrate(near)
    there.calibrate()
    here, there = here.nominal(), there.nominal()
    difference = (here.predict([near]) - there.predict([near])) / NOISE_RAD
    assert np.sqrt(np.mean(difference**2)) < 1
    assert np.sqrt(np.mean(difference**2)) > 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "values", "usual", "coarse"),
    [(JointElasticity, (800.0, 0.2), 0.15, 0.4), (Backlash, (0.03,), 5.0, 9.0)],
)
def test_springs_and_play_take_shorter_steps(kind, values, usual, coarse, monkeypatch):
    """What a joint without one needs would be half the noise off, or ten times it."""
    model = (PlacedEffect(kind.name, "elbow", values),)
    plant = arm()
    trace = recorded(plant, duration_s=2.0)
    truth = Predictor(plant, [trace], CHANNELS, step_s=2.5e-4)
    truth.correct(model)
    predictor = Predictor(plant, [trace], CHANNELS, step_s=0.004)
    predictor.correct()

    def wrong():
        found = predictor.predict([(), model])[1] - truth.predict([model])[0]
        return float(np.sqrt(np.mean((found[20:] / NOISE_RAD) ** 2)))

    assert wrong() < usual
    monkeypatch.setattr(kind, "finer", 1)
    assert wrong() > coarse


class Rough:
    """Replays whose values differ by the step, and at random for any change."""

    def __init__(self, rows):
        self.rows, self.count = rows, 0

    def values(self, models, step_s):
        self.count += len(models)
        return np.stack([self.one(model, step_s) for model in models])

    def one(self, model, step_s):
        seed = [round(1e6 * step_s), *(abs(round(1e6 * m.values[0])) for m in model)]
        random = np.random.default_rng(seed).standard_normal((self.rows, 2))
        return step_s + NOISE_RAD * random


RUBS = "coulomb_friction", "elbow"


@pytest.mark.parametrize("factor", [0.5, 1.0, 2.0])
def test_the_model_at_which_the_step_was_measured_is_no_better_than_those_near_it(
    factor, monkeypatch
):
    """Its random part was taken out of it; a fit stayed where it began."""
    monkeypatch.setattr(models_around, "NEARBY", factor * models_around.NEARBY)
    plant, trace = arm(), recorded(arm(), duration_s=20.0)

    def left(near):
        predictor = Predictor(plant, [trace], CHANNELS, step_s=0.004)
        predictor._replays = Rough(trace.rows)
        if not near:
            monkeypatch.setattr(
                predictor_module, "models_around", lambda plant, given: [given]
            )
        predictor.correct((PlacedEffect(*RUBS, (0.1,)),))
        tried = [(PlacedEffect(*RUBS, (0.1 + 1e-5 * k,)),) for k in range(20)]
        found = predictor.predict(tried)
        assert np.mean(found) == pytest.approx(0.0, abs=0.1 * NOISE_RAD)
        at, *others = np.sqrt(np.mean(found**2, axis=(1, 2)))
        return at / np.mean(others)

    assert left(near=True) == pytest.approx(1.0, abs=0.05)
    assert left(near=False) < 0.9


def test_where_nothing_rubs_the_step_is_measured_once():
    plant, trace = arm(), recorded(arm(), duration_s=2.0)
    predictor = Predictor(plant, [trace], CHANNELS, step_s=0.004)
    counts = []
    for model in ((), (PlacedEffect("servo_gain", "elbow", (0.9,)),), ()):
        predictor._replays = Rough(trace.rows)
        predictor.correct(model)
        counts.append(predictor._replays.count)
    predictor._replays = Rough(trace.rows)
    predictor.correct((PlacedEffect(*RUBS, (0.1,)),))
    assert counts == [3, 3, 3]
    assert predictor._replays.count == 12


def test_what_is_missing_or_early_is_not_scored(pendulum):
    plant, trace = pendulum
    position = trace.position_rad.copy()
    position[70:80, 1] = np.nan
    predictor = Predictor(plant, [replace(trace, position_rad=position)], CHANNELS)
    residual = predictor.residuals([()])[0].reshape(-1, 2)
    scored = predictor.scored.reshape(-1, 2)
    early = trace.time_s < WARM_UP_S
    assert not scored[early].any()
    assert not scored[70:80, 1].any()
    assert scored.sum() == 2 * np.sum(~early) - 10
    assert (residual[~scored] == 0).all()
    assert (residual[scored] != 0).all()


def test_rows_say_which_trace_and_channel_they_are_of():
    plant = arm()
    traces = [recorded(plant, duration_s=1.0), recorded(plant, duration_s=0.6, seed=1)]
    predictor = Predictor(plant, traces, CHANNELS)
    residual = predictor.residuals([()])[0]
    assert residual.shape == predictor.trace.shape == predictor.channel.shape
    for k, trace in enumerate(traces):
        alone = Predictor(plant, [trace], CHANNELS)
        for j in range(2):
            rows = (predictor.trace == k) & (predictor.channel == j)
            own = alone.residuals([()])[0][alone.channel == j]
            np.testing.assert_allclose(residual[rows], own, atol=1e-6)


def test_more_models_than_a_batch_holds():
    plant = arm()
    trace = recorded(plant, duration_s=0.5)
    predictor = Predictor(plant, [trace], CHANNELS, step_s=0.004)
    factors = np.linspace(0.8, 1.2, 400)
    models = [(PlacedEffect("servo_gain", "elbow", (float(f),)),) for f in factors]
    every = predictor.residuals(models)
    for row in (0, 191, 192, 399):
        alone = predictor.residuals([models[row]])[0]
        np.testing.assert_allclose(every[row], alone, atol=1e-6)


def test_what_blows_up_is_as_wrong_as_can_be(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # MuJoCo writes a log
    plant = arm()
    predictor = Predictor(plant, [recorded(plant, duration_s=1.0)], CHANNELS)
    wild = (PlacedEffect("servo_gain", "elbow", (1e9,)),)
    bad, good = predictor.residuals([wild, ()])
    assert np.abs(bad).max() == WORST
    assert np.isfinite(bad).all()
    assert np.abs(good).max() < 30


def test_gyroscopes_are_a_channel_if_all_traces_have_them():
    plant = arm()
    still = recorded(plant, duration_s=1.0)
    random = np.random.default_rng(2)
    turns = 0.1 + 0.01 * random.standard_normal((still.ticks, 3))
    trace = replace(still, gyroscope_rad_s=turns)
    predictor = Predictor(plant, [trace])
    assert predictor.channels.names[2:] == ("gyroscope.x", "gyroscope.y", "gyroscope.z")
    np.testing.assert_allclose(predictor.channels.noise[2:], 0.01, rtol=0.5)
    bias = (PlacedEffect("gyro_bias", "gyroscope", (0.1, 0.1, 0.1)),)
    without, with_bias = predictor.residuals([(), bias])
    rows = predictor.scored & (predictor.channel >= 2)
    assert np.mean(without[rows] ** 2) > 50
    assert np.mean(with_bias[rows] ** 2) < 3
    assert len(Predictor(plant, [trace, still]).channels.names) == 2


def test_residuals_are_the_same_in_parts(pendulum, monkeypatch):
    """One model at a time, to save memory."""
    plant, trace = pendulum
    predictor = Predictor(plant, [trace], CHANNELS)
    models = [(), (PlacedEffect("servo_gain", "elbow", (0.8,)),), ()]
    whole = predictor.residuals(models)
    asked = list[int]()
    predict = predictor.predict
    monkeypatch.setattr("diagnosis.residuals.predictor.MOST_ENTRIES", 1)
    monkeypatch.setattr(
        predictor, "predict", lambda some: asked.append(len(some)) or predict(some)
    )
    np.testing.assert_array_equal(predictor.residuals(models), whole)
    assert asked == [1, 1, 1]


def test_of_some_rows_residuals_are_those_of_all_rows(pendulum):
    """Commands of the rows between count in replays; the rows are not compared."""
    plant, trace = pendulum
    second = replace(trace, name="second")
    model = (PlacedEffect("viscous_friction", "elbow", (0.05,)),)
    whole = Predictor(plant, [trace, second], CHANNELS)
    some = [replace(one, every=3) for one in (trace, second)]
    part = Predictor(plant, some, CHANNELS)
    kept = np.zeros(2 * trace.ticks, bool)
    kept[: trace.ticks : 3] = kept[trace.ticks :: 3] = True
    own = np.repeat(kept, 2)
    assert 3 * own.sum() < len(own) + 12
    np.testing.assert_array_equal(
        part.residuals([model]), whole.residuals([model])[:, own]
    )
    for name in ("scored", "channel", "trace"):
        np.testing.assert_array_equal(getattr(part, name), getattr(whole, name)[own])
    np.testing.assert_array_equal(
        part.part(1, 2).residuals([model]),
        whole.part(1, 2).residuals([model])[:, own[2 * trace.ticks :]],
    )


def test_of_some_rows_only_noise_is_left_of_a_right_model(pendulum):
    plant, trace = pendulum
    jitter = replace(CHANNELS, own_jitter_s=1e-5, common_jitter_s=1e-5)
    predictor = Predictor(plant, [replace(trace, every=3)], jitter)
    predictor.calibrate()
    (left,) = predictor.residuals([()])
    assert 0.5 * left @ left == pytest.approx(predictor.noise_energy, rel=0.2)
    assert rms(predictor, (PlacedEffect("viscous_friction", "elbow", (0.5,)),)) > 3
