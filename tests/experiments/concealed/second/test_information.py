"""The information on an effect, against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest

from experiments.concealed.second.information import LASTS_S, Teller
from experiments.concealed.size_by_information import KEPT
from worlds.hidden import Hidden, hidden_plant
from worlds.hidden.recorded import HiddenSensors
from worlds.hidden.run import Clock, Run

ROWS, HZ, SIGMA = 1000, 100.0, 1e-3
PLANT = hidden_plant("pendulum")
SENSORS = HiddenSensors(quantum_rad=0.0, encoder_rad=SIGMA, torque_share=0.01)
TORQUE_SIGMA = 0.01 * 4.0  # N m


def run(angle=0.0, torque=0.0, ok=True):
    """Rows of constant or given angles and torques."""
    clock = Clock(0.001, np.arange(ROWS) * 10, 0)
    table = np.zeros((ROWS, 1))
    angles, torques = (
        table + np.reshape(angle, (-1, 1)),
        table + np.reshape(torque, (-1, 1)),
    )
    return Run(clock, table, angles, angles, torques, {}, ok)


def teller(**other):
    one = Teller(PLANT, SENSORS, np.array([0.05]), HZ, HZ, 0.0, False)
    return replace(one, **other)


def test_white_noise_gives_half_the_squared_difference():
    runs = [run(0.002)] * 4
    told = teller().nats([run()] * 4, runs, ())
    assert told == pytest.approx(KEPT * 0.5 * ROWS * 4)
    assert teller().nats([run()], [run(ok=False)], ()) == math.inf


def test_the_median_of_the_recordings_counts():
    runs = [run(0.1), run(), run(0.001), run(0.001)]
    assert teller().nats([run()] * 4, runs, ()) == pytest.approx(KEPT * 0.5 * ROWS)


def test_rows_that_are_not_simulated_count_as_well():
    fewer = teller(trial_hz=HZ, rate_hz=4 * HZ)
    once = teller().nats([run()], [run(0.002)], ())
    assert fewer.nats([run()], [run(0.002)], ()) == pytest.approx(4 * once)


def test_small_mismatch_counts_as_few_independent_errors():
    """As many as there are stretches of twice its time."""
    small = teller().beside([run()], [run(0.5)])
    told = small.nats([run()], [run(1.0)], ())
    stretches = ROWS / HZ / (2 * LASTS_S)
    assert told == pytest.approx(KEPT * 0.5 * stretches * 4, rel=1e-3)


def test_jitter_is_noise_where_the_joint_moves():
    time_s = np.arange(ROWS) / HZ
    jittery = teller(jitter_s=SIGMA)  # at 1 rad/s as much as the encoder's noise
    told = jittery.nats([run(time_s)], [run(time_s + 0.002)], ())
    assert told == pytest.approx(KEPT * 0.5 * ROWS * 4 / 2)


def test_torque_that_nothing_explains_tells_as_much_as_its_noise_allows():
    exact = replace(SENSORS, encoder_rad=0.0)
    one = teller(torques=True, sensors=exact)
    noise = np.random.default_rng(0).standard_normal(ROWS)
    told = one.nats([run()], [run(torque=TORQUE_SIGMA * noise)], ())
    assert told == pytest.approx(KEPT * 0.5 * ROWS, rel=0.1)


def test_torque_that_the_motion_explains_tells_nothing():
    """I q'' = torque for a robot that is nothing but inertia."""
    time_s = np.arange(ROWS) / HZ
    wave = 2 * np.pi * 1.0
    angle = 0.1 * np.sin(wave * time_s)
    exact = replace(SENSORS, encoder_rad=0.0)
    one = teller(torques=True, sensors=exact)
    own = run(angle, -0.05 * wave**2 * angle)
    unexplained = run(0.0, -0.05 * wave**2 * angle)
    assert one.nats([run()], [own], ()) < 0.03 * one.nats([run()], [unexplained], ())


def test_wrong_readings_count_as_they_are_written_down():
    outliers = Hidden.parse("encoder_outliers@swing:rate=2,jump=0.01")
    told = teller().nats([run()], [run()], [outliers])
    count = 2 * ROWS / HZ
    assert told == pytest.approx(KEPT * 0.5 * count * 100, rel=0.6)
