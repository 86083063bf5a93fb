"""First-order guesses: the right effect first, and nothing where nothing is."""

import numpy as np
import pytest
from joint_rigs import ticks, trace_of
from made_up_traces import arm, recorded

from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Channels, Predictor
from diagnosis.residuals.signatures import Signature, signatures
from diagnosis.search.screening import Screen
from diagnosis.traces.usage import Usage

NOISE_RAD = 4e-4
CHANNELS = Channels(("position.shoulder", "position.elbow"), np.full(2, NOISE_RAD))
CANDIDATES = (  # without servo damping, which is viscous friction by another name
    "viscous_friction",
    "coulomb_friction",
    "backlash",
    "command_latency",
    "encoder_offset",
    "servo_gain",
    "armature",
    "payload_mass",
    "torque_limit",
    "joint_spring",
)


def screened(*effects, names=CANDIDATES, noise_rad=NOISE_RAD, base=()):
    plant = arm(emf=0.1)
    trace = recorded(plant, *effects, noise_rad=noise_rad, duration_s=3.0)
    predictor = Predictor(plant, [trace], CHANNELS, step_s=0.004)
    predictor.calibrate()
    predictor = predictor.nominal()
    usage = Usage.of(plant, [trace])
    residual = predictor.residuals([base])[0]
    found = signatures(predictor, base, usage, names=names)
    return Screen(predictor, found), residual


@pytest.mark.parametrize(
    ("truth", "least_share"),
    [
        (("viscous_friction", "elbow", 0.2), 0.7),
        (("coulomb_friction", "shoulder", 0.2), 0.6),
        (("command_latency", "commands", 0.012), 0.9),
        # seen by gravity only, and at the other joint, too
        (("encoder_offset", "elbow", -0.03), 0.35),
        (("servo_gain", "shoulder", 0.85), 0.7),
        (("servo_gain", "elbow", 1.2), 0.7),
        (("armature", "elbow", 0.02), 0.7),
        (("payload_mass", "lower", 0.1), 0.9),
        (("joint_spring", "elbow", 2.0, 0.0), 0.6),
    ],
)
def test_the_right_effect_comes_first(truth, least_share):
    name, place, *values = truth
    screen, residual = screened(truth)
    best = screen.singles(residual)[0]
    (placed,) = best.model
    assert placed.key == f"{name}@{place}"
    assert best.gain > least_share * 0.5 * residual @ residual
    assert placed.values[0] == pytest.approx(values[0], rel=0.5)


def test_what_is_far_from_linear_is_among_the_first():
    screen, residual = screened(("backlash", "elbow", 0.02))
    first = [guess.model[0].key for guess in screen.singles(residual)[:3]]
    assert "backlash@elbow" in first


def test_two_effects_come_first_as_a_pair():
    effects = ("viscous_friction", "elbow", 0.2), ("servo_gain", "shoulder", 0.85)
    screen, residual = screened(*effects)
    best = screen.pairs(residual, count=3)[0]
    assert {placed.key for placed in best.model} == {
        "viscous_friction@elbow",
        "servo_gain@shoulder",
    }
    assert best.gain > screen.singles(residual)[0].gain


def test_where_nothing_is_little_is_found():
    screen, residual = screened()
    assert residual @ residual == pytest.approx(2 * 131, rel=0.4)
    assert screen.singles(residual)[0].gain < 6
    assert screen.pairs(residual, count=1)[0].gain < 9


def test_what_is_in_the_base_is_explained():
    truth = ("servo_gain", "shoulder", 0.85)
    base = (PlacedEffect("servo_gain", "shoulder", (0.85,)),)
    (screen, before), (rest, after) = screened(truth), screened(truth, base=base)
    gain = screen.singles(before)[0].gain
    assert all(guess.gain < 0.05 * gain for guess in rest.singles(after))


@pytest.fixture(scope="module")
def predictor():
    plant = arm()
    return Predictor(plant, [recorded(plant, duration_s=0.5)], CHANNELS)


def made_up(name, place, values, change, two_sided=False):
    change = np.array(change, float)
    placed = PlacedEffect(name, place, values)
    return Signature(placed, change, np.arange(len(change)), two_sided)


def singles(predictor, residual, *found):
    padded = np.zeros(len(predictor.scored))
    padded[: len(residual)] = residual
    return Screen(predictor, found).singles(padded)


def test_a_guess_is_the_projection(predictor):
    """Of r on c: size -r.c / c.c, gain (r.c)^2 / (2 c.c)."""
    one = made_up("viscous_friction", "elbow", (0.02,), [1, 2, 0])
    (guess,) = singles(predictor, [-3.0, -4.0, 7.0], one)
    assert guess.model[0].values == pytest.approx((0.02 * 11 / 5,))
    assert guess.gain == pytest.approx(11**2 / 5 / 2)


def test_values_of_the_model_so_far_may_change_with_what_is_added(predictor):
    """Beside a direction that is free, only the rest of a signature explains.

    A residual at its least is at right angles to the model's own directions. Of a
    signature that is nearly one of these only a small part explains it, but all of it.
    """
    nearly = made_up("viscous_friction", "elbow", (0.02,), [3, -0.5, 0])
    other = made_up("coulomb_friction", "elbow", (0.02,), [0, -0.5, 1])
    residual = np.zeros(len(predictor.scored))
    residual[1] = 1.0
    jacobian = np.zeros((len(residual), 2))
    jacobian[0, 0] = 2.0  # and a value that does nothing
    screen = Screen(predictor, [nearly, other])
    first, second = screen.singles(residual, jacobian)
    assert first.model[0].name == "viscous_friction"
    assert first.gain == pytest.approx(0.5, rel=0.1)
    assert first.model[0].values == pytest.approx((0.02 * 2,), rel=0.1)
    assert second.gain == pytest.approx(0.5**2 / 1.25 / 2, rel=0.01)
    assert [guess.model[0].name for guess in screen.singles(residual)] == [
        "coulomb_friction",
        "viscous_friction",
    ]
    # what the model can do by itself is no reason to add anything
    same = made_up("viscous_friction", "elbow", (0.02,), [1, 0, 0])
    residual[:2] = 1.0, 0.0
    assert Screen(predictor, [same]).singles(residual, jacobian) == []


def test_pairs_of_what_explains_nothing_alone(predictor):
    """Effects with one sign, each of which would need the other one alone."""
    gain = made_up("servo_gain", "elbow", (0.9,), [-2, 1], two_sided=True)
    mass = made_up("payload_mass", "lower", (0.1,), [1, -1])
    residual = np.zeros(len(predictor.scored))
    residual[:2] = -(np.array([-2, 1]) + np.array([1, -1]))  # of the sum of both
    screen = Screen(predictor, [gain, mass])
    assert [guess.model[0].name for guess in screen.singles(residual)] == ["servo_gain"]
    (pair,) = screen.pairs(residual, count=5)
    assert pair.gain == pytest.approx(0.5)


def test_only_what_has_two_sides_may_change_sign(predictor):
    both = made_up("encoder_offset", "elbow", (0.02,), [1, 0], two_sided=True)
    (guess,) = singles(predictor, [1.0, 0.0], both)
    assert guess.model[0].values == pytest.approx((-0.02,))
    assert guess.gain == pytest.approx(0.5)
    one = made_up("viscous_friction", "elbow", (0.02,), [1, 0])
    assert singles(predictor, [1.0, 0.0], one) == []


def test_a_guess_stretches_not_too_far(predictor):
    one = made_up("viscous_friction", "elbow", (0.01,), [1.0])
    (guess,) = singles(predictor, [-10.0], one)
    assert guess.model[0].values == pytest.approx((0.04,))
    assert guess.gain == pytest.approx(0.5 * 100 - 0.5 * 36)


def test_thresholds_are_not_stretched_and_springs_get_softer(predictor):
    limit = made_up("torque_limit", "elbow", (0.3,), [1.0])
    spring = made_up("joint_elasticity", "shoulder", (20.0, 0.1), [1.0])
    by_name = {
        guess.model[0].name: guess.model[0].values
        for guess in singles(predictor, [-2.0], limit, spring)
    }
    assert by_name["torque_limit"] == (0.3,)
    assert by_name["joint_elasticity"] == pytest.approx((10.0, 0.1))


def test_components_are_put_together(predictor):
    vectors = [
        made_up("com_offset", "lower", (0.01, 0, 0), [1, 0, 0], True),
        made_up("com_offset", "lower", (0, 0.01, 0), [0, 0, 0], True),
        made_up("com_offset", "lower", (0, 0, 0.01), [1, 1, 0], True),
    ]
    (guess,) = singles(predictor, [-3.0, -1.0, 5.0], *vectors)
    assert guess.model[0].values == pytest.approx((0.02, 0.0, 0.01))
    assert guess.gain == pytest.approx(5.0)


def test_a_push_keeps_its_time(predictor):
    """Pushes at different times are different guesses of one effect and place."""
    pushes = [
        made_up("external_force", "lower", (1.0, 0, 0, at, 0.2), change, True)
        for at, change in ((1.0, [1, 0]), (2.0, [0, 1]))
    ]
    (guess,) = singles(predictor, [1.0, -3.0], *pushes)
    assert guess.model[0].values == pytest.approx((3.0, 0, 0, 2.0, 0.2))


def test_the_best_of_several_sizes_counts(predictor):
    sizes = [
        made_up("backlash", "elbow", (0.01,), [1, 1]),
        made_up("backlash", "elbow", (0.03,), [0, 4]),
    ]
    found = singles(predictor, [0.0, -4.0], *sizes)
    assert len(found) == 1
    assert found[0].model[0].values == pytest.approx((0.03,))


def test_a_pair_is_solved_together(predictor):
    """Of c = (1, 0), d = (1, 1) and r = -(3, 1): 2 c + d, which explains all."""
    found = [
        made_up("viscous_friction", "elbow", (0.01,), [1, 0]),
        made_up("backlash", "elbow", (0.01,), [1, 1]),
        made_up("backlash", "elbow", (0.03,), [1, 1.1]),
    ]
    residual = np.zeros(len(predictor.scored))
    residual[:2] = -3.0, -1.0
    (guess,) = Screen(predictor, found).pairs(residual, count=5)
    by_name = {placed.name: placed.values for placed in guess.model}
    assert guess.gain == pytest.approx(5.0)
    assert set(by_name) == {"viscous_friction", "backlash"}


def test_trial_values_follow_usage():
    plant = arm()
    trace = recorded(plant, duration_s=1.0)
    usage = Usage.of(plant, [trace])
    elbow = 1
    assert usage.low_rad[elbow] == trace.position_rad[:, elbow].min()
    assert usage.high_rad[elbow] == trace.position_rad[:, elbow].max()
    asked = 40.0 * (trace.command_rad - trace.position_rad)[:, elbow]
    velocity = np.gradient(trace.position_rad[:, elbow], trace.time_s)
    given = np.abs(asked - plant.servo.kd_nm_s_rad[elbow] * velocity)
    assert usage.torque_nm[elbow] == pytest.approx(given.max(), rel=0.1)
    # most of what the stiffness asks for is what the damping takes back
    assert usage.torque_nm[elbow] < 0.5 * np.abs(asked).max()
    for share, (limit,) in zip(
        (0.9, 0.7, 0.45),
        effect("torque_limit").first_tries(plant, "elbow", usage),
        strict=True,
    ):
        assert limit == pytest.approx(share * usage.torque_nm[elbow])
    for angle, side in effect("end_stop").first_tries(plant, "elbow", usage):
        assert usage.low_rad[elbow] <= angle <= usage.high_rad[elbow]
        assert abs(side) == 1


@pytest.mark.parametrize("limit", [1.5, 3.0, 6.0])
def test_the_speed_of_a_joint_tells_its_limit_where_commands_jump(limit):
    plant = arm()
    time_s = ticks(4.0, 0.01)
    slow = 0.2 * np.sin(time_s)
    jumping = slow + 0.8 * ((time_s > 1) & (time_s < 2.5))
    follows = [0.0]
    for wanted in jumping[1:]:  # textbook rate limiter
        far = np.clip(wanted - follows[-1], -0.01 * limit, 0.01 * limit)
        follows.append(follows[-1] + far)
    joints = np.stack([slow, follows], axis=1)
    command = np.stack([slow, jumping], axis=1)
    trace = trace_of(plant, time_s, joints, command_rad=command)
    usage = Usage.of(plant, [trace])
    assert usage.top_speed_rad_s == pytest.approx([0.2, limit], rel=0.1)
    tries = effect("speed_limit").first_tries(plant, "elbow", usage)
    assert min(abs(one / limit - 1) for (one,) in tries) < 0.1
    assert np.quantile(np.abs(np.diff(command[:, 1])) / 0.01, 0.99) < 0.25  # no help
