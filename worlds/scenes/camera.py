"""Draws round shapes on uneven ground by tracing rays in NumPy.

A quadratic equation gives the place where a ray meets a capsule, a fixed-point
iteration that where it meets nearly level ground. Light comes from one sun, with
shadows, and from the sky.

The engines' own renderers are not good enough. PyBullet's ER_TINY_RENDERER (3.2.7) puts
large parts of a heightfield into wrong shadow, gives all of the ground one colour and
shows capsules with corners; `mujoco.Renderer` needs a graphics driver. These pictures
need none, and have the same bytes on each run.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from terrain import Heightfield
from worlds.scenes.colours import SKY
from worlds.scenes.rays import SUN, Rounds, axis_part, distances, in_sun
from worlds.scenes.shapes import chessboard

Image = npt.NDArray[np.uint8]
"""Picture as an array (height, width, 3) of red, green and blue from 0 to 255."""

SHADE, SUNLIGHT = 0.62, 0.50
"""Factors on a surface's colour: in the sky's light alone, and the share that full sun
adds; both chosen by eye."""

SHINE, SHINE_POWER = 50.0, 40
"""Brightness (0 to 255) and exponent of the Blinn-Phong highlights; chosen by eye."""

HAZE_M = (1.6, 5.0)
"""Distances behind the camera's target at which the ground begins to fade into the sky
and at which it is gone [m]."""

_GROUND_STEPS = 3
"""Iterations to find where a ray meets uneven ground; more change nothing visibly."""

_SEEN_THROUGH = 1e-3
"""Factor on the distance to glowing marks: as the nearest shapes, they stay visible."""

_PER_PIXEL = 2
"""Rays along each side of a pixel, 2 x 2 in all: their mean makes edges smooth."""


@dataclass(frozen=True)
class Camera:
    """A camera at `eye_m` in the world, with `target_m` in the middle of its pictures.

    The pictures have a width and height in `size_px`; the angle of view is that from
    their lower to their upper edge.
    """

    eye_m: tuple[float, float, float]
    target_m: tuple[float, float, float]
    size_px: tuple[int, int]
    view_rad: float = 0.5

    def __post_init__(self) -> None:
        """Refuse empty pictures, impossible angles, views straight up or down."""
        if min(self.size_px) < 1:
            raise BadValueError(f"size_px is {self.size_px}; both must be positive")
        if not 0 < self.view_rad < np.pi:
            raise BadValueError(f"view_rad is {self.view_rad}; between 0 and pi")
        ahead = np.subtract(self.target_m, self.eye_m)
        if not np.hypot(ahead[0], ahead[1]) > 1e-6:
            raise BadValueError("a camera must not look straight up or down")

    def axes(self) -> FloatArray:
        """(3, 3) unit vectors to the camera's right, down and ahead, a row each."""
        ahead = np.subtract(self.target_m, self.eye_m)
        ahead /= np.linalg.norm(ahead)
        right = np.cross(ahead, (0.0, 0.0, 1.0))
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(ahead, right), ahead])

    def picture(self, rounds: Rounds, ground: Heightfield | None) -> Image:
        """Draw capsules, the ground (None for none) and the sky behind them."""
        return _Picture(self, rounds, ground).image()


class _Picture:
    """A picture that is being computed: for each ray, the nearest shape it meets."""

    def __init__(
        self, camera: Camera, rounds: Rounds, ground: Heightfield | None
    ) -> None:
        width, height = (_PER_PIXEL * side for side in camera.size_px)
        self._focal = 0.5 * height / np.tan(camera.view_rad / 2)
        self._axes, self._eye = camera.axes(), np.array(camera.eye_m)
        self._far_m = float(np.linalg.norm(np.subtract(camera.target_m, self._eye)))
        across = (np.arange(width) + 0.5 - width / 2) / self._focal
        down = (np.arange(height) + 0.5 - height / 2) / self._focal
        rays = across[:, np.newaxis] * self._axes[0] + self._axes[2]
        rays = rays + down[:, np.newaxis, np.newaxis] * self._axes[1]
        self._rays = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
        self._depth = np.full((height, width), np.inf)
        self._owner = np.full((height, width), -1, np.intp)
        self._rounds, self._ground = rounds, ground

    def image(self) -> Image:
        for i in range(len(self._rounds.radius_m)):
            self._meet(i)
        image = np.empty((*self._depth.shape, 3))
        image[:] = SKY
        if self._ground is not None:
            self._paint_ground(image, self._ground)
        self._paint_rounds(image)
        height, width, _ = image.shape
        cells = image.reshape(
            height // _PER_PIXEL, _PER_PIXEL, width // _PER_PIXEL, _PER_PIXEL, 3
        )
        mean = np.rint(cells.mean(axis=(1, 3)))
        return np.asarray(np.clip(mean, 0, 255), np.uint8)

    def _meet(self, i: int) -> None:
        """Assign to capsule `i` the rays that meet it nearer than any one before."""
        start, end = self._rounds.start_m[i], self._rounds.end_m[i]
        radius = float(self._rounds.radius_m[i])
        window = self._window(np.stack([start, end]), radius)
        if window is None:
            return
        depth = distances(self._eye, self._rays[window], start, end, radius)
        if self._rounds.glows[i]:
            depth *= _SEEN_THROUGH
        nearer = depth < self._depth[window]
        self._depth[window][nearer] = depth[nearer]
        self._owner[window][nearer] = i

    def _window(
        self, ends_m: FloatArray, radius_m: float
    ) -> tuple[slice, slice] | None:
        """Rows and columns of rays that can meet a capsule with axis ends (2, 3)."""
        x, y, ahead = self._axes @ (ends_m - self._eye).T
        nearest_m = ahead.min() - radius_m
        if not nearest_m > 0.01:  # behind the camera, or NaN: unknown at this tick
            return None
        height, width = self._depth.shape
        reach = self._focal * radius_m / nearest_m * 1.3 + 1
        column = self._focal * x / ahead + width / 2
        row = self._focal * y / ahead + height / 2
        left, right = _inside(column, reach, width)
        top, bottom = _inside(row, reach, height)
        if left >= right or top >= bottom:
            return None
        return slice(top, bottom), slice(left, right)

    def _paint_ground(self, image: FloatArray, ground: Heightfield) -> None:
        rays = self._rays
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = (ground.heights_m.mean() - self._eye[2]) / rays[..., 2]
        hit = (rays[..., 2] < 0) & (depth < self._far_m + HAZE_M[1])
        rays, depth = rays[hit], depth[hit]
        for _ in range(1 if ground.is_flat else _GROUND_STEPS):
            x, y = (self._eye + depth[:, np.newaxis] * rays).T[:2]
            height_m = ground.height_at(x, y)
            depth = (height_m - self._eye[2]) / rays[:, 2]
        place_m = self._eye + depth[:, np.newaxis] * rays
        seen = ground.contains(*place_m.T[:2]) & (depth < self._depth[hit])
        rows, columns = (index[seen] for index in np.nonzero(hit))
        place_m, depth = place_m[seen], depth[seen]
        normal = _normals(ground, place_m)
        light = self._light(place_m, normal)
        near, far = (self._far_m + part for part in HAZE_M)
        haze = np.clip((depth - near) / (far - near), 0, 1)[:, np.newaxis]
        colour = light[:, np.newaxis] * chessboard(place_m)
        image[rows, columns] = (1 - haze) * colour + haze * np.array(SKY)
        self._owner[rows, columns] = -1

    def _paint_rounds(self, image: FloatArray) -> None:
        """Colour the pixels whose rays meet a capsule before anything else."""
        rows, columns = np.nonzero(self._owner >= 0)
        owner = self._owner[rows, columns]
        rays = self._rays[rows, columns]
        place_m = self._eye + self._depth[rows, columns, np.newaxis] * rays
        start, end = self._rounds.start_m[owner], self._rounds.end_m[owner]
        normal = place_m - (start + axis_part(place_m, start, end) * (end - start))
        normal /= self._rounds.radius_m[owner, np.newaxis]
        light = self._light(place_m, normal)
        half = SUN - rays
        half /= np.linalg.norm(half, axis=1, keepdims=True)
        shine = np.clip(np.sum(normal * half, axis=1), 0, 1) ** SHINE_POWER
        shine *= SHINE * (light > SHADE)
        colour = self._rounds.colour[owner]
        glows = self._rounds.glows[owner, np.newaxis]
        lit = light[:, np.newaxis] * colour + shine[:, np.newaxis]
        image[rows, columns] = np.where(glows, colour, lit)

    def _light(self, place_m: FloatArray, normal: FloatArray) -> FloatArray:
        """(n,) brightness, about 1 in full sun, at places (n, 3) of normals (n, 3)."""
        toward_sun = np.clip(normal @ SUN, 0, 1)
        sky = SHADE * (0.8 + 0.2 * normal[:, 2])
        sun = in_sun(self._rounds, place_m + 0.002 * normal)
        return np.asarray(sky + SUNLIGHT * toward_sun * sun)


def _inside(places: FloatArray, reach: float, size: int) -> tuple[int, int]:
    """First and last + 1 of `size` pixels from places.min() - reach to max + reach."""
    first = np.clip(np.floor(places.min() - reach), 0, size)
    return int(first), int(np.clip(np.ceil(places.max() + reach), 0, size))


def _normals(ground: Heightfield, place_m: FloatArray) -> FloatArray:
    """(n, 3) upward unit normals of the ground at places (n, 3) [m] on it."""
    x, y, z = place_m.T
    normal = np.tile([0.0, 0.0, 1.0], (len(place_m), 1))
    if not ground.is_flat:
        step = ground.spacing_m / 2
        normal[:, 0] = z - ground.height_at(x + step, y)
        normal[:, 1] = z - ground.height_at(x, y + step)
        normal[:, 2] = step
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return normal
