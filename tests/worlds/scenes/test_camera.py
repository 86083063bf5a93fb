import numpy as np
import pytest

from groundwalk.errors import BadValueError
from terrain import Heightfield
from worlds.scenes.camera import Camera
from worlds.scenes.colours import GRASS, SKY
from worlds.scenes.rays import SUN, Rounds, distances, in_sun

RED, BLUE = (220.0, 20.0, 20.0), (20.0, 20.0, 220.0)
FLAT = Heightfield(np.zeros((3, 3)), (-1.0, -1.0), 1.0)


def rounds(*shapes, glows=False):
    """Shapes of start, end, radius and colour."""
    start, end, radius, colour = (
        np.array(column, float) for column in zip(*shapes, strict=True)
    )
    return Rounds(start, end, radius, colour, np.full(len(radius), glows))


def ball(x, y, z, radius=0.1, colour=RED):
    return (x, y, z), (x, y, z), radius, colour


def camera(eye=(0.0, -10.0, 0.5), target=(0.0, 0.0, 0.5), size=(80, 80), **more):
    return Camera(eye, target, size, **{"view_rad": 0.08, **more})


def reddish(picture):
    red, _, blue = np.moveaxis(picture.astype(int), -1, 0)
    return red > blue + 60


def test_a_ball_is_a_disc_of_its_size_in_the_middle():
    seen = reddish(camera().picture(rounds(ball(0, 0, 0.5)), None))
    # 80 pixels show 2 * 10 * tan(0.04) m.
    pixel_m = 20 * np.tan(0.04) / 80
    assert seen.sum() * pixel_m**2 == pytest.approx(np.pi * 0.1**2, rel=0.03)
    rows, columns = np.nonzero(seen)
    assert rows.mean() == pytest.approx(39.5, abs=0.3)
    assert columns.mean() == pytest.approx(39.5, abs=0.3)


def test_right_and_up_are_where_they_belong():
    # Whoever looks along +y has +x on the right.
    rows, columns = np.nonzero(
        reddish(camera().picture(rounds(ball(0.2, 0, 0.6)), None))
    )
    assert columns.mean() > 50
    assert rows.mean() < 30


def test_what_is_nearer_hides_what_is_behind():
    far, near = ball(0, 0.5, 0.5, colour=BLUE), ball(0, -0.5, 0.5, 0.12)
    for shapes in ((far, near), (near, far)):
        picture = camera().picture(rounds(*shapes), None).astype(int)
        assert not (picture[..., 2] > picture[..., 0] + 60).any()


def test_what_is_behind_the_camera_or_unknown_is_not_seen():
    shapes = rounds(ball(0, -11, 0.5), ball(np.nan, 0, 0.5))
    assert (camera().picture(shapes, None) == SKY).all()


@pytest.mark.parametrize(
    ("start", "end", "expected"),
    [
        ((5, 0, -1), (5, 0, 1), 4.5),  # the side of an upright one
        ((5, 0, 0), (9, 0, 0), 4.5),  # its end, along the ray
        ((5, 0.4, 0), (5, 0.4, 0), 4.7),  # a ball off its middle: 5 - 0.3
        ((5, 0.6, -1), (5, 0.6, 1), np.inf),
        ((5, 0, 0.6), (5, 0, 2.0), np.inf),  # it begins above
    ],
)
def test_where_a_ray_meets_a_capsule(start, end, expected):
    ray = np.array([[1.0, 0.0, 0.0]])
    found = distances(np.zeros(3), ray, np.array(start), np.array(end), 0.5)
    np.testing.assert_allclose(found, [expected])


def test_shadows_lie_behind_what_is_round_and_nowhere_else():
    one = rounds(ball(0, 0, 1.0))
    places = np.array([[0, 0, 1.0]] * 3) + np.outer([-1.0, 1.0, 0.0], SUN)
    places[2] += (0.5, 0.0, 0.0)
    np.testing.assert_array_equal(in_sun(one, places), [0, 1, 1])
    glowing = one._replace(glows=np.array([True]))
    np.testing.assert_array_equal(in_sun(glowing, places), [1, 1, 1])


def test_the_side_of_a_capsule_that_faces_the_sun_is_lit():
    rod = rounds(((0, 0, 0), (0, 0, 1), 0.1, RED))
    outward = SUN * (1, 1, 0) / np.hypot(*SUN[:2])
    height = np.linspace(0, 1, 11)[:, np.newaxis] * (0, 0, 1)
    assert (in_sun(rod, height + 0.101 * outward) == 1).all()
    assert (in_sun(rod, height[:5] - 0.101 * outward) == 0).all()


def test_the_ground_is_a_chessboard_up_to_its_edge():
    down = camera(eye=(0.125, -0.5, 2.0), target=(0.125, 0.125, 0.0), view_rad=0.05)
    lit = down.picture(rounds(ball(0, 0, -9)), FLAT)
    hue = lit[40, 40] / np.array(GRASS[0], float)
    assert np.ptp(hue) < 0.02  # the square of x, y = 0.125, lighter or darker
    away = camera(target=(0.0, 0.0, 3.0))
    assert (away.picture(rounds(ball(0, 0, -9)), FLAT) == SKY).all()


def test_the_ground_is_met_where_its_height_is():
    heights = np.zeros((41, 41))
    heights[:, 20:] = 0.2  # a step at x = 0, the camera looks along +y
    step = Heightfield(heights, (-1.0, -1.0), 0.05)
    view = camera(eye=(0.0, -1.0, 1.4), target=(0.0, 0.0, 0.2), view_rad=0.3)
    for height_m, is_seen in ((0.1, False), (0.3, True)):
        shapes = rounds(ball(0.1, 0, height_m, 0.05))
        assert reddish(view.picture(shapes, step)).any() == is_seen


def test_marks_are_seen_through_everything_in_their_own_colour():
    below = rounds(ball(0, 0, -0.3, 0.05), glows=True)
    view = camera(eye=(0.0, -1.0, 1.4), target=(0.0, 0.0, 0.0), view_rad=0.5)
    assert (view.picture(below, FLAT) == RED).all(axis=-1).any()


@pytest.mark.parametrize(
    ("bad", "words"),
    [
        ({"size": (0, 5)}, "size_px"),
        ({"view_rad": 0.0}, "view_rad"),
        ({"eye": (0, 0, 2), "target": (0, 0, 1)}, "straight"),
    ],
)
def test_cameras_that_see_nothing(bad, words):
    with pytest.raises(BadValueError, match=words):
        camera(**bad)
