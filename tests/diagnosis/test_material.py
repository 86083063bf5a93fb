"""What is prepared before anything is diagnosed: ranges, wrong samples, free joints."""

from dataclasses import replace

import numpy as np
import pytest
from joint_rigs import servo_of
from made_up_traces import GAINS, arm, arm_command, recorded

from diagnosis.material import Material
from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo
from diagnosis.residuals.predictor import Predictor
from diagnosis.traces.windows import runs_of


def with_range(low, high):
    """The arm, whose model has a range at the elbow."""
    plant = arm()
    spec = plant.spec.copy()
    spec.joint("elbow").limited, spec.joint("elbow").range = 1, np.degrees([low, high])
    return replace(plant, spec=spec)


def error(material):
    """Largest difference of position and replay [noise]."""
    predictor = Predictor(material.plant, material.traces, material.channels)
    predictor.calibrate()
    return float(np.abs(predictor.residuals([()])).max())


def test_a_range_that_the_recording_contradicts_is_lifted():
    trace = recorded(arm())
    narrow = Material.of(with_range(-0.2, 0.2), [trace], None, "servos")
    assert error(narrow) < 6
    assert any("without that range" in text for text in narrow.audited.limits)
    wide = Material.of(with_range(-2.0, 2.0), [trace], None, "servos")
    assert wide.plant.model.jnt_limited[1]
    assert not narrow.plant.model.jnt_limited[1]


def test_wrong_samples_are_left_out_and_said():
    trace = recorded(arm())
    position = trace.position_rad.copy()
    position[[80, 140], 1] = 0.9
    spoilt = Material.of(arm(), [replace(trace, position_rad=position)], None, "servos")
    assert error(spoilt) < 6
    assert any("2 values jump away" in text for text in spoilt.limits)
    assert Material.of(arm(), [trace], None, "servos").limits == ()


@pytest.fixture(scope="module")
def half_driven():
    """The arm with a servo at the shoulder only."""
    full = arm()
    kp, kd = np.array([GAINS["kp"], 0.0]), np.array([GAINS["kd"], 0.02])
    servo = Servo(kp, kd, *(np.array(a) for a in ([np.inf] * 2, [0.0] * 2)))
    return Plant("half", full.spec, full.joints, servo)


def test_a_joint_without_motor_is_replayed_in_windows(half_driven):
    trace = replace(recorded(half_driven), servo=half_driven.servo)
    command = np.where([True, False], arm_command(trace.time_s), np.nan)
    material = Material.of(
        half_driven, [replace(trace, command_rad=command)], None, "servos"
    )
    assert error(material) < 8
    assert len(runs_of(material.plant, material.traces[0])) > 4
    assert len(runs_of(arm(), recorded(arm()))) == 1
    assert any("taken as passive" in text for text in material.audited.limits)


def test_torques_drive_a_joint_beside_servos(half_driven):
    trace = recorded(arm())
    torque = np.tile([7.0, 0.3], (trace.ticks, 1))
    driven = replace(trace, servo=half_driven.servo, command_torque_nm=torque)
    (ready,) = Material.of(half_driven, [driven], None, "servos").traces
    np.testing.assert_array_equal(ready.added_nm, torque * [0, 1])
    (as_it_is,) = Material.of(
        arm(), [replace(driven, servo=servo_of(2, 40, 2))], None, "servos"
    ).traces
    assert as_it_is.added_nm is None
