"""How much doctored recordings say: against sums written out."""

from dataclasses import replace

import numpy as np
import pytest
from made_up_data import ARM, CARRIAGE, GAINS, SWINGS, arm_recording, carriage_recording

from experiments.concealed.doctored.information import LASTS_S, nats_of
from experiments.concealed.doctored.labels import declare_gain, scale_torque
from experiments.concealed.doctored.parts import Parts

NOISE_N = 40.0


def shaken(seed):
    """A shaken carriage whose force is off, by chance, in each quarter second."""
    one = carriage_recording(10.0)
    blocks = round(10.0 / LASTS_S)
    off = np.random.default_rng(seed).normal(0, NOISE_N, blocks)
    force = one.columns["torque.carriage"] + np.repeat(off, one.ticks // blocks)
    return replace(one, columns={**one.columns, "torque.carriage": force})


def told(factor, parts):
    doctored = {
        name: scale_torque(one, "carriage", factor)
        for name, one in parts.recordings.items()
    }
    own = replace(parts, recordings=doctored)
    return nats_of((CARRIAGE, parts), (CARRIAGE, own), driven_by_torque=True)


def test_a_scale_shows_as_far_as_it_exceeds_what_nothing_explains():
    parts = Parts({"a": shaken(1)}, {"b": shaken(2)})
    force = parts.recordings["a"].columns["torque.carriage"]
    means = force.reshape(round(10.0 / LASTS_S), -1).mean(axis=1)
    wanted = 0.5 * np.sum((0.1 * means / NOISE_N) ** 2)
    assert told(1.1, parts) == pytest.approx(wanted, rel=0.25)
    assert told(1.2, parts) == pytest.approx(4 * told(1.1, parts), rel=1e-6)
    assert told(1.0, parts) == 0.0


def test_what_was_wrong_before_does_not_hide_it():
    """The reference shows a force in proportion to the speed; the noise stays small."""

    def rubbing(one):
        speed = np.gradient(one.columns["position.carriage"], one.time_s)
        force = one.columns["torque.carriage"] + 400 * speed
        return replace(one, columns={**one.columns, "torque.carriage": force})

    clean = Parts({"a": shaken(1)}, {"b": shaken(2)})
    rubs = Parts({"a": rubbing(shaken(1))}, {"b": rubbing(shaken(2))})
    new = Parts(rubs.recordings, clean.reference)
    assert told(1.1, rubs) == pytest.approx(told(1.1, clean), rel=0.3)
    assert told(1.1, new) < 0.5 * told(1.1, rubs)


def test_a_servo_tells_of_its_gain_by_its_torque():
    one, other = arm_recording(4.0, 0.0), arm_recording(4.0, 4.0)
    parts = Parts({"a": one}, {"b": other})
    nats = []
    for joint in SWINGS:
        own = replace(parts, recordings={"a": declare_gain(one, joint, 1.1)})
        nats.append(nats_of((ARM, parts), (ARM, own), driven_by_torque=False))
    assert min(nats) > 10
    torque = GAINS.kp * (one.columns["command.joint2"] - one.columns["position.joint2"])
    assert np.sqrt(np.mean(torque**2)) > 1.0
    same = nats_of((ARM, parts), (ARM, parts), driven_by_torque=False)
    assert same == 0.0


def test_what_differs_between_healthy_recordings_hides_it():
    """Forces of the healthy robot are off by 10 % or more to either side themselves."""

    def both(factor, reference):
        parts = Parts({"a": shaken(1)}, reference)
        case, again = (
            {n: scale_torque(one, "carriage", factor) for n, one in every.items()}
            for every in (parts.recordings, reference)
        )
        wrong = Parts(case, reference, again)
        return nats_of((CARRIAGE, parts), (CARRIAGE, wrong), driven_by_torque=True)

    steady = {"b": shaken(2), "c": shaken(3)}
    restless = {
        "b": scale_torque(shaken(2), "carriage", 1.1),
        "c": scale_torque(shaken(3), "carriage", 0.9),
    }
    # left out, each recording is off by a fifth from the other: half of 0.1 / 0.2
    # squared is the most that any noise lets show
    assert both(1.1, restless) < 0.5 * 0.5**2 * 1.2
    assert both(1.1, steady) > 20 * both(1.1, restless)
    assert both(2.0, restless) < 0.5 * 5.0**2 * 1.2


def test_a_joint_that_asked_for_nothing_in_one_recording_is_driven_all_the_same():
    one, other, rests = (arm_recording(4.0, start) for start in (0.0, 4.0, 8.0))
    still = np.zeros(rests.ticks)
    columns = {"position.joint2": still, "command.joint2": still}
    rests = replace(rests, columns={**rests.columns, **columns})
    parts = Parts({"a": one}, {"b": other, "c": rests})
    own = replace(parts, recordings={"a": declare_gain(one, "joint2", 1.5)})
    assert nats_of((ARM, parts), (ARM, own), driven_by_torque=False) > 0
