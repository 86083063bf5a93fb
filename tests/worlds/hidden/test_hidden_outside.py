"""Effects outside the first sets' library, each against a closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest

from groundwalk.errors import BadValueError
from worlds.hidden.commands import PathLine
from worlds.hidden.effects import KINDS, Hidden
from worlds.hidden.effects.flexible_links import across
from worlds.hidden.effects.presliding import ELEMENTS, MaxwellSlip
from worlds.hidden.engine import check_engine
from worlds.hidden.limbs import limb_plant
from worlds.hidden.mujoco_engine import HiddenMujoco, hidden_model
from worlds.hidden.plant import hidden_plant
from worlds.hidden.recorded import HiddenSensors, Log, hidden_recording
from worlds.hidden.run import Clock, run_hidden
from worlds.recordings.metadata import RecordingMetadata

STEP_S = 0.00025
WEIGHT_NM = 0.5 * 9.81 * 0.3  # of the pendulum, held level
KP = 8.0


def run(effects, commands, rate_hz=100, plant=None, engine="mujoco"):
    """A robot, a pendulum by default, that follows commands (rows, j) at a rate."""
    ticks = np.arange(len(commands)) * round(1 / rate_hz / STEP_S)
    clock, nobody = Clock(STEP_S, ticks, 0), np.random.SeedSequence(0)
    feed = lambda row, sense: commands[row]  # noqa: E731
    plant = plant or hidden_plant("pendulum")
    hidden = [Hidden.parse(text) for text in effects]
    return run_hidden(plant, hidden, engine, clock, feed, commands[0], nobody)


def held(angle, rows):
    return np.full((rows, 1), angle)


# Controllers


def test_an_integral_term_leaves_no_error_under_a_load():
    plain = run([], held(1.2, 500)).position_rad[-1, 0]
    sag = WEIGHT_NM / KP * math.sin(plain)
    assert 1.2 - plain == pytest.approx(sag, rel=1e-3)
    integral = run(["integral_term@swing:time=1"], held(1.2, 1500))
    assert integral.position_rad[-1, 0] == pytest.approx(1.2, abs=1e-4)


def test_an_integral_term_grows_with_error_over_time():
    from worlds.hidden.servos import Servos

    servos = Servos(hidden_plant("pendulum"), 0.001)
    KINDS["integral_term"].change_servos(servos, 0, {"time": 0.5})
    target, position = np.array([0.1]), np.array([0.0])
    for _ in range(200):
        now = servos.controlled(target, position)
    # e + int e dt / T after 0.2 s
    assert now[0] == pytest.approx(0.1 * (1 + 0.2 / 0.5))
    for _ in range(20000):
        now = servos.controlled(target, position)
    assert now[0] == pytest.approx(0.1 + 4.0 / KP)  # the servo's largest torque


def test_a_dead_band_gives_no_torque_inside_and_all_of_it_outside():
    from worlds.hidden.servos import Servos

    servos = Servos(hidden_plant("pendulum"), 0.001)
    KINDS["dead_band"].change_servos(servos, 0, {"width": 0.02})
    for error, wanted in ((0.019, 0.0), (-0.019, 0.0), (0.021, 0.021), (-0.1, -0.1)):
        position = np.array([0.3])
        target = servos.controlled(position + error, position)
        assert target - position == pytest.approx(wanted, abs=1e-12)


def test_a_hanging_pendulum_rests_anywhere_in_the_dead_band():
    far = run(["dead_band@swing:width=0.2"], held(0.15, 600)).position_rad[-1, 0]
    assert far == pytest.approx(0.0, abs=1e-3)  # only gravity acts
    near = run([], held(0.15, 600)).position_rad[-1, 0]
    assert near == pytest.approx(0.15 - WEIGHT_NM / KP * math.sin(near), abs=1e-4)


@pytest.mark.parametrize("share", [0.0, 0.4, 1.0])
def test_damping_of_errors_lets_a_steady_motion_lag_less(share):
    """Across gravity, at a steady speed v, the error is kd (1 - share) v / kp."""
    plant, speed, rows = limb_plant("two_dof"), 0.4, 1500
    path = np.zeros((rows, 2))
    path[:, 1] = speed * np.arange(rows) / 1000
    effects = [f"error_derivative@J2:share={share}"] if share else []
    found = run(effects, path, 1000, plant).position_rad[-1, 1]
    # a command that holds for a tick is half a tick behind the path on average
    behind = path[-1, 1] - 0.5 * speed / 1000 - found
    lag_s = plant.kd_nm_s_rad[1] / plant.kp_nm_rad[1]
    assert behind == pytest.approx((1 - share) * lag_s * speed, abs=2e-5)


def test_a_step_of_the_target_gives_the_impulse_of_its_damping():
    from worlds.hidden.servos import Servos

    bare = hidden_plant("pendulum")
    plant = replace(bare, kd_nm_s_rad=np.array([0.8]))
    for step_s in (0.0005, 0.005):
        servos = Servos(plant, step_s)
        KINDS["error_derivative"].change_servos(servos, 0, {"share": 0.5})
        position = np.array([0.2])
        assert servos.controlled(np.zeros(1), position) == pytest.approx([0.0])
        steps = round(0.5 / step_s)
        leads = [servos.controlled(np.array([0.1]), position) for _ in range(steps)]
        impulse = KP * np.sum(np.array(leads) - 0.1) * step_s
        assert impulse == pytest.approx(0.5 * 0.8 * 0.1)
        assert leads[0] > leads[1] > 0.1


def test_only_servos_with_damping_can_damp_errors():
    kind = KINDS["error_derivative"]
    assert kind.possible(hidden_plant("pendulum"))
    nao = hidden_plant("nao")  # all is back-EMF
    assert not kind.possible(nao)
    still = np.zeros((2, len(nao.joints)))
    with pytest.raises(BadValueError, match="no damping of its own"):
        run(["error_derivative@LKneePitch:share=0.5"], still, plant=nao)


# Readings


def test_a_ripple_is_in_the_reading_and_the_servo_follows_it():
    amplitude, per_turn, phase = 0.01, 8.0, 0.7
    text = f"position_ripple@swing:amplitude={amplitude},per_turn=8,phase={phase}"
    found = run([text], held(0.5, 600))
    true = found.position_rad[-1, 0]
    read = true + amplitude * math.sin(per_turn * true + phase)
    assert found.encoder_rad[-1, 0] == pytest.approx(read, abs=1e-9)
    assert KP * (0.5 - read) == pytest.approx(WEIGHT_NM * math.sin(true), rel=1e-3)


def recorded(found, effects, rng, plant=None, log=None):
    plant = plant or hidden_plant("pendulum")
    metadata = RecordingMetadata("made up", "fixed", "test")
    sensors = HiddenSensors(quantum_rad=0.0, encoder_rad=0.0, torque_share=0.0)
    hidden = [Hidden.parse(text) for text in effects]
    return hidden_recording(plant, found, hidden, sensors, rng, metadata, log)


def test_outliers_are_as_many_and_as_large_as_stated():
    found = run([], held(0.5, 4000), rate_hz=1000)
    text = "encoder_outliers@swing:rate=25,jump=0.3"
    rng = np.random.default_rng(1)
    jumps = recorded(found, [text], rng).columns["position.swing"]
    jumps = jumps - found.encoder_rad[:, 0]
    hit = np.abs(jumps) > 1e-9
    assert np.abs(jumps[hit]) == pytest.approx(0.3)
    wanted = 25 * 4.0
    assert abs(hit.sum() - wanted) < 4 * math.sqrt(wanted)
    assert 0.3 < (jumps[hit] > 0).mean() < 0.7


@pytest.mark.parametrize("engine", ["mujoco", "bullet"])
def test_one_joint_is_read_late_and_the_others_are_not(engine):
    plant = limb_plant("two_dof")
    time_s = np.arange(1000) / 1000
    commands = np.stack([0.4 * np.sin(3 * time_s), 0.3 * np.sin(2 * time_s)], axis=1)
    found = run(["late_reading@J2:delay=0.035"], commands, 1000, plant, engine)
    still = run([], commands, 1000, plant, engine)
    assert found.position_rad == pytest.approx(still.position_rad, abs=1e-12)
    now = np.interp(time_s - 0.035, time_s, still.position_rad[:, 1])
    assert np.abs(still.position_rad[40:, 1] - now[40:]).max() > 0.01
    assert found.encoder_rad[40:, 1] == pytest.approx(now[40:], abs=1e-6)
    assert (found.encoder_rad[:, 0] == still.encoder_rad[:, 0]).all()


# Friction


def slid(slip, angles):
    return np.array([-slip.torque(0.0, float(angle), 0.0, 0.0) for angle in angles])


def virgin(torque, reach, x):
    """Torque of n springs of one stiffness that slip one after the other."""
    most = reach * np.arange(1, ELEMENTS + 1) / ELEMENTS
    stiffness = 2 * torque / (reach * (ELEMENTS + 1))
    return stiffness * np.minimum(np.abs(x)[:, None], most).sum(axis=1) * np.sign(x)


def test_presliding_starts_as_its_springs_together_and_ends_as_dry_friction():
    x = np.linspace(0.0, 0.08, 400)
    torque = slid(MaxwellSlip(0.3, 0.05), x)
    assert torque == pytest.approx(virgin(0.3, 0.05, x), abs=1e-12)
    assert torque[x > 0.05] == pytest.approx(0.3)
    # n springs in parallel at first: k n = 2 T n / (reach (n + 1))
    first = 2 * 0.3 * ELEMENTS / (0.05 * (ELEMENTS + 1))
    assert torque[1] / x[1] == pytest.approx(first)


def test_after_a_turn_the_branch_is_twice_the_first_curve():
    """Masing's rule: F = F_turn - 2 virgin((x_turn - x) / 2)."""
    up, down = np.linspace(0.0, 0.03, 200), np.linspace(0.03, -0.03, 400)
    slip = MaxwellSlip(0.3, 0.05)
    top = slid(slip, up)[-1]
    wanted = top - 2 * virgin(0.3, 0.05, (0.03 - down) / 2)
    assert slid(slip, down) == pytest.approx(wanted, abs=1e-12)


# Links

STIFFNESS = 40.0


def bent():
    """The two_dof arm, whose second link bends, and its engine."""
    plant = limb_plant("two_dof")
    link = plant.links[1]
    text = f"link_flexibility@{link}:stiffness={STIFFNESS},damping=0"
    model = hidden_model(plant, [Hidden.parse(text)], STEP_S, None)
    return plant, link, model, HiddenMujoco(plant, model)


def test_a_link_swings_sideways_at_the_frequency_of_its_spring():
    import mujoco

    _, link, model, _ = bent()
    model.opt.gravity[:] = 0.0
    data = mujoco.MjData(model)
    hinge = model.joint(f"{link} bends")
    mass, bends = np.zeros((model.nv, model.nv)), int(hinge.dofadr[0])
    data.qpos[int(hinge.qposadr[0])] = 0.001
    mujoco.mj_forward(model, data)
    mujoco.mj_fullM(model, data, mass)
    signs = []
    others = [i for i in range(model.nv) if i != bends]
    for _ in range(8000):
        data.qvel[others] = 0.0  # all other joints are held
        mujoco.mj_step(model, data)
        signs.append(data.qpos[int(hinge.qposadr[0])] > 0)
    ups = np.flatnonzero(np.diff(np.array(signs, int)) == 1)
    period_s = np.diff(ups).mean() * STEP_S
    wanted = 2 * math.pi * math.sqrt(mass[bends, bends] / STIFFNESS)
    assert period_s == pytest.approx(wanted, rel=0.01)


def test_a_bent_link_leaves_the_joints_in_their_order():
    plant, _, model, engine = bent()
    pose = np.array([0.3, -0.2])
    engine.reset(pose, 0.0)
    assert model.njnt == 3
    assert engine.position_rad == pytest.approx(pose)
    engine.step(np.array([1.0, 0.0]))
    own = engine.velocity_rad_s
    assert own[0] > 0.0 > own[1]  # the second link stays behind
    assert len(engine.position_rad) == len(plant.joints) == 2


def test_a_link_bends_across_its_joint_and_its_own_way():
    axis, way = np.array([0.0, 0.0, 1.0]), np.array([0.2, 0.0, 0.1])
    assert np.abs(across(axis, way)) == pytest.approx([0.0, 1.0, 0.0])
    along = np.array(across(axis, np.array([0.0, 0.0, 0.4])))
    assert along @ axis == 0.0
    assert along @ along == pytest.approx(1.0)


# All of them


def test_there_are_the_kinds_that_set_2_promises():
    found = {name for name, kind in KINDS.items() if kind.outside and kind.since == 2}
    assert found == {
        "integral_term",
        "dead_band",
        "position_ripple",
        "encoder_outliers",
        "late_reading",
        "presliding",
        "link_flexibility",
    }


def test_bullet_cannot_bend_links():
    text = "link_flexibility@link:stiffness=10,damping=0"
    with pytest.raises(BadValueError, match="mujoco"):
        check_engine("bullet", [Hidden.parse(text)], floating=True)


# Torques as they are written down


def test_a_log_of_torques_tells_no_command_and_holds_the_motor_s_torque():
    found = run(["viscous_friction@swing:coefficient=0.2"], held(0.9, 500))
    log = Log(rate_hz=99.0, torques=True, torque_gain=np.array([1.1]))
    written = recorded(found, [], np.random.default_rng(0), log=log)
    assert sorted(written.columns) == ["position.swing", "time", "torque.swing"]
    angle = found.position_rad[-1, 0]
    torque = written.columns["torque.swing"][-1]
    assert torque == pytest.approx(1.1 * WEIGHT_NM * math.sin(angle), rel=1e-3)
    assert written.columns["time"][-1] == pytest.approx(499 / 99)


def test_a_path_leads_to_each_command_within_a_tick():
    line = PathLine(np.array([1.0]))
    assert line.over(0) == [(1.0, 1.0)]
    line.send(10, np.array([3.0]))  # ten steps after the beginning
    ((_, first),), ((_, fifth),) = line.over(10), line.over(14)
    assert first == pytest.approx(1.0 + 2.0 * 0.05)
    assert fifth == pytest.approx(1.0 + 2.0 * 0.45)
    line.send(20, np.array([3.0]))
    assert [line.over(step) for step in (29, 99)] == [[(1.0, 3.0)]] * 2


@pytest.mark.parametrize("paths", [True, False])
def test_on_paths_the_sampled_torque_is_what_the_motion_needs(paths):
    """With a step at each tick the last torque before the next tells another tale."""
    plant, hz = limb_plant("two_dof"), 250
    time_s = np.arange(500) / hz
    sines = np.stack([0.4 * np.sin(4 * time_s), 0.3 * np.sin(6 * time_s)], axis=1)
    ticks = np.arange(500) * round(1 / hz / STEP_S)
    clock, nobody = Clock(STEP_S, ticks, 0), np.random.SeedSequence(0)
    feed = lambda row, sense: sines[row]  # noqa: E731
    found = run_hidden(plant, [], "mujoco", clock, feed, sines[0], nobody, paths)
    needed = inverse(plant, found.position_rad, time_s)
    off = np.abs(needed - found.torque_nm)[100:-100].max()
    usual = np.abs(needed).max()
    assert off < 0.01 * usual if paths else off > 0.1 * usual


def inverse(plant, angles, time_s):
    """Torques (rows, j) that MuJoCo's inverse dynamics find for a motion."""
    import mujoco

    model = plant.make_spec().compile()
    data, torques = mujoco.MjData(model), np.zeros_like(angles)
    speed = np.gradient(angles, time_s, axis=0)
    for row, change in enumerate(np.gradient(speed, time_s, axis=0)):
        data.qpos[:], data.qvel[:], data.qacc[:] = angles[row], speed[row], change
        mujoco.mj_inverse(model, data)
        torques[row] = data.qfrc_inverse
    return torques


def test_some_ticks_of_a_run_are_each_nth_with_the_recording_s_first():
    whole = run([], held(0.9, 100))
    later = Clock(STEP_S, whole.clock.ticks, 7)
    some = replace(whole, clock=later).every(4)
    assert some.clock.ticks[some.clock.first] == later.ticks[7]
    assert (np.diff(some.clock.ticks) == 4 * 40).all()
    assert some.clock.first == 1
    assert (some.position_rad == whole.position_rad[3::4]).all()
