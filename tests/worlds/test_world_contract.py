"""What both worlds promise, and both must keep: how rollouts start, go on and end."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import worlds
from groundwalk.errors import BadValueError, UnknownNameError
from terrain import Heightfield
from worlds import End, WorldOptions


def test_is_known_by_name(world_name, world):
    assert worlds.kind(world_name).world is type(world)
    with pytest.raises(UnknownNameError, match="did you mean 'real'"):
        worlds.kind("reel")


def test_shapes(world, settled):
    assert (world.n, len(world.description.joints)) == (3, 20)
    shapes = {name: array.shape[1:] for name, array in settled.items()}
    assert shapes == {
        "time_s": (3,),
        "position_rad": (3, 20),
        "velocity_rad_s": (3, 20),
        "gyroscope_rad_s": (3, 3),
        "accelerometer_m_s2": (3, 3),
        "foot_force_n": (3, 8),
        "base_position_m": (3, 3),
        "base_orientation": (3, 4),
        "base_linear_velocity_m_s": (3, 3),
        "base_angular_velocity_rad_s": (3, 3),
    }
    assert all(array.dtype == np.float64 for array in settled.values())


def test_clock(settled):
    ticks = np.arange(len(settled["time_s"]))
    np.testing.assert_allclose(settled["time_s"], np.tile(0.01 * ticks, (3, 1)).T)


def test_starts_upright_at_rest(settled, poses):
    start = {name: array[0] for name, array in settled.items()}
    np.testing.assert_array_equal(start["position_rad"], poses)
    np.testing.assert_array_equal(start["velocity_rad_s"], 0)
    np.testing.assert_array_equal(start["base_position_m"][:, :2], 0)
    np.testing.assert_allclose(
        start["base_orientation"], np.tile([1.0, 0, 0, 0], (3, 1)), atol=1e-12
    )
    for key in ("base_linear_velocity_m_s", "base_angular_velocity_rad_s"):
        np.testing.assert_array_equal(start[key], 0)


def test_starts_with_the_lower_sole_on_the_ground(
    nao, make_world, world_name, crouch, flat, link_frames
):
    """The sole below the lower ankle, which SciPy finds, is on the ground."""
    poses = np.tile(crouch, (3, 1))
    for robot, side in ((0, "L"), (1, "R")):  # bend one leg more: hip height 0.21 m
        for joint, angle in (("Hip", -0.5699), ("Knee", 1.2405), ("Ankle", -0.6707)):
            poses[robot, nao.joints.index(f"{side}{joint}Pitch")] = angle
    raised = Heightfield(np.full((5, 5), 0.3), (-0.5, -0.5), 0.25)
    world = make_world(world_name, [flat, flat, raised])
    world.reset(poses)
    _, places = link_frames(nao, poses)
    ankles_m = np.stack([places[foot.joint] for foot in nao.feet])[:, :, 2]
    assert np.abs(np.diff(ankles_m, axis=0))[0, :2] == pytest.approx(0.02, abs=1e-4)
    # The soles are level to 1e-4 rad here, and reach no further than 0.1 m.
    np.testing.assert_allclose(
        world.truth().base_position_m[:, 2],
        np.array([0, 0, 0.3]) + 0.04511 - ankles_m.min(axis=0),
        atol=2e-5,
    )


def test_robots_fall_and_stay_frozen(world, crouch, topple, roll, same_bits):
    pose = np.stack([crouch, topple, crouch])
    rollout = roll(world, pose, [pose] * 100)
    assert world.ended == [End.NONE, End.FALL, End.NONE]
    np.testing.assert_array_equal(world.active, [True, False, True])
    time_s = rollout["time_s"][:, 1]
    last = int(np.argmax(time_s))
    assert 0.2 < time_s[last] < 0.8
    frozen = {name: array[last:] for name, array in rollout.items()}
    for name, array in frozen.items():
        np.testing.assert_array_equal(array[:, 1], array[[0] * len(array), 1], name)
    assert rollout["time_s"][-1, 0] == pytest.approx(1.0)
    turn = Rotation.from_quat(rollout["base_orientation"][last, 1], scalar_first=True)
    start_m, end_m = rollout["base_position_m"][[0, last], 1, 2]
    before_m = rollout["base_position_m"][last - 1, 1, 2]
    assert end_m < start_m / 2 <= before_m or turn.magnitude() > np.radians(60)


def test_stopped_robots_stay_frozen(world, poses, settled, roll):
    world.reset(poses)
    for _ in range(3):
        world.step(poses)
    world.stop(np.array([False, False, True]))
    for _ in range(3):
        observation = world.step(poses)
    assert world.ended == [End.NONE] * 3
    np.testing.assert_array_equal(world.active, [True, True, False])
    for robot, tick in ((0, 6), (1, 6), (2, 3)):
        for key in ("position_rad", "foot_force_n", "time_s"):
            np.testing.assert_array_equal(
                getattr(observation, key)[robot], settled[key][tick, robot]
            )
    world.stop(np.ones(3, bool))
    still = world.step(poses)
    np.testing.assert_array_equal(still.position_rad, observation.position_rad)


def test_a_robot_can_leave_its_ground(world_name, make_world, poses):
    """Ground that ends a centimetre in front of the torso, which leans forward."""
    spacing_m = 0.05
    tiny = Heightfield(np.zeros((9, 9)), (0.01 - 8 * spacing_m, -0.2), spacing_m)
    world = make_world(world_name, [tiny])
    world.reset(poses[:1])
    for _ in range(100):
        world.step(poses[2:])
        if not world.active[0]:
            break
    assert world.ended == [End.LEFT_GROUND]
    assert world.truth().base_position_m[0, 0] > 0.01
    assert world.truth().base_position_m[0, 2] > 0.3  # still on its feet


def test_coupled_joints_follow_their_mean(nao, world, poses):
    """One motor turns both hips, whatever each of them is told."""
    first, second = nao.coupled[0]
    command = poses.copy()
    command[:, first], command[:, second] = -0.3, 0.1
    world.reset(poses)
    for _ in range(60):
        observation = world.step(command)
    np.testing.assert_allclose(
        observation.position_rad[0, [first, second]], -0.1, atol=0.03
    )


def test_soles_slide_on_ground_that_is_too_smooth(nao, make_world, world_name, crouch):
    """Downhill with g (sin a - mu cos a) along a slope a; they stick if mu > tan a."""
    slope_rad, smooth, rough = 0.1, 0.05, 0.5
    x_m = np.arange(-1.5, 1.6, 0.5)
    ground = Heightfield(np.tile(np.tan(slope_rad) * x_m, (7, 1)), (-1.5, -1.5), 0.5)
    pose = crouch.copy()
    for side in "LR":
        pose[nao.joints.index(side + "AnklePitch")] -= slope_rad
    moved_m = {}
    for friction in (smooth, rough):
        world = make_world(world_name, [ground], friction=friction)
        world.reset(pose[None])
        path_m = []
        for _ in range(60):
            world.step(pose[None])
            path_m.append(world.truth().base_position_m[0, 0])
        moved_m[friction] = path_m
    assert np.abs(moved_m[rough]).max() < 0.005
    along = 9.81 * (np.sin(slope_rad) - smooth * np.cos(slope_rad))
    path_m = moved_m[smooth]
    acceleration = (path_m[59] - 2 * path_m[39] + path_m[19]) / 0.2**2
    assert acceleration == pytest.approx(-along * np.cos(slope_rad), rel=0.15)


def test_needs_a_ground_and_a_seed_for_each_robot(world_name, nao, flat):
    seeds = [np.random.SeedSequence(0)]
    for grounds in ([], [flat, flat]):
        with pytest.raises(BadValueError, match="one of each"):
            worlds.make(world_name, nao, grounds, seeds)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"timestep_s": 0.003}, "timestep_s is 0.003"),
        ({"timestep_s": 0.0}, "timestep_s is 0.0"),
        ({"timestep_s": 0.02}, "timestep_s is 0.02"),
        ({"timestep_s": float("nan")}, "timestep_s is nan"),
        ({"latency_s": 0.035}, "latency_s is 0.035"),
        ({"latency_s": -0.01}, "latency_s is -0.01"),
        ({"friction": -0.1}, "friction is -0.1"),
        ({"threads": -1}, "threads is -1"),
    ],
)
def test_options_that_cannot_be(options, message):
    with pytest.raises(BadValueError, match=message):
        WorldOptions(**options)


@pytest.mark.parametrize("timestep_s", [0.0005, 0.001, 0.002, 0.0025, 0.005, 0.01])
def test_steps_that_fit_into_a_tick(timestep_s):
    options = WorldOptions(timestep_s=timestep_s, latency_s=0.03)
    assert options.steps_per_tick * timestep_s == pytest.approx(0.01)
    assert options.latency_steps * timestep_s == pytest.approx(0.03)
