"""Real, sim and corrected sim on held-out recordings, as a Rerun file.

| entity | what |
|---|---|
| `real`, `sim`, `corrected` | the three robots, as in the first recording |
| `held_out/<recording>/<channel>/course` | lines: real, sim, corrected |
| `held_out/<recording>/<channel>/error` | lines: sim and corrected, less real |
"""

import hashlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from diagnosis.conclude.held_out_series import (
    ChannelSeries,
    HeldOutSeries,
    by_error,
)
from diagnosis.verdict.verdict import Fit
from experiments.seeing.scenes import scene_names
from robots.description import Description
from worlds import Recording, RecordingMetadata
from worlds.recordings.columns import vector_columns
from worlds.rerun_files.log import write_rrd
from worlds.scenes.colours import accent
from worlds.scenes.curves import Curve, Trace
from worlds.scenes.scene import Scene

COLOURS = {name: accent(index) for index, name in enumerate(ChannelSeries._fields)}
"""Those of the three robots."""
CHANNELS_PER_PAGE = 4
_POSE = (*vector_columns("base.position"), *vector_columns("base.orientation"))


def write_overlay(
    path: Path,
    series: Sequence[HeldOutSeries],
    fit: Fit | None = None,
    description: Description | None = None,
) -> None:
    """Write the file at once; the worst channels stand on the first pages.

    Args:
      path: the `.rrd` file.
      series: held-out recordings; at least one.
      fit: of the verdict, to say which channels are worst.
      description: of the robot, if its three versions shall stand side by side; they
        move as the first recording has it. A base that it lacks stays at the origin.

    Raises:
      BadValueError: there are no series.
    """
    pages: dict[str, Sequence[Curve]] = {}
    for one, name in zip(series, scene_names(one.name for one in series), strict=True):
        channels = by_error(one, fit)
        for start in range(0, len(channels), CHANNELS_PER_PAGE):
            some = channels[start : start + CHANNELS_PER_PAGE]
            page = f"{name} {start // CHANNELS_PER_PAGE + 1}"
            pages[page] = _curves(one, f"held_out/{name}", some)
    scenes = _scenes(series[0], description) if series and description else []
    write_rrd(path, scenes, _identity(series), pages)


def _curves(series: HeldOutSeries, at: str, channels: Sequence[str]) -> list[Curve]:
    """Course and error of each channel."""
    curves: list[Curve] = []
    for name, part in zip(channels, scene_names(channels), strict=True):
        real, sim, corrected = series.channels[name]
        for what, lines in (
            ("course", {"real": real, "sim": sim, "corrected": corrected}),
            ("error", {"sim": sim - real, "corrected": corrected - real}),
        ):
            colours = [COLOURS[line] for line in lines]
            values = np.stack([*lines.values()], axis=1)
            trace = Trace(f"{at}/{part}/{what}", [*lines], values, colours)
            curves.append((series.time_s, trace))
    return curves


def _scenes(series: HeldOutSeries, description: Description) -> list[Scene]:
    """The robot as it was, as the sim has it, and as the corrected sim has it."""
    joints = [f"position.{joint}" for joint in description.joints]
    names = [name for name in joints if name in series.channels]
    if not names:
        return []
    has_base = all(name in series.channels for name in _POSE)
    names += _POSE if has_base else ()
    base = "floating" if has_base else "fixed"
    metadata = RecordingMetadata(description.name, base, series.name)
    scenes = []
    for version in ChannelSeries._fields:
        columns = {name: getattr(series.channels[name], version) for name in names}
        columns["time"] = series.time_s
        # What drove the joints is shown nowhere, but a recording has to say it.
        drive = names[0].replace("position", "torque", 1)
        columns[drive] = np.full(series.time_s.size, np.nan)
        scenes.append(Scene(version, Recording(columns, metadata), description))
    return scenes


def _identity(series: Sequence[HeldOutSeries]) -> str:
    """32 hexadecimal digits that belong to these series."""
    content = hashlib.sha256()
    for one in series:
        content.update(one.name.encode() + one.time_s.tobytes())
        for name, channel in one.channels.items():
            content.update(name.encode() + np.stack(channel).tobytes())
    return content.hexdigest()[:32]
