"""The shape of a piece of ground: heights on a grid with square cells."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import BoolArray, FloatArray, IntArray
from groundwalk.errors import BadValueError


@dataclass(frozen=True, eq=False)
class Heightfield:
    """Ground heights on a grid with square cells, and the surface through them.

    The world's x points forward (the walking direction), y to the left, z up.
    Between the samples the ground is made of flat triangles, two in each cell: the
    diagonal joins `heights_m[row, column]` with `heights_m[row + 1, column + 1]`,
    so that it runs in the direction (+x, +y). MuJoCo cuts its cells in this way
    (ray casts of version 4.0.0 agree to 1e-8 m), Bullet along the other diagonal,
    which becomes this one when its data and its body are turned by 90 degrees.

    Attributes:
      heights_m: heights z [m], shape (rows, columns), rows along +y and columns
        along +x; a read-only copy of the given array.
      origin_m: world (x, y) of `heights_m[0, 0]` [m].
      spacing_m: distance between neighbouring samples, along x and y [m].

    Example:
      >>> Heightfield(np.eye(2), (0.0, 0.0), 0.1).height_at(0.05, 0.0)
      array(0.5)
    """

    heights_m: FloatArray
    origin_m: tuple[float, float]
    spacing_m: float

    def __post_init__(self) -> None:
        """Check the numbers, and replace the heights by a read-only copy."""
        heights_m = np.array(self.heights_m, dtype=np.float64, order="C")
        if heights_m.ndim != 2 or min(heights_m.shape) < 2:
            raise BadValueError(
                f"heights_m needs at least 2 x 2 samples, not shape {heights_m.shape}"
            )
        if not np.isfinite(heights_m).all():
            raise BadValueError("heights_m holds values that are not finite")
        if not np.isfinite(self.origin_m).all():
            raise BadValueError(f"origin_m must be finite, not {self.origin_m}")
        if not 0.0 < self.spacing_m < np.inf:
            raise BadValueError(
                f"spacing_m must be positive and finite, not {self.spacing_m}"
            )
        heights_m.setflags(write=False)
        object.__setattr__(self, "heights_m", heights_m)

    @property
    def is_flat(self) -> bool:
        """Whether all heights are equal."""
        return bool((self.heights_m == self.heights_m[0, 0]).all())

    @property
    def x_range_m(self) -> tuple[float, float]:
        """World x of the grid's first and last column [m]."""
        columns = self.heights_m.shape[1]
        return self.origin_m[0], self.origin_m[0] + (columns - 1) * self.spacing_m

    @property
    def y_range_m(self) -> tuple[float, float]:
        """World y of the grid's first and last row [m]."""
        rows = self.heights_m.shape[0]
        return self.origin_m[1], self.origin_m[1] + (rows - 1) * self.spacing_m

    @property
    def vertices_m(self) -> FloatArray:
        """World positions of the samples [m], shape (rows * columns, 3), row by row."""
        rows, columns = self.heights_m.shape
        x_m = self.origin_m[0] + self.spacing_m * np.arange(columns)
        y_m = self.origin_m[1] + self.spacing_m * np.arange(rows)
        grid_x_m, grid_y_m = np.meshgrid(x_m, y_m)
        return np.stack([grid_x_m, grid_y_m, self.heights_m], axis=-1).reshape(-1, 3)

    @property
    def triangles(self) -> IntArray:
        """Corners of all triangles as rows of `vertices_m`, shape (triangles, 3).

        The corners run counter-clockwise seen from above.
        """
        rows, columns = self.heights_m.shape
        index = np.arange(rows * columns).reshape(rows, columns)
        near, far = index[:-1, :-1], index[1:, 1:]
        right, left = index[:-1, 1:], index[1:, :-1]
        corners = np.stack([near, right, far, near, far, left], axis=-1)
        return corners.reshape(-1, 3)

    def contains(self, x_m: npt.ArrayLike, y_m: npt.ArrayLike) -> BoolArray:
        """Whether points (x, y) [m] lie within the grid, its edge included."""
        x_m, y_m = np.asarray(x_m, np.float64), np.asarray(y_m, np.float64)
        (x_low, x_high), (y_low, y_high) = self.x_range_m, self.y_range_m
        return np.asarray(
            (x_m >= x_low) & (x_m <= x_high) & (y_m >= y_low) & (y_m <= y_high)
        )

    def height_at(self, x_m: npt.ArrayLike, y_m: npt.ArrayLike) -> FloatArray:
        """Height of the ground's surface at points x, y [m], whose shapes broadcast.

        Outside of the grid it is the height of the nearest point of the edge; NaN where
        a coordinate is NaN.
        """
        rows, columns = self.heights_m.shape
        column, u = self._cell(x_m, self.origin_m[0], columns)
        row, v = self._cell(y_m, self.origin_m[1], rows)
        near, far = self.heights_m[row, column], self.heights_m[row + 1, column + 1]
        right, left = self.heights_m[row, column + 1], self.heights_m[row + 1, column]
        return np.where(
            u >= v,
            near + u * (right - near) + v * (far - right),
            near + v * (left - near) + u * (far - left),
        )

    def _cell(
        self, position_m: npt.ArrayLike, origin_m: float, samples: int
    ) -> tuple[IntArray, FloatArray]:
        """Index of the nearest cell to a coordinate, and the place in it, 0 to 1."""
        position_m = np.asarray(position_m, np.float64)
        cells = np.clip((position_m - origin_m) / self.spacing_m, 0.0, samples - 1)
        index = np.minimum(np.nan_to_num(cells).astype(np.intp), samples - 2)
        return index, cells - index
