"""One ground in both engines: rays from above meet it at one height."""

import mujoco
import numpy as np
import pybullet
import pytest
from pybullet_utils.bullet_client import BulletClient

import terrain
from terrain import Heightfield
from worlds.real.body import load_ground
from worlds.sim.world import add_ground

POINTS = 1000
ABOVE_M, BELOW_M = 2.0, -2.0
TOLERANCE_M = 2e-4


def rough(rows=23, columns=31):
    """White noise from -0.1 to 0.1 m on cells of 0.1 m; off centre and not square."""
    heights = np.random.default_rng(3).uniform(-0.1, 0.1, (rows, columns))
    return Heightfield(heights, (-1.3, -0.4), 0.1)


GROUNDS = {name: terrain.make(name, seed=5) for name in terrain.names()} | {
    "rough": rough(),
    "raised": Heightfield(np.full((4, 5), 0.3), (-0.2, -0.3), 0.2),
}


def places(ground, seed=8):
    """Points all over a ground, and all of its corners and edges' middles' insides."""
    generator = np.random.default_rng(seed)
    (x0, x1), (y0, y1) = ground.x_range_m, ground.y_range_m
    edge = 1e-4
    x = generator.uniform(x0 + edge, x1 - edge, POINTS)
    y = generator.uniform(y0 + edge, y1 - edge, POINTS)
    x[:4], y[:4] = [x0 + edge, x1 - edge] * 2, [y0 + edge] * 2 + [y1 - edge] * 2
    return x, y


def mujoco_heights(ground, x, y):
    spec = mujoco.MjSpec()
    add_ground(spec, ground)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    down, hit = np.array([0.0, 0, -1]), np.zeros(1, np.int32)
    heights = []
    for place in np.c_[x, y, np.full(len(x), ABOVE_M)]:
        away_m = mujoco.mj_ray(model, data, place, down, None, 1, -1, hit)
        assert hit[0] == model.geom("ground").id
        heights.append(ABOVE_M - away_m)
    return np.array(heights)


def bullet_heights(ground, x, y):
    bullet = BulletClient(pybullet.DIRECT)
    try:
        body = load_ground(bullet, ground)
        hits = bullet.rayTestBatch(
            np.c_[x, y, np.full(len(x), ABOVE_M)].tolist(),
            np.c_[x, y, np.full(len(x), BELOW_M)].tolist(),
        )
    finally:
        bullet.disconnect()
    assert {hit[0] for hit in hits} == {body}
    return np.array([hit[3][2] for hit in hits])


@pytest.mark.parametrize("name", GROUNDS)
def test_rays_meet_the_ground_at_its_height(name):
    ground = GROUNDS[name]
    x, y = places(ground)
    expected = ground.height_at(x, y)
    for measured in (mujoco_heights(ground, x, y), bullet_heights(ground, x, y)):
        np.testing.assert_allclose(measured, expected, rtol=0, atol=TOLERANCE_M)


def test_the_other_diagonal_would_show():
    """The tolerance is fine enough to tell how cells are cut in two."""
    ground = rough()
    flipped = Heightfield(ground.heights_m[::-1], ground.origin_m, ground.spacing_m)
    x, y = places(ground)
    (low, high) = ground.y_range_m
    other = flipped.height_at(x, low + high - y)
    for measured in (mujoco_heights(ground, x, y), bullet_heights(ground, x, y)):
        assert np.mean(np.abs(measured - other) > TOLERANCE_M) > 0.9


def test_every_family_is_here_and_not_flat_but_one():
    assert set(terrain.names()) < set(GROUNDS)
    assert [name for name, ground in GROUNDS.items() if ground.is_flat] == [
        "flat",
        "raised",
    ]
