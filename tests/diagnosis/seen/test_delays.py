from dataclasses import replace

import known_losses
import numpy as np
import pytest
import torque_arm
from scipy.interpolate import CubicSpline

from diagnosis.seen import delays, look
from diagnosis.seen.delays import delay_of
from diagnosis.seen.pieces import pieces_of

TICK_S = known_losses.TICK_S


def late(delay_s, noise_rad=0.0, **options):
    """A recording whose positions follow held commands exactly, but later."""
    trace = known_losses.moved(**options)
    held = trace.time_s + TICK_S / 2  # a command counts from the middle of its tick
    courses = (CubicSpline(trace.time_s, one) for one in trace.position_rad.T)
    command = np.stack([course(held + delay_s) for course in courses], axis=1)
    noise = np.random.default_rng(1).standard_normal(command.shape)
    position = trace.position_rad + noise_rad * noise
    whole = replace(trace, command_rad=command, position_rad=position)
    return replace(whole.part(0, trace.ticks - 20), part_of="", name=trace.name)


def delay(traces, joint=0):
    pieces, names = pieces_of(traces)
    return delay_of(traces, pieces, names, joint)


@pytest.mark.parametrize("noise_rad", [0.0, 1e-3])
@pytest.mark.parametrize("delay_s", [0.0, 0.013, 0.0302, 0.075])
def test_a_delay_is_known_to_a_tenth_of_a_tick(delay_s, noise_rad):
    for joint in range(3):
        found = delay([late(delay_s, noise_rad)], joint)
        assert found.middle_s == pytest.approx(delay_s, abs=0.1 * TICK_S)
        assert found.low_s <= found.middle_s <= found.high_s


def test_uneven_times_and_gaps_do_not_matter():
    trace = late(0.03)
    keep = np.ones(trace.ticks, bool)
    keep[300::7] = False
    keep[600:603] = False
    some = {
        name: getattr(trace, name)[keep]
        for name in ("time_s", "position_rad", "command_rad", "torque_nm")
    }
    assert delay([replace(trace, **some)]).middle_s == pytest.approx(0.03, abs=2e-3)


def test_delays_of_recordings_have_a_spread():
    traces = [late(d, seed=k) for k, d in enumerate((0.02, 0.03, 0.04))]
    found = delay(traces)
    assert list(found.pieces_s) == ["arm 0", "arm 1", "arm 2"]
    assert found.middle_s == pytest.approx(0.03, abs=1e-3)
    assert (found.low_s, found.high_s) == pytest.approx((0.022, 0.038), abs=1e-3)


def test_a_motion_that_follows_nothing_has_no_delay():
    trace = late(0.02)
    other = late(0.02, seed=9).command_rad
    assert delay([replace(trace, command_rad=other)]) is None
    assert delay([replace(trace, command_rad=None)]) is None
    resting = replace(trace, position_rad=np.zeros_like(trace.position_rad))
    assert delay([resting]) is None


def test_it_is_said_if_there_is_no_delay():
    trace = replace(late(0.02), command_rad=late(0.02, seed=9).command_rad)
    joint = look(torque_arm.arm(), [trace]).joints[0]
    assert joint.delay is None
    assert any("does not follow" in text for text in joint.unknown)


SHARES = "ALIKE", "MOST"
CONSTANTS = ("LONGEST_S", "SHORTEST_S", "FEWEST_ROWS", "EDGE", "ALIKE", "MOST", "MOVED")


@pytest.mark.parametrize("name", CONSTANTS)
@pytest.mark.parametrize("factor", [0.5, 2])
def test_a_factor_of_two_in_a_constant_does_not_matter(monkeypatch, name, factor):
    """What follows is known as well, and what follows nothing has no delay."""
    value = type(getattr(delays, name))(getattr(delays, name) * factor)
    # a correlation, or a share, is 1 at most
    monkeypatch.setattr(delays, name, min(value, 0.9) if name in SHARES else value)
    trace = late(0.0302, 1e-3, duration_s=20.0)
    assert delay([trace]).middle_s == pytest.approx(0.0302, abs=0.1 * TICK_S)
    other = late(0.02, seed=9, duration_s=20.0).command_rad
    found = delay([replace(trace, command_rad=other)])
    assert found is None or found.high_s - found.low_s > 2 * TICK_S
