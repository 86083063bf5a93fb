import numpy as np
import pytest
from pulsed_sled import PULSE_N, PULSES_S, pulse_n, recorded, sled, stepping

from diagnosis.effects.variants import Variants
from diagnosis.replay.replay import replay
from diagnosis.residuals.channels import shared_channels
from diagnosis.traces.pulses import pulses_of, without_pulses
from diagnosis.traces.windows import Run


@pytest.mark.parametrize(
    ("place", "source", "felt"),
    [
        ("actuator", "actuator input", 1.0),
        ("torque sensor", "torque sensor", 0.0),
        ("encoder", "position sensor", 0.0),
    ],
)
def test_pulses_are_found_where_they_came_in(place, source, felt):
    pulses = pulses_of(sled(), recorded(place))
    assert [pulse.source for pulse in pulses] == [source] * len(PULSES_S)
    for pulse, (start_s, end_s) in zip(pulses, PULSES_S, strict=True):
        assert (pulse.joint, pulse.recording, pulse.unit) == ("slide", "made up", "N")
        assert pulse.start_s == pytest.approx(start_s, abs=0.004)
        assert pulse.end_s == pytest.approx(end_s, abs=0.004)
        assert pulse.torque == pytest.approx(PULSE_N, rel=0.05)
        assert pulse.felt == pytest.approx(felt, abs=0.1)


@pytest.mark.parametrize(
    "trace",
    [
        pytest.param(recorded(), id="nothing"),
        pytest.param(recorded("carriage"), id="a push at the body"),
        pytest.param(recorded(kp=1600.0), id="a weak servo"),
        pytest.param(
            recorded(late_s=0.04, command=stepping), id="late steps of the command"
        ),
    ],
)
def test_what_is_no_pulse_is_none(trace):
    assert pulses_of(sled(), trace) == ()


def test_without_a_measured_torque_nothing_can_be_said():
    trace = recorded("actuator")
    assert pulses_of(sled(), type(trace)(**{**vars(trace), "torque_nm": None})) == ()


def test_pulses_at_the_actuator_drive_a_replay():
    plant, trace = sled(), recorded("actuator")
    known = without_pulses(plant, trace, pulses_of(plant, trace))
    np.testing.assert_allclose(
        trace.torque_nm - known.torque_nm, pulse_n(trace.time_s)[:, None], atol=0.2
    )
    left = {}
    for name, each in (("as it is", trace), ("known", known)):
        variants = Variants(plant, 1)
        variants.joints.coulomb_nm[:], variants.field("dof_damping")[:] = 1.0, 3.0
        (replayed,) = replay([Run.of(each)], variants)
        wrong = replayed.position_rad[0] - trace.position_rad
        left[name] = float(np.sqrt(np.mean(wrong**2)))
    assert left["as it is"] > 1e-3
    assert left["known"] < 2e-4


@pytest.mark.parametrize(
    ("place", "missing"),
    [("torque sensor", "torque_nm"), ("encoder", "position_rad")],
)
def test_what_a_sensor_made_up_is_missing(place, missing):
    plant, trace = sled(), recorded(place)
    known = without_pulses(plant, trace, pulses_of(plant, trace))
    is_pulse = pulse_n(trace.time_s) > 0
    lost = np.isnan(getattr(known, missing)[:, 0])
    assert (lost == is_pulse).mean() > 0.99
    assert not known.added_nm.any()


def test_torques_are_trusted_as_far_as_motors_are_known():
    trace = recorded()
    noise = shared_channels(sled(), [trace]).noise[1]
    # the sensor's own noise is 0.02 N
    assert noise == pytest.approx(0.02 * np.sqrt(np.mean(trace.torque_nm**2)))


def test_a_trace_without_pulses_stays_as_it_is():
    trace = recorded()
    assert without_pulses(sled(), trace, ()) is trace
