import numpy as np
import pytest
from rrd_files import (
    TICKS,
    components,
    entities,
    read,
    rerun,
    scalars,
    scene,
    walk_columns,
)

from terrain import make
from worlds.rerun_files.log import write_rrd
from worlds.scenes.balance import balance

LIFT_M = 0.002


@pytest.fixture(scope="module")
def walk():
    columns = walk_columns()
    force = np.repeat([20.0, 0.0], TICKS // 2)
    for name in ("front_left", "front_right", "rear_left", "rear_right"):
        columns[f"foot_force.left.{name}"] = force
        columns[f"foot_force.right.{name}"] = 0 * force
    return scene(ground=make("waves", 1), columns=columns, end="fall")


def points_m(file, name):
    return components(file, f"/sim/balance/{name}", "Points3D:positions", 3)


def strip_m(file, entity):
    (strips,) = read(file, entity)["LineStrips3D:strips"].to_pylist()
    return np.array(strips).reshape(-1, 3)


def test_rerun_finds_nothing_wrong_with_the_file(file):
    assert rerun("rrd", "verify", file).returncode == 0


def test_the_points_are_those_of_the_balance(file, walk):
    found = balance(walk)
    centre_m = points_m(file, "centre_of_mass")
    np.testing.assert_allclose(centre_m, found.centre_of_mass_m, atol=1e-6)
    for name, place_m in (("pressure", found.pressure_m), ("zmp", found.zmp_m)):
        known = np.isfinite(place_m).all(axis=1)
        assert known.any()
        assert not known.all()
        expected = place_m[known] + (0, 0, LIFT_M)
        np.testing.assert_allclose(points_m(file, name), expected, atol=1e-6)
        shown = read(file, f"/sim/balance/{name}")["Points3D:positions"].to_pylist()
        np.testing.assert_array_equal([len(cell) == 1 for cell in shown], known)
    track = strip_m(file, "/sim/balance/centre_of_mass/track")
    np.testing.assert_allclose(track, found.centre_of_mass_m, atol=1e-6)


def test_the_polygon_is_closed_and_gone_in_the_air(file, walk):
    strips = read(file, "/sim/balance/polygon")["LineStrips3D:strips"].to_pylist()
    polygons = balance(walk).polygons_m
    assert len(strips) == TICKS
    for strip, corners in zip(strips, polygons, strict=True):
        points = np.array([point for line in strip for point in line]).reshape(-1, 3)
        closed = np.vstack([corners, corners[:1]])
        np.testing.assert_allclose(points - (0, 0, LIFT_M), closed, atol=1e-6)
    assert [len(corners) > 0 for corners in polygons] == [True] * 20 + [False] * 20


def test_sideways_are_the_points_seen_from_ahead(file, walk):
    y_m = scalars(file, "/sim/balance/sideways/centre_of_mass")
    np.testing.assert_array_equal(y_m, balance(walk).centre_of_mass_m[:, 1])
    assert "/sim/balance/sideways/zmp" in entities(file)


def test_which_feet_carry_is_a_lane(file):
    lane = read(file, "/sim/contact/support")
    assert lane["StateChange:state"].flatten().to_pylist() == ["left", "none"]
    assert lane["tick"].to_pylist() == [0, TICKS // 2]


def test_a_fall_is_marked_where_it_was(file, walk):
    ring = strip_m(file, "/sim/fall")
    middle = ring[:-1].mean(axis=0)
    place_m = balance(walk).below_m[-1]
    np.testing.assert_allclose(middle[:2], place_m[:2], atol=1e-3)
    height_m = walk.ground.height_at(*ring.T[:2])
    np.testing.assert_allclose(ring[:, 2], height_m + LIFT_M, atol=1e-6)
    (text,) = read(file, "/sim/fall")["LineStrips3D:labels"].to_pylist()
    assert text == ["fall at 0.68 s"]


@pytest.mark.parametrize("end", [None, "course walked", "left the ground"])
def test_what_is_no_fall_is_not_marked(tmp_path, end):
    write_rrd(tmp_path / "walk.rrd", [scene(end=end)])
    assert "/sim/fall" not in entities(tmp_path / "walk.rrd")


def test_many_scenes_share_the_room_in_tabs(tmp_path):
    path = tmp_path / "many.rrd"
    write_rrd(path, [scene(name) for name in ("sim", "real", "grounded", "corrected")])
    assert rerun("rrd", "verify", path).returncode == 0
    for name in ("sim", "real", "grounded", "corrected"):
        assert f"/{name}/balance/zmp" in entities(path)
