"""What servos ask for, against MuJoCo's own simulation of other servos."""

from dataclasses import replace

import numpy as np
import pytest
from rough_arm import KD, KP, declaring, followed, hurried, stiff_arm

from diagnosis.effects.parts import PlacedEffect
from diagnosis.replay.asked import (
    LATE_S,
    AskedTorques,
    by_servos,
    centred,
    late_commands_known,
)
from diagnosis.replay.inverse import NeededTorques
from diagnosis.residuals.replays import variants_of
from diagnosis.residuals.torques.torque_evidence import with_motions


@pytest.fixture(scope="module")
def trace():
    return followed(duration_s=6.0, friction_nm=(0.0, 0.0, 0.0))


def missed(trace, *model):
    """Rms [N m] of asked less predicted torque where joints move, per joint."""
    plant, asked = stiff_arm(), by_servos(trace)
    (ready,) = with_motions(plant, [replace(trace, torque_nm=asked)], 0.05)
    variants = variants_of(plant, [model])
    needed = NeededTorques(plant, [ready]).of(variants)
    (predicted,) = AskedTorques([ready]).of(needed, variants)
    counts = ready.motion.counts
    left = np.where(counts, asked - predicted, 0.0)
    rows = np.arange(0, len(left), 5)
    moved = np.add.reduceat(counts, rows, axis=0)
    means = np.add.reduceat(left, rows, axis=0) / np.maximum(moved, 1)
    squares = np.where(moved == 5, means**2, 0.0)
    return np.sqrt(squares.sum(axis=0) / (moved == 5).sum(axis=0))


def test_declared_servos_ask_for_what_the_motion_needs(trace):
    assert (missed(trace) < 0.15).all()


def test_a_wrong_gain_is_undone_by_its_effect(trace):
    wrong = declaring(trace, "shoulder", 1.4)
    assert missed(wrong)[1] > 1.0
    assert missed(wrong, PlacedEffect("servo_gain", "shoulder", (1 / 1.4,)))[1] < 0.25


def test_late_commands_are_undone_by_their_effect(trace):
    wrong = hurried(trace, 4)
    assert (missed(wrong) > 1.0).all()
    late = PlacedEffect("command_latency", "commands", (0.04,))
    assert (missed(wrong, late) < 0.3).all()


def test_servos_pull_and_damp_by_their_law():
    time_s = np.arange(50) * 0.01
    trace = followed(duration_s=0.5)
    still = np.full((50, 3), 0.2)
    held = replace(trace, time_s=time_s, position_rad=still, command_rad=still + 0.01)
    np.testing.assert_allclose(by_servos(held), 0.01 * KP, rtol=1e-9)
    turning = still + 0.5 * time_s[:, None]
    followed_well = replace(held, position_rad=turning, command_rad=turning)
    # the command holds until the next row: on average it is half a tick behind
    lag = KP * 0.5 * 0.005
    inner = by_servos(followed_well)[2:-2]
    np.testing.assert_allclose(inner, -lag - KD * 0.5, rtol=1e-6)


def test_commands_hold_until_the_next_row():
    time_s = np.arange(5) * 0.1
    trace = replace(followed(duration_s=0.05), time_s=time_s)
    ramp = replace(trace, command_rad=np.tile(time_s[:, None], (1, 3)))
    np.testing.assert_allclose(centred(ramp)[1:, 0], time_s[1:] - 0.05)
    np.testing.assert_allclose(centred(ramp, 0.1)[2:, 0], time_s[2:] - 0.15)


def test_a_part_knows_the_commands_before_it(trace):
    part = trace.part(200, 400)
    for delay_s in (0.0, 0.07):
        whole = centred(trace, delay_s)[200:400]
        np.testing.assert_allclose(centred(part, delay_s)[:-1], whole[:-1])
    assert late_commands_known(part).all()
    # of a whole recording nothing before the first row is known
    early = trace.time_s < trace.time_s[0] + LATE_S - 1e-9
    assert early.any()
    np.testing.assert_array_equal(late_commands_known(trace), ~early)
    alone = replace(part, before=None)
    assert not late_commands_known(alone)[0]
    assert np.ptp(centred(alone, 0.07)[:5], axis=0).max() == 0
