import json
from dataclasses import replace

import joint_rigs
import known_losses
import made_up_traces
import mujoco
import numpy as np
import pytest
import torque_arm

from diagnosis.effects.parts import PlacedEffect
from diagnosis.seen import look

DRY, VISCOUS = 1.5, 0.4
ELBOW = 2


def rubbing(q, v, needed):
    return DRY * np.sign(v) + VISCOUS * v


def curve(joint, kind, way="both"):
    (found,) = (c for c in joint.curves if (c.kind, c.way) == (kind, way))
    return found


def misses(found, law, slack):
    """How many bins' bands, a little wider, do not hold a law of the bins' place."""
    wanted = law(np.array(found.at))
    low, high = np.array(found.low), np.array(found.high)
    return int(((wanted < low - slack) | (wanted > high + slack)).sum())


@pytest.fixture(scope="module")
def rubbed():
    return look(torque_arm.arm(), known_losses.recordings(rubbing))


@pytest.fixture(scope="module")
def clean():
    return look(torque_arm.arm(), known_losses.recordings())


def test_friction_is_seen_over_speed(rubbed):
    for joint in rubbed.joints:
        found = curve(joint, "speed")
        assert len(found.at) >= 12
        assert misses(found, lambda v: DRY * np.sign(v) + VISCOUS * v, 0.05) == 0
        assert misses(found, lambda v: 0.8 * DRY * np.sign(v), 0.05) > 6
        assert (joint.source, joint.torque_unit) == ("measured", "N m")
        assert found.law is None


def test_nothing_missing_shows_nothing(clean):
    for joint in clean.joints:
        assert joint.loss_rms < 0.03
        assert misses(curve(joint, "speed"), lambda v: 0 * v, 0.01) == 0
        assert joint.together < 0.1
        assert all(share.alone < 0.1 for share in joint.shares)
        assert joint.noise_share is None or joint.noise_share > 0.7


def test_a_simulated_arm_shows_its_friction():
    """MuJoCo's friction, with noise of encoders and torques."""
    change = torque_arm.rubbing(DRY, VISCOUS)
    traces = [torque_arm.moved(change, seed) for seed in range(3)]
    for joint in look(torque_arm.arm(), traces).joints:
        found = curve(joint, "speed")
        assert misses(found, lambda v: DRY * np.sign(v) + VISCOUS * v, 0.1) <= 1


def test_a_spring_is_seen_over_position():
    found = look(
        torque_arm.arm(), known_losses.recordings(lambda q, v, needed: 2 * (q - 0.1))
    )
    for way in ("forward", "backward"):
        of = curve(found.joints[ELBOW], "position", way)
        assert misses(of, lambda q: 2 * (q - 0.1), 0.05) == 0
        assert misses(of, lambda q: 2 * (q + 0.3), 0.05) == len(of.at)


def test_ripple_is_seen_over_position():
    def ripple(q):
        return 0.5 * np.sin(8 * q)

    traces = known_losses.recordings(lambda q, v, needed: ripple(q))
    of = curve(look(torque_arm.arm(), traces).joints[ELBOW], "position", "forward")
    assert np.corrcoef(of.middle, ripple(np.array(of.at)))[0, 1] > 0.97


def test_friction_by_load_opens_over_the_load():
    traces = known_losses.recordings(
        lambda q, v, needed: 0.2 * np.abs(needed) * np.sign(v)
    )
    joint = look(torque_arm.arm(), traces).joints[ELBOW]
    for way, sign in (("forward", 1), ("backward", -1)):
        of = curve(joint, "load", way)
        assert misses(of, lambda u, sign=sign: sign * 0.2 * np.abs(u), 0.15) <= 1
        assert misses(of, lambda u, sign=sign: -sign * 0.2 * np.abs(u), 0.15) > 5


def test_a_joint_that_winds_up_needs_travel_after_a_turn():
    """Maxwell's element: a spring that slips at a torque."""
    slips_rad = 0.05

    def wound(q, v, needed):
        torque, bent = np.zeros_like(q), np.zeros(3)
        for row in range(1, len(q)):
            bent = np.clip(bent + q[row] - q[row - 1], -slips_rad, slips_rad)
            torque[row] = DRY * bent / slips_rad
        return torque

    joint = look(torque_arm.arm(), known_losses.recordings(wound)).joints[0]
    of = curve(joint, "turn", "forward")
    at = np.array(of.at)
    law = DRY * np.clip(at / slips_rad - 1, -1, 1)
    near = at < 0.2
    assert near.sum() > 4
    np.testing.assert_allclose(np.array(of.middle)[near], law[near], atol=0.4)
    assert of.middle[0] < -0.5


def test_the_law_of_effects_lies_in_the_same_bins():
    model = (PlacedEffect("coulomb_friction", "elbow", (DRY,)),)
    found = look(torque_arm.arm(), known_losses.recordings(rubbing), model)
    law = curve(found.joints[ELBOW], "speed")
    np.testing.assert_allclose(law.law, DRY * np.sign(law.at), rtol=0.01)
    assert curve(found.joints[0], "speed").law is None


def test_an_effect_of_one_recording_is_drawn_from_it_only():
    traces = known_losses.recordings(rubbing)
    effect = PlacedEffect("coulomb_friction", "elbow", (DRY,), "arm 1")
    law = curve(look(torque_arm.arm(), traces, (effect,)).joints[ELBOW], "speed").law
    np.testing.assert_allclose(law, 0, atol=1e-6)


def test_a_single_recording_is_divided_into_blocks():
    found = look(torque_arm.arm(), [known_losses.moved(rubbing, duration_s=20)])
    assert (found.by, len(found.pieces)) == ("blocks", 6)
    assert found.pieces[0] == "arm 0, part 1"
    assert found.joints[0].together > 0.9


def test_servos_and_commands_tell_the_torque():
    plant = made_up_traces.arm()
    effects = ("coulomb_friction", "elbow", 0.3)
    traces = [
        made_up_traces.recorded(plant, effects, seed=seed, noise_rad=1e-5, tick_s=0.01)
        for seed in range(3)
    ]
    shoulder, elbow = look(plant, traces).joints
    assert elbow.source == "servo"
    assert elbow.stiffness == made_up_traces.GAINS["kp"]
    assert misses(curve(elbow, "speed"), lambda v: 0.3 * np.sign(v), 0.05) <= 2
    assert shoulder.loss_rms < 0.1 * elbow.loss_rms
    assert elbow.delay is not None


def test_back_emf_is_no_loss():
    plant = joint_rigs.plant_of(joint_rigs.PENDULUM, kp=20.0, emf=0.5)
    time_s = joint_rigs.ticks(12.0)
    command = joint_rigs.smooth_command(time_s)
    trace = joint_rigs.trace_of(plant, time_s, command_rad=command)
    run = joint_rigs.run_from(trace)
    position = joint_rigs.exact(plant, run)
    (joint,) = look(plant, [replace(trace, position_rad=position)]).joints
    assert joint.source == "servo"
    assert joint.loss_rms < 0.02 * 0.5 * np.std(np.gradient(position[:, 0], time_s))


def test_what_is_not_known_is_said():
    trace = replace(known_losses.moved(), torque_nm=None)
    found = look(torque_arm.arm(), [trace])
    assert found.cutoff_hz is None
    for joint in found.joints:
        assert (joint.source, joint.curves, joint.shares) == ("unknown", (), ())
        assert joint.loss_rms is None
        assert "Neither its torque nor" in joint.unknown[0]
        assert "No position commands" in joint.unknown[1]


def test_nothing_drives_a_passive_joint():
    """Its friction is what slows it down."""
    plant = joint_rigs.plant_of(joint_rigs.PENDULUM)
    rubbing_nm_s = 0.02

    def law(t, y, k):
        pull = -joint_rigs.PENDULUM_LEVER_NM * np.sin(y[0]) - rubbing_nm_s * y[1]
        return [y[1], pull / joint_rigs.INERTIA]

    time_s = joint_rigs.ticks(6.0)
    position = joint_rigs.integrated(law, time_s, (1.0, 0.0))[:, 0]
    still = joint_rigs.trace_of(plant, time_s, position, torque_nm=0.0)
    (joint,) = look(plant, [still]).joints
    assert joint.source == "passive"
    found = curve(joint, "speed")
    wanted = rubbing_nm_s * np.array(found.at)
    np.testing.assert_allclose(found.middle, wanted, atol=0.1 * np.abs(wanted).max())
    assert {one.name for one in joint.shares}.isdisjoint({"load", "acceleration"})
    assert max(joint.shares, key=lambda one: one.alone).name == "speed"
    assert {one.kind for one in joint.curves} == {"speed", "position", "turn"}
    driven = replace(still, command_rad=still.position_rad)
    assert look(plant, [driven]).joints[0].source == "unknown"


def test_a_free_base_hides_the_torque_that_motion_needs():
    plant = replace(torque_arm.arm(), base="floating")
    joint = look(plant, [known_losses.moved()]).joints[0]
    assert "base is free" in joint.unknown[0]
    assert joint.loss_rms is None


def test_a_joint_that_rests_shows_nothing():
    trace = known_losses.moved()
    position = trace.position_rad.copy()
    position[:, 1] = 0.3
    joint = look(torque_arm.arm(), [replace(trace, position_rad=position)]).joints[1]
    assert "hardly moves" in joint.unknown[0]
    assert joint.curves == ()


def test_a_coupling_is_said():
    xml = torque_arm.XML.replace(
        "<actuator>",
        '<equality><joint joint1="yaw" joint2="shoulder"/></equality><actuator>',
    )
    plant = replace(torque_arm.arm(), spec=mujoco.MjSpec.from_string(xml))
    said = [
        any("couples it" in text for text in joint.unknown)
        for joint in look(plant, [known_losses.moved()]).joints
    ]
    assert said == [True, True, False]


def test_gaps_and_wrong_samples_change_little(rubbed):
    traces = known_losses.recordings(rubbing)
    torque = traces[0].torque_nm.copy()
    position = traces[0].position_rad.copy()
    torque[100:130, ELBOW], position[500:505] = np.nan, np.nan
    position[700, ELBOW] += 2.0
    traces[0] = replace(traces[0], torque_nm=torque, position_rad=position)
    joint = look(torque_arm.arm(), traces).joints[ELBOW]
    assert joint.loss_rms == pytest.approx(rubbed.joints[ELBOW].loss_rms, rel=0.05)


def test_the_same_recordings_show_the_same_as_json(rubbed):
    again = look(torque_arm.arm(), known_losses.recordings(rubbing))
    assert again.to_json() == rubbed.to_json()
    plain = json.loads(rubbed.to_json())
    assert plain["joints"][0]["curves"][0]["over_unit"] == "rad/s"
    assert "NaN" not in rubbed.to_json()
