import re
from pathlib import Path

import gymnasium
import mujoco
import numpy as np
import pytest

from experiments.transfer.gym_studies.environments import (
    HALF_CHEETAH,
    INVERTED_PENDULUM,
    NOISY_REAL,
    NOISY_SIM,
)
from robots.engine_models.mjcf import quiet_mujoco

ASSETS = Path(gymnasium.__file__).parent / "envs" / "mujoco" / "assets"
DOMAINS = pytest.mark.parametrize("domain", [INVERTED_PENDULUM, HALF_CHEETAH])


def edited(name, old, new):
    """A model from Gymnasium's own file with one edit."""
    text = (ASSETS / name).read_text()
    assert len(re.findall(old, text)) == 1
    quiet_mujoco()
    return mujoco.MjModel.from_xml_string(re.sub(old, new, text))


def free_run(model):
    """Positions and velocities after some steps under changing controls."""
    data = mujoco.MjData(model)
    mujoco.mj_resetData(model, data)
    for tick in range(200):
        data.ctrl[:] = np.sin(0.1 * tick + np.arange(model.nu))
        mujoco.mj_step(model, data)
    return np.concatenate([data.qpos, data.qvel])


def given_actions(env, action, n):
    env.reset(seed=3)
    given = []
    for _ in range(n):
        _, _, terminated, truncated, info = env.step(action)
        given.append(info["transformed_action"])
        if terminated or truncated:
            env.reset()
    return np.array(given, float)


def test_the_heavy_cheetah_is_the_one_of_an_edited_file():
    heavy = HALF_CHEETAH.real(NOISY_REAL, 0.0).unwrapped.model
    right = edited("half_cheetah.xml", r'settotalmass="14"', 'settotalmass="20"')
    assert heavy.body_mass.sum() == pytest.approx(20)
    np.testing.assert_allclose(heavy.body_inertia, right.body_inertia, rtol=1e-12)
    np.testing.assert_allclose(heavy.dof_invweight0, right.dof_invweight0, rtol=1e-9)
    np.testing.assert_allclose(free_run(heavy), free_run(right), atol=1e-6)
    light = HALF_CHEETAH.real(NOISY_SIM, 0.0).unwrapped.model
    assert np.abs(free_run(light) - free_run(right)).max() > 0.01


def test_the_heavy_pendulum_has_ten_times_the_pole_and_the_same_cart():
    heavy = INVERTED_PENDULUM.real(NOISY_REAL, 0.0).unwrapped.model
    light = INVERTED_PENDULUM.sim().unwrapped.model
    assert heavy.body("pole").mass == pytest.approx(50.186, abs=1e-3)
    assert heavy.body("cart").mass == light.body("cart").mass
    right = edited(
        "inverted_pendulum.xml", r'name="cpole"', r'name="cpole" density="10000"'
    )
    np.testing.assert_allclose(free_run(heavy), free_run(right), atol=1e-6)


@DOMAINS
def test_noise_is_of_the_size_that_was_asked_for(domain):
    low, high = domain.bounds()
    half = (high - low)[0] / 2
    env = domain.real(NOISY_SIM, 0.1)
    action = np.full(len(low), 0.2 * half, np.float32)
    given = given_actions(env, action, 2000)
    n = given.size
    assert given.mean() == pytest.approx(0.2 * half, abs=4 * 0.1 * half / n**0.5)
    assert given.std() == pytest.approx(0.1 * half, rel=4 / (2 * n) ** 0.5)
    np.testing.assert_array_equal(action, np.full(len(low), 0.2 * half, np.float32))


@DOMAINS
def test_noise_is_clipped_after_it_was_added(domain):
    low, high = domain.bounds()
    given = given_actions(domain.real(NOISY_SIM, 0.5), high.astype(np.float32), 500)
    assert given.max() == high[0]
    assert given.min() >= low[0]
    # Added to the largest action, half of the normal numbers are cut off.
    at_limit = np.mean(given == high[0])
    assert at_limit == pytest.approx(0.5, abs=4 * 0.5 / given.size**0.5)


def test_rewards_charge_the_cheetah_for_its_own_action():
    domain, action = HALF_CHEETAH, np.full(6, 0.5, np.float32)
    env = domain.real(NOISY_SIM, 0.5)
    env.reset(seed=1)
    _, reward, _, _, info = env.step(action)
    assert np.abs(info["transformed_action"] - action).max() > 0.1
    own_cost = 0.1 * np.sum(action**2)
    assert reward == pytest.approx(info["reward_forward"] - own_cost, abs=1e-6)


def test_without_noise_the_noisy_sim_is_the_sim():
    plain, noiseless = INVERTED_PENDULUM.sim(), INVERTED_PENDULUM.real(NOISY_SIM, 0.0)
    starts = [env.reset(seed=5)[0] for env in (plain, noiseless)]
    np.testing.assert_array_equal(*starts)
    action = np.array([0.7], np.float32)
    for _ in range(3):
        steps = [env.step(action)[:3] for env in (plain, noiseless)]
        np.testing.assert_array_equal(steps[0][0], steps[1][0])
        assert steps[0][1:] == steps[1][1:]
