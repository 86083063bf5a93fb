import mujoco
import numpy as np
import pytest
from rrd_files import NAO, SENSORS, TICKS, scene, walk_columns

from groundwalk.gravity import GRAVITY_M_S2
from robots.engine_models.mjcf import mujoco_spec
from worlds.recordings.metadata import RecordingMetadata
from worlds.recordings.recording import Recording
from worlds.scenes.balance import balance, loaded_feet
from worlds.scenes.scene import Scene
from worlds.sim.world import add_ground

STANDING_M = 0.085 + 0.1 + 0.1029 + 0.04511
ABOUT = RecordingMetadata("nao", "floating", "a test")


def standing(ticks=TICKS, **columns):
    """Straight legs, soles at z = 0, at rest."""
    zero = np.zeros(ticks)
    values = {"time": 0.01 * np.arange(ticks)}
    for joint in NAO.joints:
        values[f"position.{joint}"] = values[f"command.{joint}"] = zero
    values |= {"base.position.x": zero, "base.position.y": zero}
    values |= {"base.position.z": zero + STANDING_M, "base.orientation.w": zero + 1}
    values |= {f"base.orientation.{axis}": zero for axis in "xyz"}
    values |= {key.replace("__", "."): of + zero for key, of in columns.items()}
    return Scene("sim", Recording(values, ABOUT), NAO)


def forces(left=(0, 0, 0, 0), right=(0, 0, 0, 0)):
    return {
        f"foot_force__{side}__{name}": float(value)
        for side, values in (("left", left), ("right", right))
        for name, value in zip(SENSORS, values, strict=True)
    }


def area_m2(corners):
    x, y = corners[:, :2].T
    return abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2


def test_the_centre_of_mass_is_that_of_mujoco():
    walk = scene()
    model = mujoco_spec(NAO).compile()
    data = mujoco.MjData(model)
    centre_m = balance(walk).centre_of_mass_m
    recording = walk.recording
    for tick in (0, 7, TICKS - 1):
        data.qpos[:3] = recording.vector("base.position")[tick]
        data.qpos[3:7] = recording.vector("base.orientation")[tick]
        data.qpos[7:] = recording.joint_values("position", NAO.joints)[tick]
        mujoco.mj_forward(model, data)
        np.testing.assert_allclose(centre_m[tick], data.subtree_com[1], atol=1e-6)


def test_at_rest_the_zmp_is_below_the_centre_of_mass():
    found = balance(standing())
    middle = slice(14, -14)
    np.testing.assert_allclose(found.below_m[:, 2], 0, atol=1e-9)
    np.testing.assert_allclose(found.zmp_m[middle], found.below_m[middle], atol=1e-9)
    assert found.pressure_m is None
    assert found.polygons_m is None


def test_who_speeds_up_needs_the_ground_to_push_behind_the_centre_of_mass():
    """For a body that does not turn: p = c - (c_z - p_z) a / g."""
    acceleration = np.array([0.8, -0.5])
    time_s = 0.01 * np.arange(80)
    x_m, y_m = np.outer(acceleration, time_s**2) / 2
    found = balance(standing(80, base__position__x=x_m, base__position__y=y_m))
    middle = slice(14, -14)
    height_m = found.centre_of_mass_m[middle, 2:]
    expected = (
        found.centre_of_mass_m[middle, :2] - height_m * acceleration / GRAVITY_M_S2
    )
    np.testing.assert_allclose(found.zmp_m[middle, :2], expected, atol=1e-6)


def test_who_falls_freely_has_no_zmp():
    fall_m = STANDING_M - GRAVITY_M_S2 * (0.01 * np.arange(60)) ** 2 / 2
    zmp_m = balance(standing(60, base__position__z=fall_m)).zmp_m
    assert np.isnan(zmp_m[:, :2]).all()


def test_without_a_base_nothing_is_said_of_the_motion():
    columns = {
        name: of for name, of in walk_columns().items() if not name.startswith("base")
    }
    found = balance(scene(columns=columns))
    assert found.zmp_m is None
    assert found.pressure_m is not None


def test_the_pressure_is_the_mean_of_the_sensors_by_their_forces():
    found = balance(standing(**forces(left=(30, 10, 0, 0))))
    front_left, front_right = NAO.feet[0].sensors_m[:2]
    place_m = 0.75 * front_left + 0.25 * front_right + (0, 0.05)
    np.testing.assert_allclose(found.pressure_m[0], [*place_m, 0], atol=1e-9)


def test_a_robot_in_the_air_has_neither_pressure_nor_support():
    found = balance(standing(**forces()))
    assert np.isnan(found.pressure_m).all()
    assert [len(corners) for corners in found.polygons_m] == [0] * TICKS


def test_the_polygon_is_the_hull_of_the_soles_that_carry():
    one = balance(standing(**forces(left=(9, 9, 9, 9)))).polygons_m[0]
    outline = NAO.feet[0].outline_m
    assert area_m2(one) == pytest.approx(area_m2(outline))
    assert one[:, 1].min() > 0
    both = forces(left=(9, 9, 9, 9), right=(9, 9, 9, 9))
    two = balance(standing(**both)).polygons_m[0]
    assert area_m2(two) > 2 * area_m2(outline)
    np.testing.assert_allclose(two[:, 1].max(), -two[:, 1].min(), atol=1e-9)
    assert np.abs(two[:, 2]).max() < 1e-9


def test_a_foot_carries_from_a_part_of_the_weight_on():
    least_n = 0.05 * NAO.mass_kg * GRAVITY_M_S2
    rising = np.linspace(0, 2 * least_n, TICKS)
    carries = loaded_feet(standing(foot_force__left=rising, foot_force__right=0.0))
    np.testing.assert_array_equal(carries["left"], rising > least_n)
    assert not carries["right"].any()
    assert loaded_feet(standing()) is None


def test_missing_values_are_missing_where_they_count():
    columns = walk_columns()
    columns["position.LKneePitch"][20] = np.nan
    found = balance(scene(columns=columns))
    assert np.flatnonzero(np.isnan(found.centre_of_mass_m[:, 0])).tolist() == [20]
    assert len(found.polygons_m[20]) == 0 or np.isfinite(found.polygons_m[20]).all()


def test_the_zmp_is_where_the_ground_pushed_in_mujoco(flat):
    """Knees that bend and stretch, arms that swing: what turns counts, too."""
    spec = mujoco_spec(NAO)
    add_ground(spec, flat)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[2], data.qpos[3] = STANDING_M, 1.0
    swing = np.zeros(model.nu)
    for name, part in (
        ("LShoulderPitch", 3), ("RShoulderPitch", 3), ("LHipPitch", -0.5),
        ("RHipPitch", -0.5), ("LKneePitch", 1), ("RKneePitch", 1),
        ("LAnklePitch", -0.5), ("RAnklePitch", -0.5),
    ):  # fmt: skip
        swing[NAO.joints.index(name)] = part
    rows, pressure_m = [], []
    for tick in range(160):
        rows.append(data.qpos.copy())
        # About 2 Hz, from 0 and without a jerk.
        data.ctrl[:] = swing * 0.15 * (1 - np.cos(0.12 * tick))
        pressure_m.append(_pushed(model, data, 5))
    qpos = np.array(rows)
    names = [f"base.position.{axis}" for axis in "xyz"]
    names += [f"base.orientation.{axis}" for axis in "wxyz"]
    names += [f"position.{joint}" for joint in NAO.joints]
    columns = dict(zip(names, qpos.T, strict=True))
    columns["time"] = 0.01 * np.arange(len(qpos))
    columns["command.LKneePitch"] = 0 * columns["time"]
    found = balance(Scene("sim", Recording(columns, ABOUT), NAO))
    middle = slice(40, -15)
    zmp_m, true_m = found.zmp_m[middle, 0], np.array(pressure_m)[middle]
    assert np.ptp(true_m) > 0.03
    assert np.abs(zmp_m - true_m).max() < 0.1 * np.ptp(true_m)
    # Without what turns, of a mere point of mass, it would be elsewhere.
    centre_m = found.centre_of_mass_m
    second = np.gradient(np.gradient(centre_m, 0.01, axis=0), 0.01, axis=0)
    point_m = centre_m - centre_m[:, 2:] * second / (GRAVITY_M_S2 + second[:, 2:])
    apart_m = np.abs(point_m[middle, 0] - true_m).max()
    assert apart_m > 2 * np.abs(zmp_m - true_m).max()


def _pushed(model, data, steps):
    """x of the mean place at which the ground pushed, weighted by the forces."""
    force, moment, wrench = 0.0, 0.0, np.zeros(6)
    for _ in range(steps):
        mujoco.mj_step(model, data)
        for i in range(data.ncon):
            mujoco.mj_contactForce(model, data, i, wrench)
            force += wrench[0]
            moment += wrench[0] * data.contact[i].pos[0]
    return moment / force
