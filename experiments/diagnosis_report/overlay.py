"""Writes a Rerun file: real robot, sim and corrected sim on held-out recordings.

| entity | content |
|---|---|
| `real`, `sim`, `corrected` | the three robots, moving as in the first recording |
| `held_out/<recording>/<channel>/course` | lines: real, sim, corrected; SI units |
| `held_out/<recording>/<channel>/error` | lines: sim - real, corrected - real |
| `held_out/<recording>/state/...` | verdict, stalls, pulses and wrong samples |

The unit of an error, such as mrad, is in its plot's title. Time 0 is the start of each
held-out part, which may be seconds after the start of its recording.
"""

import hashlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from diagnosis.conclude.held_out_series import ChannelSeries, HeldOutSeries, by_error
from diagnosis.traces.time_line import Stretch
from diagnosis.verdict import Fit
from experiments.diagnosis_report.numbers import error_unit, unit_text
from experiments.diagnosis_report.time_line_figure import EVENTS
from experiments.seeing.scenes import scene_names
from robots.description import Description
from worlds import Recording, RecordingMetadata
from worlds.recordings.recording import vector_columns
from worlds.rerun_files.log import write_rrd
from worlds.scenes.colours import accent
from worlds.scenes.curves import Curve, Trace
from worlds.scenes.lanes import Lane, lane_of
from worlds.scenes.scene import Scene

COLOURS = {name: accent(index) for index, name in enumerate(ChannelSeries._fields)}
"""Colours of robots and lines, by version ("real", "sim" or "corrected")."""
CHANNELS_PER_PAGE = 4
"""Number of channels on one tab of the viewer, each with two plots: as fit a screen."""
_POSE = (*vector_columns("base.position"), *vector_columns("base.orientation"))


def write_overlay(
    path: Path,
    series: Sequence[HeldOutSeries],
    fit: Fit | None = None,
    description: Description | None = None,
    time_line: Sequence[Stretch] = (),
    verdict: str = "",
) -> None:
    """Write the file: a tab for each recording and quantity, the worst channels first.

    Args:
      path: the `.rrd` file.
      series: held-out recordings; at least one.
      fit: the verdict's held-out errors, which give the order of the channels and
        their units.
      description: the robot model, whose real, sim and corrected versions move side by
        side as in the first recording; None for curves only. A base that was not
        recorded stays at the origin.
      time_line: what happened in the recordings, shown above their curves.
      verdict: the verdict in some words, shown there, too; "" leaves it out.

    Raises:
      BadValueError: there are no series.

    Example:
      >>> write_overlay(Path("overlay.rrd"), found.held_out(), found.verdict.fit)
    """
    pages: dict[str, Sequence[Curve]] = {}
    lanes: dict[str, Sequence[Lane]] = {}
    for one, name in zip(series, scene_names(one.name for one in series), strict=True):
        for kind, channels in _by_kind(by_error(one, fit)).items():
            for start in range(0, len(channels), CHANNELS_PER_PAGE):
                some = channels[start : start + CHANNELS_PER_PAGE]
                page = f"{one.name}: {kind} {start + 1} to {start + len(some)}"
                pages[page] = _curves(one, f"held_out/{name}", some, fit)
                at = f"held_out/{name}/state"
                lanes[page] = state_lanes(one, time_line, verdict, at)
    scenes = _scenes(series[0], description) if series and description else []
    write_rrd(path, scenes, _identity(series), pages, lanes)


def state_lanes(
    series: HeldOutSeries, time_line: Sequence[Stretch], verdict: str, at: str
) -> list[Lane]:
    """Lanes of the verdict and of each kind of event in a held-out recording.

    Times count from the start of its held-out part; the lanes are below the path `at`.
    """
    first_s, last_s = float(series.time_s[0]), float(series.time_s[-1])
    spans = dict[str, list[tuple[float, float, str]]]()
    for one in time_line:
        inside = one.start_s <= last_s and one.end_s >= first_s
        if one.recording == series.recording and one.what in EVENTS and inside:
            start_s, end_s = max(one.start_s, first_s), min(one.end_s, last_s)
            state = " ".join(filter(None, (one.channel, one.why))) or one.what
            own = start_s - first_s, end_s - first_s, state
            spans.setdefault(one.what, []).append(own)
    lanes = [Lane(f"{at}/verdict", [(0.0, verdict)])] if verdict else []
    names = scene_names(spans)
    return lanes + [
        lane_of(f"{at}/{name}", own)
        for name, own in zip(names, spans.values(), strict=True)
    ]


def _by_kind(channels: Sequence[str]) -> dict[str, list[str]]:
    """Group channels by quantity, such as "position", in the order given."""
    groups: dict[str, list[str]] = {}
    for channel in channels:
        groups.setdefault(channel.partition(".")[0], []).append(channel)
    return groups


def _curves(
    series: HeldOutSeries, at: str, channels: Sequence[str], fit: Fit | None
) -> list[Curve]:
    """Curves of each channel's values and of its errors."""
    curves: list[Curve] = []
    for name, part in zip(channels, scene_names(channels), strict=True):
        real, sim, corrected = series.channels[name]
        errors = np.stack([sim - real, corrected - real], axis=1)
        known = fit.channels.get(name) if fit else None
        unit = known.unit if known else ""
        factor, small = error_unit(unit, float(np.nanmax(np.abs(errors), initial=0.0)))
        courses = np.stack([real, sim, corrected], axis=1)
        for what, lines, values, title in (
            ("course", COLOURS, courses, f"{name}{_in(unit_text(unit))}"),
            ("error", list(COLOURS)[1:], factor * errors, f"error{_in(small)}"),
        ):
            colours = [COLOURS[line] for line in lines]
            trace = Trace(f"{at}/{part}/{what}", [*lines], values, colours)
            curves.append(Curve(title, series.time_s - series.time_s[0], trace))
    return curves


def _in(unit: str) -> str:
    """A unit in brackets, to append to a title; "" without a unit."""
    return f" [{unit}]" if unit else ""


def _scenes(series: HeldOutSeries, description: Description) -> list[Scene]:
    """Scenes of the robot as recorded, as in the sim, and as in the corrected sim."""
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
        columns["time"] = series.time_s - series.time_s[0]
        # A recording must have a command or a torque, although none is shown here.
        drive = names[0].replace("position", "torque", 1)
        columns[drive] = np.full(series.time_s.size, np.nan)
        scenes.append(Scene(version, Recording(columns, metadata), description))
    return scenes


def _identity(series: Sequence[HeldOutSeries]) -> str:
    """A hash of the series, 32 hexadecimal digits, as identity of the Rerun file."""
    content = hashlib.sha256()
    for one in series:
        content.update(one.name.encode() + one.time_s.tobytes())
        for name, channel in one.channels.items():
            content.update(name.encode() + np.stack(channel).tobytes())
    return content.hexdigest()[:32]
