from dataclasses import replace

import known_losses
import numpy as np
import pytest
import torque_arm

from diagnosis.seen import look, rows, shares


def best_of(loss, joint=2):
    found = look(torque_arm.arm(), known_losses.recordings(loss)).joints[joint]
    shares = {one.name: one for one in found.shares}
    return max(found.shares, key=lambda one: one.alone), shares, found


@pytest.mark.parametrize(
    ("name", "loss"),
    [
        ("sign of speed", lambda q, v, needed: 1.5 * np.sign(v)),
        ("speed", lambda q, v, needed: 0.6 * v),
        ("position", lambda q, v, needed: 0.8 * np.sin(3 * q)),
        ("load", lambda q, v, needed: 0.3 * needed),
        ("other joints", lambda q, v, needed: 0.5 * v[:, [1, 2, 0]]),
    ],
)
def test_the_right_quantity_is_named(name, loss):
    best, shares, found = best_of(loss)
    assert best.name == name
    assert best.alone > 0.95
    assert found.together > 0.95
    assert best.lost == max(one.lost for one in found.shares)
    assert all(0 <= one.alone <= 1 and 0 <= one.lost <= 1 for one in shares.values())


def test_an_inertia_goes_with_acceleration():
    traces = known_losses.recordings()
    for k, trace in enumerate(traces):
        rate = np.gradient(trace.position_rad, trace.time_s, axis=0)
        more = 0.3 * np.gradient(rate, trace.time_s, axis=0)
        traces[k] = replace(trace, torque_nm=trace.torque_nm + more)
    joint = look(torque_arm.arm(), traces).joints[2]
    assert max(joint.shares, key=lambda one: one.alone).name == "acceleration"


def test_two_laws_need_both():
    _, _, found = best_of(lambda q, v, needed: 0.5 * np.sign(v) + 0.5 * np.sin(3 * q))
    assert found.together > 0.9
    assert max(one.alone for one in found.shares) < 0.8
    largest = sorted(found.shares, key=lambda one: -one.lost)[:2]
    assert {one.name for one in largest} == {"sign of speed", "position"}


def test_friction_that_grows_with_the_angle_goes_with_position():
    _, shares, found = best_of(lambda q, v, needed: (1.0 + 1.5 * q) * np.sign(v))
    assert found.together > 0.95
    assert shares["position"].lost > 0.1
    assert all(
        one.lost < 0.02
        for name, one in shares.items()
        if name not in ("sign of speed", "position")
    )


def test_noise_cannot_be_explained():
    best, _, found = best_of(lambda q, v, needed: 0.0)
    assert best.alone < 0.1
    assert found.together < 0.1


def test_what_does_not_repeat_is_noise():
    random = np.random.default_rng(5)

    def wandering(q, v, needed):
        """Slow noise as large as the friction."""
        steps = np.cumsum(random.standard_normal(q.shape), axis=0)
        slow = steps - steps.mean(axis=0)
        return 0.5 * np.sign(v) + 0.5 * slow / slow.std(axis=0)

    _, _, found = best_of(wandering)
    assert found.noise_share == pytest.approx(0.5, abs=0.2)
    assert found.together < 0.7
    _, _, repeated = best_of(lambda q, v, needed: 0.5 * np.sign(v))
    assert repeated.noise_share < 0.05


def test_too_little_motion_tells_nothing():
    found = look(torque_arm.arm(), [known_losses.moved(duration_s=1.2)])
    assert all(one.shares == () and one.together is None for one in found.joints)
    assert any("too little" in text for text in found.joints[0].unknown)


@pytest.mark.slow
@pytest.mark.parametrize("factor", [0.5, 2])
@pytest.mark.parametrize(
    ("module", "name"),
    [
        (shares, "RIDGE"),
        (shares, "FEWEST_ROWS"),
        (shares, "CLOSE"),
        (shares, "FEWEST_PAIRS"),
        (shares, "MOST_ROWS"),
        (rows, "CHOSEN_S"),
        (rows, "STILL"),
        (rows, "LEAST_TURN"),
        (rows, "NOISE_TURN"),
    ],
)
def test_a_factor_of_two_in_a_constant_hardly_matters(
    monkeypatch, module, name, factor
):
    value = getattr(module, name)
    monkeypatch.setattr(module, name, type(value)(factor * value))
    best, every, found = best_of(lambda q, v, needed: 1.5 * np.sign(v))
    assert best.name == "sign of speed"
    assert found.together > 0.95
    assert every["position"].lost < 0.02
