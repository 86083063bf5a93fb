from dataclasses import replace

import numpy as np
import pytest
from pulsed_sled import recorded, sled

from diagnosis.effects.variants import Variants
from diagnosis.replay.replay import replay
from diagnosis.traces.pulses import pulses_of, without_pulses
from diagnosis.traces.trace import driven_by_torques
from diagnosis.traces.windows import runs_of
from groundwalk.errors import BadRecordingError


def test_measured_torques_drive_the_joint_and_pulses_are_part_of_them():
    plant, trace = sled(), recorded("actuator")
    known = without_pulses(plant, trace, pulses_of(plant, trace))
    driven = driven_by_torques(known)
    assert driven.unheld
    assert driven.added_nm is None
    np.testing.assert_allclose(driven.torque_nm, trace.torque_nm, atol=1e-12)
    variants = Variants(plant, 2)
    variants.joints.coulomb_nm[1], variants.field("dof_damping")[1] = 1.0, 3.0
    runs = runs_of(plant, driven)
    wrong = np.zeros(2)
    for run, replayed in zip(runs, replay(runs, variants), strict=True):
        error = replayed.position_rad - run.trace.position_rad
        wrong = np.maximum(wrong, np.abs(error).max(axis=(1, 2)))
    # half a second of 1 N on 2 kg, held back by nothing
    assert wrong[0] > 0.01
    assert wrong[1] < 0.3 * wrong[0]


def test_without_a_measured_torque_nothing_can_drive():
    with pytest.raises(BadRecordingError, match="no torque was measured"):
        driven_by_torques(replace(recorded(), torque_nm=None))
