"""Makes film strips (PNG) and films (GIF, MP4) of walks, as bytes of a file."""

import io
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from experiments.runs.progress import progress
from groundwalk.errors import GroundwalkError
from worlds.scenes.camera import Image
from worlds.scenes.colours import FALL, SKY, accent
from worlds.scenes.picture import SceneCamera
from worlds.scenes.scene import Scene
from worlds.world import FALLS

if TYPE_CHECKING:
    import PIL.Image

GIF_BYTES = 1_000_000
"""Size [bytes] above which a GIF is made again with fewer colours, down to 16."""

_GIF_COLOURS = (128, 64, 32, 16)
_AFTER_FALL_S = 0.7
"""Time that a film shows after a fall [s], in which the robot comes to lie."""

_TITLE_PX = 26
_TEXT_PX = 15
_INK = (40, 44, 52)


@dataclass(frozen=True, eq=False)
class Film:
    """The walks that a film shows, and which part of them.

    Attributes:
      scenes: the walks, from left to right.
      size_px: width and height of each walk's picture.
      start_s: first moment; None to show the fall or, without one, the walk's middle.
      duration_s: length of the part that is shown.
      with_balance: whether forces, support polygon, ZMP and centre of mass are drawn.
    """

    scenes: Sequence[Scene]
    size_px: tuple[int, int]
    start_s: float | None
    duration_s: float
    with_balance: bool

    @cached_property
    def cameras(self) -> list[SceneCamera]:
        """One camera for each scene; each shows its robot in another colour."""
        return [
            SceneCamera(scene, accent(index), self.size_px, self.with_balance)
            for index, scene in enumerate(self.scenes)
        ]

    def titled(self, index: int, time_s: float) -> Image:
        """Draw scene `index` at a time [s] (at most its last), with a title above."""
        scene = self.scenes[index]
        times_s = scene.recording.time_s
        tick = max(int(np.searchsorted(times_s, time_s + 1e-9, side="right")) - 1, 0)
        picture = self.cameras[index].picture(tick)
        is_over = time_s > times_s[-1] - 1e-9
        end = scene.recording.metadata.end if is_over else None
        shown_s = min(time_s, float(times_s[-1]))
        label = f"{end}, {shown_s:.1f} s" if end else f"{shown_s:.1f} s"
        name = scene.name.replace("/", ", ")
        return _with_title(picture, name, label, FALL if end in FALLS else _INK)

    def shown_s(self, scenes: Sequence[Scene]) -> tuple[float, float]:
        """First and last moment [s] of the part of these scenes that is shown."""
        if self.start_s is None:
            return window_s(scenes, self.duration_s)
        return self.start_s, self.start_s + self.duration_s


def window_s(scenes: Sequence[Scene], duration_s: float) -> tuple[float, float]:
    """First and last moment to show [s]: at the first fall, or in the middle."""
    first_s = min(float(scene.recording.time_s[0]) for scene in scenes)
    lasts_s = [float(scene.recording.time_s[-1]) for scene in scenes]
    falls_s = [
        last_s
        for scene, last_s in zip(scenes, lasts_s, strict=True)
        if scene.recording.metadata.end in FALLS
    ]
    if falls_s:
        last_s = min(falls_s) + min(_AFTER_FALL_S, duration_s / 4)
        return max(first_s, last_s - duration_s), last_s
    middle_s = (first_s + min(lasts_s)) / 2
    start_s = max(first_s, middle_s - duration_s / 2)
    return start_s, min(start_s + duration_s, max(lasts_s))


def strip_bytes(film: Film, frames: int) -> bytes:
    """Draw a PNG with a row of pictures, equally spaced in time, for each walk.

    If the film's `start_s` is None, each row has its own start, chosen so that the last
    picture shows the fall.
    """
    from PIL import Image as Pillow

    rows = []
    with progress("pictures", len(film.scenes) * frames) as bar:
        for index, scene in enumerate(film.scenes):
            start_s, stop_s = film.shown_s([scene])
            stop_s = min(stop_s, float(scene.recording.time_s[-1]))
            row = []
            for time_s in np.linspace(min(start_s, stop_s), stop_s, frames):
                row.append(film.titled(index, time_s))
                bar.advance()
            rows.append(np.hstack(row))
    file = io.BytesIO()
    Pillow.fromarray(np.vstack(rows)).save(file, "PNG", optimize=True)
    return file.getvalue()


def film_bytes(film: Film, rate_hz: float, suffix: str) -> bytes:
    """Make a film (".gif" or ".mp4") of all walks side by side, at the same times."""
    if suffix == ".mp4":
        _ffmpeg()
    start_s, stop_s = film.shown_s(film.scenes)
    times_s = np.arange(start_s, stop_s + 1e-9, 1 / rate_hz)
    frames = []
    with progress("pictures", len(times_s)) as bar:
        for time_s in times_s.tolist():
            shown = [film.titled(index, time_s) for index in range(len(film.scenes))]
            frames.append(np.hstack(shown))
            bar.advance()
    return _mp4(frames, rate_hz) if suffix == ".mp4" else gif_bytes(frames, rate_hz)


def _with_title(
    picture: Image, name: str, label: str, colour: tuple[int, int, int]
) -> Image:
    """Put a line above a picture: its name on the left, a label on the right."""
    from PIL import Image as Pillow
    from PIL import ImageDraw, ImageFont

    width = picture.shape[1]
    line = Pillow.new("RGB", (width, _TITLE_PX), SKY)
    draw = ImageDraw.Draw(line)
    font = ImageFont.load_default(_TEXT_PX)
    draw.text((8, _TITLE_PX / 2), name, fill=_INK, font=font, anchor="lm")
    draw.text((width - 8, _TITLE_PX / 2), label, fill=colour, font=font, anchor="rm")
    return np.vstack([np.asarray(line), picture])


def gif_bytes(frames: Sequence[Image], rate_hz: float) -> bytes:
    """Make a GIF file of all frames, with fewer colours if it is above `GIF_BYTES`.

    All frames share one palette, so that parts that do not change cost no bytes.
    """
    for colours in _GIF_COLOURS:
        content = _gif_of(frames, rate_hz, colours)
        if len(content) < GIF_BYTES:
            break
    return content


def _gif_of(frames: Sequence[Image], rate_hz: float, colours: int) -> bytes:
    from PIL import Image as Pillow

    some = np.vstack(frames[:: 1 + len(frames) // 5])
    palette = Pillow.fromarray(some).quantize(colours, kmeans=3)
    pictures: list[PIL.Image.Image] = [
        Pillow.fromarray(frame).quantize(palette=palette, dither=Pillow.Dither.NONE)
        for frame in frames
    ]
    file = io.BytesIO()
    pictures[0].save(
        file,
        "GIF",
        save_all=True,
        append_images=pictures[1:],
        duration=round(1000 / rate_hz),
        loop=0,
        optimize=True,
    )
    return file.getvalue()


def _ffmpeg() -> str:
    program = shutil.which("ffmpeg")
    if program is None:
        raise GroundwalkError(
            "an .mp4 needs the program ffmpeg, which is not on the PATH; install it, "
            "or write a .gif"
        )
    return program


def _mp4(frames: Sequence[Image], rate_hz: float) -> bytes:
    """Make an MP4 file in H.264, which every browser plays; odd sides lose a pixel."""
    height, width, _ = frames[0].shape
    even = [frame[: height // 2 * 2, : width // 2 * 2] for frame in frames]
    height, width, _ = even[0].shape
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "film.mp4")
        done = subprocess.run(
            [
                *(_ffmpeg(), "-loglevel", "error", "-f", "rawvideo"),
                *("-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", f"{rate_hz:g}"),
                *("-i", "-", "-c:v", "libx264", "-pix_fmt", "yuv420p"),
                *("-movflags", "+faststart", str(path)),
            ],
            input=np.stack(even).tobytes(),
            capture_output=True,
            check=False,
        )
        if done.returncode:
            said = done.stderr.decode(errors="replace").strip()
            raise GroundwalkError(f"ffmpeg could not write the film: {said}")
        return path.read_bytes()
