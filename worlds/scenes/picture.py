"""Draws scenes as pictures: the robot, its ground and the marks of its balance."""

import numpy as np
from scipy.ndimage import gaussian_filter1d

from groundwalk.arrays import FloatArray
from robots.description import Foot
from worlds.scenes import colours
from worlds.scenes.balance import Balance, balance
from worlds.scenes.camera import Camera, Image
from worlds.scenes.rays import Rounds
from worlds.scenes.scene import SIDES, Scene
from worlds.scenes.shapes import shape_colours

_EYE_M = (1.25, -1.55, 0.62)
"""Place of the camera relative to its target [m]: ahead, to the right and above. It is
for a NAO and is scaled with the robot's size."""

_MIDDLE_M = 0.27
"""Height of the camera's target above the lowest sole [m], for a NAO (0.57 m tall); it
is scaled with the robot's size."""

_VIEW_RAD = 0.34
"""Angle of view from the lower to the upper edge of a picture [rad]: a NAO with both
arms stretched out fits in."""

_STEADY_S = 0.3
"""Standard deviation [s] of the Gaussian that smooths the motion of the camera."""

_SOLE_M, _LINE_M, _POINT_M, _ARROW_M = 0.006, 0.0025, 0.009, 0.005
"""Radii [m] of the capsules that draw a sole (of a NAO), lines, points and arrows."""


class SceneCamera:
    """A camera that follows a scene's robot; robots of all sizes look equally large.

    Attributes:
      parts: names of the robot's links, and capsules that draw them, in their frames.

    Example:
      >>> SceneCamera(scene, colours.accent(0), (320, 240)).picture(tick=0).shape
      (240, 320, 3)
    """

    def __init__(
        self,
        scene: Scene,
        accent: colours.Colour,
        size_px: tuple[int, int],
        with_balance: bool = False,
    ) -> None:
        """Compute the link poses and the camera's target at each tick.

        The colour `accent` marks this robot. `with_balance` draws the forces at the
        feet, support polygon, zero-moment point, centre of mass and its path, too.
        """
        self._scene, self._size_px = scene, size_px
        self._poses = scene.link_poses()
        self.parts = _parts(scene, accent)
        self._size = scene.description.scale.length
        self._balance: Balance | None = None
        if scene.description.feet:
            found = balance(scene)
            self._balance = found if with_balance else None
            middle_m = found.below_m + np.array([0.0, 0.0, _MIDDLE_M * self._size])
        else:
            places_m = np.stack([pose.position_m for pose in self._poses.values()])
            middle_m = places_m.mean(axis=0)
            if not scene.recording.has("base.position"):
                middle_m[:] = np.nanmean(middle_m, axis=0)
        self._target_m = _steadied(middle_m, scene.recording.time_s)

    def picture(self, tick: int) -> Image:
        """Draw the picture (height, width, 3) at a tick, a row of the recording.

        Links whose pose is unknown at this tick are left out.
        """
        target_m = self._target_m[tick]
        eye_m = target_m + np.array(_EYE_M) * self._size
        camera = Camera(tuple(eye_m), tuple(target_m), self._size_px, _VIEW_RAD)
        groups = [self._placed(link, rounds, tick) for link, rounds in self.parts]
        if self._balance is not None:
            groups += self._marks(self._balance, tick)
        whole = (np.concatenate(column) for column in zip(*groups, strict=True))
        return camera.picture(Rounds(*whole), self._scene.ground)

    def _placed(self, link: str, rounds: Rounds, tick: int) -> Rounds:
        """Move capsules from a link's frame into the world."""
        pose = self._poses[link].at(tick)
        start_m, end_m = pose.points(rounds.start_m)[0], pose.points(rounds.end_m)[0]
        return rounds._replace(start_m=start_m, end_m=end_m)

    def _marks(self, found: Balance, tick: int) -> list[Rounds]:
        """Forces, balance points and support polygon, in colours without shading."""
        marks = [_line(found.centre_of_mass_m[: tick + 1 : 3], colours.MASS)]
        for places_m, colour in (
            (found.centre_of_mass_m, colours.MASS),
            (found.pressure_m, colours.FORCE),
            (found.zmp_m, colours.ZMP),
        ):
            if places_m is not None:
                at_m = places_m[[tick]]
                marks.append(_rounds(at_m, at_m, _POINT_M, colour, glow=True))
        if found.polygons_m is not None and len(found.polygons_m[tick]):
            corners = found.polygons_m[tick]
            rim_m = np.vstack([corners, corners[:1]])
            marks.append(_line(rim_m, colours.SUPPORT_POLYGON))
        robot = self._scene.description
        for side, foot in zip(SIDES, robot.feet, strict=True):
            sensors = self._scene.sensor_forces_n(side)
            if sensors is not None:
                link = robot.links[foot.joint].link.name
                marks.append(self._placed(link, self._arrows(*sensors, tick), tick))
        return marks

    def _arrows(self, points_m: FloatArray, forces_n: FloatArray, tick: int) -> Rounds:
        """Arrows in a foot's frame for the forces that press on its sensors."""
        pressing = forces_n[tick] > 0
        length_m = self._scene.arrow_m_per_n * forces_n[tick, pressing]
        start_m = points_m[pressing]
        end_m = start_m + length_m[:, np.newaxis] * (0.0, 0.0, 1.0)
        return _rounds(start_m, end_m, _ARROW_M, colours.FORCE, glow=True)


def _parts(scene: Scene, accent: colours.Colour) -> list[tuple[str, Rounds]]:
    """Capsules of all links that have shapes, and of the soles, by the link's name."""
    robot = scene.description
    parts = []
    for link in (robot.root, *(joint.link for joint in robot.links)):
        if link.shapes:
            rounds = Rounds(
                np.array([shape.start_m for shape in link.shapes]),
                np.array([shape.end_m for shape in link.shapes]),
                np.array([shape.radius_m for shape in link.shapes]),
                shape_colours(link.shapes, accent).astype(float),
                np.zeros(len(link.shapes), bool),
            )
            parts.append((link.name, rounds))
    for foot in robot.feet:
        sole = _sole(foot, _SOLE_M * robot.scale.length, accent)
        parts.append((robot.links[foot.joint].link.name, sole))
    return parts


def _sole(foot: Foot, radius_m: float, colour: colours.Colour) -> Rounds:
    """Fill a sole with capsules: around its outline, and side by side across it."""
    outline_m = foot.outline_m
    low_m, high_m = outline_m[:, 0].min(), outline_m[:, 0].max()
    bars = max(int((high_m - low_m) / (1.5 * radius_m)), 1)
    x_m = np.linspace(low_m, high_m, bars + 2)[1:-1, np.newaxis]
    (x0, y0), (x1, y1) = outline_m.T, np.roll(outline_m, -1, axis=0).T
    with np.errstate(divide="ignore", invalid="ignore"):
        part = (x_m - x0) / (x1 - x0)
    # Each bar's line meets two edges of the outline, which is convex.
    y_m = np.where((part >= 0) & (part <= 1), y0 + part * (y1 - y0), np.nan)
    low, high = (
        np.hstack([x_m, pick(y_m, axis=1)[:, np.newaxis]])
        for pick in (np.nanmin, np.nanmax)
    )
    start_m = np.vstack([outline_m, low])
    end_m = np.vstack([np.roll(outline_m, -1, axis=0), high])
    height_m = np.full((len(start_m), 1), foot.sole_height_m + radius_m)
    start_m, end_m = np.hstack([start_m, height_m]), np.hstack([end_m, height_m])
    return _rounds(start_m, end_m, radius_m, colour, glow=False)


def _rounds(
    start_m: FloatArray,
    end_m: FloatArray,
    radius_m: float,
    colour: colours.Colour,
    glow: bool,
) -> Rounds:
    """Capsules with axis ends (n, 3) that have the same radius and colour."""
    count = len(start_m)
    painted = np.tile(np.array(colour, float), (count, 1))
    radii_m, glows = np.full(count, radius_m), np.full(count, glow)
    return Rounds(start_m, end_m, radii_m, painted, glows)


def _line(points_m: FloatArray, colour: colours.Colour) -> Rounds:
    return _rounds(points_m[:-1], points_m[1:], _LINE_M, colour, glow=True)


def _steadied(place_m: FloatArray, time_s: FloatArray) -> FloatArray:
    """(ticks, 3) places [m], smoothed over `_STEADY_S`; NaN ones are interpolated."""
    known = np.flatnonzero(np.isfinite(place_m).all(axis=1))
    if not known.size:
        return np.zeros_like(place_m)
    rows = np.arange(len(place_m))
    whole_m = np.stack([np.interp(rows, known, axis[known]) for axis in place_m.T], 1)
    if time_s.size < 2:
        return whole_m
    ticks = _STEADY_S / float(np.median(np.diff(time_s)))
    return np.asarray(gaussian_filter1d(whole_m, ticks, axis=0, mode="nearest"))
