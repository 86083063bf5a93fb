import numpy as np
import pytest
from rrd_files import scene, walk_columns

from terrain import make
from worlds.scenes import colours
from worlds.scenes.picture import SceneCamera
from worlds.scenes.rays import axis_part

BLUE = (20, 60, 230)
SIZE_PX = (90, 80)


def blueish(picture):
    red, _, blue = np.moveaxis(picture.astype(int), -1, 0)
    return blue > red + 60


@pytest.fixture(scope="module")
def walk():
    return scene(ground=make("flat", 0))


def test_a_robot_stands_on_its_ground_below_the_sky(walk):
    picture = SceneCamera(walk, BLUE, SIZE_PX).picture(0)
    assert picture.shape == (80, 90, 3)
    assert picture.dtype == np.uint8
    assert (picture[0, :20] == colours.SKY).all()
    red, green, _ = picture[-1, 0].astype(int)
    assert green > red + 10
    assert 20 < blueish(picture).sum() < 1000


def test_the_camera_goes_with_the_robot(walk):
    camera = SceneCamera(walk, BLUE, SIZE_PX)
    middles = []
    for tick in (0, walk.recording.ticks - 1):
        _, columns = np.nonzero(blueish(camera.picture(tick)))
        middles.append(columns.mean())
    np.testing.assert_allclose(middles, 45, atol=15)


def test_the_same_tick_gives_the_same_picture(walk):
    first, second = (SceneCamera(walk, BLUE, SIZE_PX).picture(9) for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_balance_is_drawn_when_asked(walk):
    def has(colour, **wish):
        picture = SceneCamera(walk, BLUE, (300, 260), **wish).picture(20)
        return (picture == colour).all(axis=-1).any()

    for colour in (colours.FORCE, colours.SUPPORT_POLYGON):
        assert has(colour, with_balance=True)
        assert not has(colour)


def test_of_a_tick_with_a_missing_value_the_rest_is_drawn():
    columns = walk_columns()
    columns["position.LKneePitch"][5] = np.nan
    columns["base.position.x"][9] = np.nan
    camera = SceneCamera(scene(columns=columns), BLUE, SIZE_PX)
    part, whole = (blueish(camera.picture(tick)).sum() for tick in (5, 6))
    assert 0 < part < whole
    assert (camera.picture(9) == colours.SKY).all()


def test_a_sole_is_a_plate_without_holes():
    """Seen from above, every point of the outline is covered in the robot's colour."""
    columns = walk_columns()
    robot = scene(columns=columns)
    camera = SceneCamera(robot, BLUE, SIZE_PX)
    for foot in robot.description.feet:
        link = robot.description.links[foot.joint].link.name
        bars = [
            (start, end, radius)
            for name, rounds in camera.parts
            if name == link
            for start, end, radius, colour, _ in zip(*rounds, strict=True)
            if tuple(colour) == BLUE
        ]
        start, end, radius = (np.array(column) for column in zip(*bars, strict=True))
        middle = foot.outline_m.mean(axis=0)
        for share in (0.0, 0.3, 0.6, 0.9):
            places = middle + share * (foot.outline_m - middle)
            for place in places:
                spot = np.tile(place, (len(start), 1))
                along = axis_part(spot, start[:, :2], end[:, :2])
                axis = start[:, :2] + along * (end - start)[:, :2]
                assert (np.linalg.norm(spot - axis, axis=1) <= radius).any()
