"""A pendulum with hidden physics in both engines, against its equation of motion."""

import functools
import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from groundwalk.errors import BadValueError, UnknownNameError
from worlds.hidden.effects import KINDS, Hidden
from worlds.hidden.limbs import limb_plant
from worlds.hidden.plant import hidden_plant
from worlds.hidden.run import Clock, run_hidden
from worlds.hidden.servos import Servos

M, L, OWN, G = 0.5, 0.3, 0.002, 9.81
KP, KD = 8.0, 0.2
STEP_S, TICK_S, ROWS = 0.00025, 0.01, 101
NOBODY = np.random.SeedSequence(0)
JOINT, LINK = "swing", "link"


def command(time_s):
    return 0.3 + 0.25 * np.sin(2 * np.pi * 0.7 * time_s) * np.minimum(time_s, 1.0)


def jumps(time_s):
    """So far apart that a servo with little torque gives all of it."""
    return 0.3 + 0.9 * np.sign(np.sin(2 * np.pi * 1.9 * time_s))


def clock(step_s=STEP_S):
    return Clock(step_s, np.arange(ROWS) * round(TICK_S / step_s), 0)


def run(*effects, engine="mujoco", step_s=STEP_S, start=0.3, table=None):
    plant = hidden_plant("pendulum")
    asked = command(np.arange(ROWS) * TICK_S) if table is None else table
    return run_hidden(
        plant,
        effects,
        engine,
        clock(step_s),
        lambda row, sense: asked[row : row + 1],
        np.array([start]),
        NOBODY,
    )


@functools.cache
def solved(
    *, mass=0.0, z=0.0, armature=0.0, more=0.0, viscous=0.0, kp=KP, kd=KD,
    spring=(0.0, 0.0), pitch=0.0, drag=0.0, delay=0.0, push=0.0, fade=0.0,
    most=np.inf, start=0.3, asking=command,
):  # fmt: skip
    """Positions at the ticks by the equation of motion of a driven pendulum."""
    reach = L - z
    inertia = OWN + (M + mass) * reach**2 + armature + more
    asked = asking(np.arange(ROWS) * TICK_S)

    def motion(t, state):
        q, v = state
        row = int((t - delay) / TICK_S + 1e-9)
        target = start if t < delay - 1e-12 else asked[min(row, ROWS - 1)]
        servo = np.clip(kp * (1 - fade * t) * (target - q) - kd * v, -most, most)
        # positive angles about y swing the pendulum to -x
        weight = -(M + mass) * G * reach * np.sin(q + pitch)
        outside = -push * reach * np.cos(q) - drag * reach**2 * v
        pull = -viscous * v - spring[0] * (q - spring[1])
        return [v, (servo + weight + outside + pull) / inertia]

    edges = np.arange(ROWS) * TICK_S
    state, out = np.array([start, 0.0]), [start]
    for a, b in itertools.pairwise(edges):
        for low, high in _parts(a, b, delay):
            span = (low, high - 1e-12)
            state = solve_ivp(motion, span, state, rtol=1e-7, atol=1e-9).y[:, -1]
        out.append(state[0])
    return np.array(out)


def _parts(a, b, delay):
    """A tick's span, cut where the late command arrives."""
    cut = a + delay % TICK_S
    return [(a, b)] if delay == 0 else [(a, cut), (cut, b)]


def rms_mrad(a, b):
    return 1e3 * float(np.sqrt(np.mean((a - b) ** 2)))


PUSH = {"x": 0.4, "y": 0.0, "z": 0.0, "start": 0.0, "duration": 9.0}
CALM = Hidden("viscous_friction", JOINT, {"coefficient": 0.6})
SMOOTH = [
    ([], {}),
    ([Hidden("viscous_friction", JOINT, {"coefficient": 0.05})], {"viscous": 0.05}),
    ([Hidden("servo_gain", JOINT, {"factor": 0.8})], {"kp": 0.8 * KP}),
    ([Hidden("servo_damping", JOINT, {"factor": 1.3})], {"kd": 1.3 * KD}),
    ([Hidden("armature", JOINT, {"inertia": 0.02})], {"armature": 0.02}),
    ([Hidden("payload_mass", LINK, {"mass": 0.1})], {"mass": 0.1}),
    ([Hidden("payload_mass", LINK, {"mass": -0.1})], {"mass": -0.1}),
    ([Hidden("link_inertia", LINK, {"factor": 6.0})], {"more": 5 * OWN}),
    ([Hidden("com_offset", LINK, {"x": 0, "y": 0, "z": 0.03})], {"z": 0.03}),
    (
        [Hidden("joint_spring", JOINT, {"stiffness": 0.5, "rest": -0.2})],
        {"spring": (0.5, -0.2)},
    ),
    ([Hidden("ground_slope", "world", {"pitch": 0.1, "roll": 0})], {"pitch": 0.1}),
    ([Hidden("drag", LINK, {"coefficient": 0.8})], {"drag": 0.8}),
    ([Hidden("command_latency", "commands", {"delay": 0.01313})], {"delay": 0.01313}),
    ([Hidden("servo_fade", JOINT, {"rate": 0.2})], {"fade": 0.2}),
    ([Hidden("torque_limit", JOINT, {"torque": 0.6})], {"most": 0.6}),
    (
        [Hidden("external_force", LINK, PUSH)],
        {"push": 0.4},
    ),
]  # fmt: skip


@pytest.mark.parametrize("engine", ["mujoco", "bullet"])
@pytest.mark.parametrize(("effects", "changes"), SMOOTH)
def test_an_effect_moves_the_pendulum_as_its_equation_says(effects, changes, engine):
    if engine == "bullet" and "armature" in changes:
        pytest.skip("Bullet has no armature")
    found = run(*effects, engine=engine).position_rad[:, 0]
    assert rms_mrad(found, solved(**changes)) < 0.05
    if changes:
        assert rms_mrad(found, solved()) > 1.0


@pytest.mark.parametrize("engine", ["mujoco", "bullet"])
@pytest.mark.parametrize("delay", [0.0, 0.00813])
def test_a_servo_at_its_limit_reverses_when_a_command_arrives(delay, engine):
    """Half a step too early or too late, it would be off by 0.1 to 0.3 mrad."""
    effects = [Hidden("torque_limit", JOINT, {"torque": 2.5})]
    if delay:
        effects.append(Hidden("command_latency", "commands", {"delay": delay}))
    table = jumps(np.arange(ROWS) * TICK_S)
    found = run(*effects, engine=engine, table=table).position_rad[:, 0]
    assert rms_mrad(found, solved(most=2.5, delay=delay, asking=jumps)) < 0.03
    if delay:
        late = solved(most=2.5, delay=delay + STEP_S / 2, asking=jumps)
        assert rms_mrad(found, late) > 0.1


@pytest.mark.parametrize("engine", ["mujoco", "bullet"])
def test_fast_links_turn_each_other_as_in_much_shorter_steps(engine):
    plant = limb_plant("z1")
    middle_rad, rows = plant.range_rad.mean(axis=1), 60
    turns = 0.4 * np.sign(np.sin(np.outer(np.arange(rows), 0.3 + 0.1 * np.arange(6))))
    table = middle_rad + turns

    def positions(step_s):
        ticks = Clock(step_s, np.arange(rows) * round(TICK_S / step_s), 0)
        return run_hidden(
            plant, (), engine, ticks, lambda row, _: table[row], table[0], NOBODY
        ).position_rad

    found = positions(STEP_S)
    assert np.abs(np.diff(found, axis=0)).max() / TICK_S > 4  # rad/s
    assert rms_mrad(found, positions(STEP_S / 4)) < 0.1


def test_both_engines_agree_with_nothing_hidden():
    one, other = (run(engine=engine).position_rad for engine in ("mujoco", "bullet"))
    assert rms_mrad(one, other) < 1e-6


def test_half_the_step_changes_far_less_than_the_noise():
    assert rms_mrad(run().position_rad, run(step_s=STEP_S / 2).position_rad) < 0.02


def test_the_same_seed_gives_the_same_bits():
    assert np.array_equal(run().position_rad, run().position_rad)


def test_friction_holds_what_it_can_and_no_more():
    level = np.full(ROWS, 0.3)
    sag = 0.5 * 9.81 * 0.3 * np.sin(0.3)  # what the servo would have to give way to
    stuck = run(Hidden("coulomb_friction", JOINT, {"torque": 1.1 * sag}), table=level)
    assert abs(stuck.position_rad[-1, 0] - 0.3) < 2e-4
    loose = run(Hidden("coulomb_friction", JOINT, {"torque": 0.5 * sag}), table=level)
    assert loose.position_rad[-1, 0] < 0.27


def test_a_set_point_that_may_not_move_fast_falls_behind():
    table = np.full(ROWS, 1.3)
    table[0] = 0.3
    slow = run(Hidden("speed_limit", JOINT, {"speed": 0.5}), table=table)
    speed = np.diff(slow.position_rad[30:, 0]).mean() / TICK_S
    assert speed == pytest.approx(0.5 * KP / (KP + M * G * L), rel=0.1)
    assert np.diff(run(table=table).position_rad[:, 0]).max() / TICK_S > 2


def trapezoid(t, way, most, speed):
    """A set-point's way after t: it speeds up, goes on, and slows down to rest."""
    top = min(speed, np.sqrt(most * way))
    rise_s, all_s = top / most, way / top + top / most
    t = min(t, all_s)
    if t < rise_s:
        return most * t**2 / 2
    if t < all_s - rise_s:
        return top * (t - rise_s / 2)
    return way - most * (all_s - t) ** 2 / 2


@pytest.mark.parametrize("speed", [np.inf, 2.0])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_set_point_starts_and_stops_gently(speed, way):
    step_s, kind = 0.0005, KINDS["acceleration_limit"]
    servos = Servos(hidden_plant("pendulum"), step_s)
    kind.change_servos(servos, 0, {"acceleration": 20.0})
    if np.isfinite(speed):
        KINDS["speed_limit"].change_servos(servos, 0, {"speed": speed})
    servos.set_point(np.zeros(1))
    found = [servos.set_point(np.array([way]))[0] for _ in range(1500)]
    wanted = [
        np.sign(way) * trapezoid((k + 0.5) * step_s, abs(way), 20.0, speed)
        for k in range(1500)
    ]
    assert np.abs(np.array(found) - wanted).max() < 2e-3
    assert found[-1] == way


def test_an_offset_is_seen_in_the_encoder_but_taken_out_by_the_servo():
    level = np.zeros(ROWS)
    late = run(
        Hidden("encoder_offset", JOINT, {"offset": 0.05}), start=0.0, table=level
    )
    true_rad = late.position_rad[-1, 0]
    assert late.encoder_rad[-1, 0] == pytest.approx(true_rad + 0.05)
    balance = KP * (-true_rad - 0.05) - M * G * L * np.sin(true_rad)
    assert abs(balance) < 0.02


def test_a_late_encoder_shows_what_was():
    late = run(Hidden("sensor_delay", "encoders", {"delay": 2 * TICK_S}))
    assert np.allclose(late.encoder_rad[2:], late.position_rad[:-2])
    assert rms_mrad(late.position_rad, run().position_rad) < 1e-9


def test_an_end_stop_ends_it():
    stop = run(Hidden("end_stop", JOINT, {"angle": 0.3, "side": 1.0}))
    assert stop.position_rad.max() < 0.305
    assert run().position_rad.max() > 0.33


def test_backlash_lets_the_joint_hang_back_by_half_its_gap():
    level = np.full(ROWS, 0.5)
    slack = run(Hidden("backlash", JOINT, {"gap": 0.04}), CALM, start=0.5, table=level)
    q = slack.position_rad[-1, 0]
    assert KP * (0.5 - 0.02 - q) == pytest.approx(M * G * L * np.sin(q), rel=0.02)


def test_an_elastic_joint_sags_behind_its_encoder():
    level = np.full(ROWS, 0.5)
    soft = Hidden("joint_elasticity", JOINT, {"stiffness": 50.0, "damping": 2.0})
    sag = run(soft, CALM, start=0.5, table=level)
    q, motor = sag.position_rad[-1, 0], sag.encoder_rad[-1, 0]
    assert 50.0 * (motor - q) == pytest.approx(M * G * L * np.sin(q), rel=0.02)


@pytest.mark.parametrize("share", [0.2, 0.9])
def test_a_supply_gives_way_under_what_the_servo_holds(share):
    plant, level = hidden_plant("pendulum"), np.full(ROWS, 0.5)
    weak = Hidden("supply_sag", "supply", {"share": share})
    sagged = run(weak, CALM, start=0.5, table=level)
    q, held_nm = sagged.position_rad[-1, 0], M * G * L * np.sin(sagged.position_rad[-1])
    voltage = 1 - share * held_nm[0] / plant.max_torque_nm[0]
    assert KP * voltage * (0.5 - q) == pytest.approx(held_nm[0], rel=0.02)
    assert voltage < 1 - 0.1 * share


def test_friction_by_the_angle_holds_more_further_up():
    """With 1.1 times the weight at 0.3 rad it holds there, and not at 0.9 rad."""
    middle_rad = float(np.mean(hidden_plant("pendulum").range_rad[0]))
    at_03 = 1.1 * M * G * L * np.sin(0.3)
    for factor, stays in ((0.1, False), (10.0, True)):
        torque = at_03 * factor ** (middle_rad - 0.3)
        rubs = Hidden("angle_friction", JOINT, {"torque": torque, "factor": factor})
        low = run(rubs, start=0.3, table=np.full(ROWS, 0.3))
        assert abs(low.position_rad[-1, 0] - 0.3) < 5e-4
        high = run(rubs, start=0.9, table=np.full(ROWS, 0.9))
        assert (abs(high.position_rad[-1, 0] - 0.9) < 5e-4) == stays


def test_no_more_mass_is_taken_than_a_body_has():
    with pytest.raises(BadValueError, match=f"9 kg cannot be taken .* '{LINK}'"):
        run(Hidden("payload_mass", LINK, {"mass": -9.0}))


def test_unknown_places_and_engines_are_refused():
    with pytest.raises(UnknownNameError, match="swing"):
        run(Hidden("backlash", "sving", {"gap": 0.1}))
    with pytest.raises(UnknownNameError, match="link"):
        run(Hidden("payload_mass", "lnk", {"mass": 0.1}))
    with pytest.raises(BadValueError, match="needs the engine mujoco"):
        run(Hidden("armature", JOINT, {"inertia": 0.1}), engine="bullet")
    with pytest.raises(BadValueError, match="engine"):
        run(engine="chrono")
