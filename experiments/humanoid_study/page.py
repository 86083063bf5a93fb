"""Page and picture of `groundwalk humanoids`: which robots walk, and why some fall."""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from experiments.reports.origin import Origin
from experiments.reports.report import Report, markdown_table, write_figure
from experiments.reports.statistics import wilson
from experiments.runs.folder import RunFolder
from experiments.runs.gait_files import short_name
from experiments.seeing.scenes import make_scenes
from experiments.seeing.walk_figure import walk_figure
from experiments.seeing.walk_strip import walk_strip
from worlds import Recording

TITLE = "Which other humanoids walk 5 s after a short search?"
PICTURE = "humanoids.png"
PANELS_IN_A_ROW = 3
DOTS_PER_INCH = 80
"""Resolution of the picture: three panels of 5 inches are then 1200 pixels wide, which
fits a page."""

COLUMNS = [
    "robot", "mass [kg]", "size", "speed [cm/s]", "falls", "fall rate, 95 % interval",
    "untuned", "real: falls", "real: untuned", "sole", "sole off by",
    "busiest motor",
]  # fmt: skip
NOTES = (
    "Size is the height of the hips in units of the NAO's. Speed is the mean over the "
    "walks on flat ground in the sim, from start poses whose joints spread by "
    "0.01 rad; falls and their rate are of those walks, with Wilson's interval. "
    "Untuned: falls, in the same walks, of the gait that the search starts from. "
    "Real: falls in the real world, with the NAO's latency, sensor noise and lumps, "
    "which the searches do not know.",
    "Sole: its length and width in units of the NAO's, scaled to the robot's size. "
    "Sole off by: how far the joints' ranges keep the tuned gait's soles from their "
    "place, and from level. The busiest motor is the one that is at its limit for the "
    "largest share of the first walk.",
    "No robot has parameters of its own. Legs, soles, motors and sizes follow from "
    "each file. Only the file of `simple_humanoid` has no feet, and joint ranges that "
    "no leg can have: its sole and its ranges are in `robots/simple_humanoid.toml`. "
    "`simple_humanoid_as_is` has the same sole and the ranges of the file.",
)
_FAR_M, _TILTED_RAD, _OFTEN = 0.02, math.radians(10), 0.5
"""Limits above which a measure is named as a cause of falls: distance of a foot from
its target [m], tilt of a sole [rad], share of time that a motor is at its limit. They
are higher than the values of robots that walk: Romeo's soles tilt by up to 7 degrees,
and one of its motors is at its limit for 45 % of the time."""

Result = Mapping[str, Mapping[str, Any]]
"""Measures of each robot, by its name, as in the run's `result.json`."""


def write_humanoids_page(folder: RunFolder, result: Result) -> None:
    """Write the report page of a run of `groundwalk humanoids` into its folder."""
    columns, rows = robot_rows(result)
    body = [*markdown_table(columns, rows), ""]
    for note in NOTES:
        body += [note, ""]
    body += [f"![The first walk of each tuned gait in the sim]({PICTURE})", ""]
    Report(TITLE, list(answer(result)), body, Origin.of_run(folder)).write(folder.path)


def draw_humanoids(recordings: Mapping[str, Recording], path: Path) -> None:
    """Draw one recorded walk of each robot into a PNG file, three side by side."""
    strips = [walk_strip(scene) for scene in make_scenes(recordings)]
    places = [divmod(i, PANELS_IN_A_ROW) for i in range(len(strips))]
    placed = {
        f"{column}/{row}": strip
        for (row, column), strip in zip(places, strips, strict=True)
    }
    write_figure(walk_figure(placed, DOTS_PER_INCH), path)


def robot_rows(result: Result) -> tuple[list[str], list[list[str]]]:
    """The headings and the rows of the table of all robots' measures."""
    return COLUMNS, [_row(short_name(name), of) for name, of in result.items()]


def answer(result: Result) -> Iterator[str]:
    """Yield a sentence on the robots that walk, then one on each robot that falls."""
    result = {short_name(name): of for name, of in result.items()}
    walks = [name for name, of in result.items() if not _tuned(of)["falls"]]
    trials = next(_tuned(of)["trials"] for of in result.values())
    if walks:
        yield (
            f"{len(walks)} of {len(result)} walk 5 s without a fall in each of "
            f"{trials} walks in the sim: {', '.join(walks)}."
        )
    else:
        yield f"None of {len(result)} walks without a fall in each of {trials} walks."
    for name, of in result.items():
        if name not in walks:
            score = _tuned(of)
            yield (
                f"{name} falls in {score['falls']} of {score['trials']} walks. "
                f"{why(of)}"
            )


def why(of: Mapping[str, Any]) -> str:
    """Explain a robot's falls by its measures `of`, or say that none explains them."""
    reach, motor = of["reach"], of["saturation"]
    causes = []
    if reach["place_m"] > _FAR_M or reach["tilt_rad"] > _TILTED_RAD:
        causes.append(
            f"its joints do not reach the gait's poses: the range of {reach['joint']} "
            f"keeps a foot {1e3 * reach['place_m']:.0f} mm away from its place and its "
            f"sole {math.degrees(reach['tilt_rad']):.0f} degrees from level"
        )
    if motor["share"] > _OFTEN:
        causes.append(
            f"the motor of {motor['joint']} is at its limit for "
            f"{motor['share']:.0%} of the time"
        )
    if not causes:
        return (
            "Neither its joints' ranges nor its motors explain it. Its soles are "
            f"{of['sole']['length']:.0%} as long and {of['sole']['width']:.0%} as wide "
            "as the NAO's would be at its size."
        )
    return f"What was found: {'; '.join(causes)}."


def _tuned(of: Mapping[str, Any]) -> Mapping[str, Any]:
    score: Mapping[str, Any] = of["sim"]["tuned"]
    return score


def _row(name: str, of: Mapping[str, Any]) -> list[str]:
    score = _tuned(of)
    others = of["sim"]["start"], of["real"]["tuned"], of["real"]["start"]
    low, high = wilson(score["falls"], score["trials"])
    reach, motor = of["reach"], of["saturation"]
    return [
        name,
        f"{of['mass_kg']:.1f}",
        f"{of['scale']['length']:.2f}",
        f"{score['speed_cm_s']:.1f} ± {score['speed_std']:.1f}",
        f"{score['falls']}/{score['trials']}",
        f"{low:.0%} to {high:.0%}",
        *(f"{other['falls']}/{other['trials']}" for other in others),
        f"{of['sole']['length']:.2f} x {of['sole']['width']:.2f}",
        f"{1e3 * reach['place_m']:.0f} mm, {math.degrees(reach['tilt_rad']):.0f}°",
        f"{motor['joint']} {motor['share']:.0%}" if motor["joint"] else "none",
    ]
