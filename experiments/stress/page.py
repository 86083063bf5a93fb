"""Tables and report page of the terrain stress test."""

from collections import Counter
from collections.abc import Iterator, Sequence

from experiments.reports.origin import Origin
from experiments.reports.report import Report, markdown_table
from experiments.runs.folder import RunFolder
from experiments.runs.gait_files import short_name
from experiments.stress.curves import Curve, family_text, half_text, severity_text
from experiments.stress.fall_cause import Cause
from experiments.stress.families import FLAT
from experiments.stress.figure import COMPARISON, heat_map_name

QUESTION = "How rough may the ground be before these gaits fall?"
SETTING = ("robot", "world", "gait", "family")
HALF_HEADINGS = (*SETTING, "severity", "half of the trials fall")
CELL_HEADINGS = (
    *SETTING, "severity", "speed [cm/s] ± s.d.", "falls", "95 % interval",
    "distance to fall [m]", "what came before",
)  # fmt: skip
NOTES = (
    "Every gait walked on the same grounds from the same start poses. Speed is the",
    "mean forward speed; in a trial with a fall, until the fall; s.d. is the standard",
    "deviation over trials. Intervals of fall rates are Wilson's. The severity at",
    "which half of the trials fall, and its interval, come from the profile likelihood",
    "of a logistic curve over the logarithm of the severity; ? means that an end of",
    "the interval is outside of what was tried, not reached that fewer than half of",
    "the trials fall even at the hardest severity. On slippery ground a robot need not",
    "fall: with a friction of 0.02 hardly anything brakes its feet, and it glides on.",
    "Distance to fall: median of the trials that fell.",
    "What each severity and each cause means: docs/terrain_stress.md.",
)


def half_rows(curves: Sequence[Curve]) -> list[list[str]]:
    """Table rows: the severity at which half of the trials fall, for each curve."""
    return [
        [*_setting(curve), curve["quantity"], half_text(curve)]
        for curve in curves
        if curve["half"] is not None
    ]


def cell_rows(curves: Sequence[Curve]) -> list[list[str]]:
    """Table rows: speed, falls and their causes, for each severity of each curve."""
    rows = []
    for curve in curves:
        for rung in curve["rungs"]:
            distance = rung["distance_to_fall_m"]
            rows.append(
                [
                    *_setting(curve),
                    severity_text(rung["severity"], curve["unit"]),
                    f"{rung['speed_cm_s']:.1f} ± {rung['speed_std']:.1f}",
                    f"{rung['falls']}/{rung['trials']}",
                    f"{rung['fall_rate_low']:.0%} to {rung['fall_rate_high']:.0%}",
                    "-" if distance is None else f"{distance:.2f}",
                    _counted(Counter(rung["causes"])),
                ]
            )
    return rows


def cause_rows(curves: Sequence[Curve]) -> list[list[str]]:
    """Table rows: number of falls by cause, for each curve with falls."""
    rows = []
    for curve in curves:
        counted: Counter[str] = Counter()
        for rung in curve["rungs"]:
            counted.update(rung["causes"])
        if counted:
            counts = [str(counted[cause]) for cause in Cause]
            rows.append([*_setting(curve), str(counted.total()), *counts])
    return rows


def write_stress_page(folder: RunFolder, curves: Sequence[Curve]) -> None:
    """Write a run's report page, `result.md` and `report.html`, beside its pictures."""
    causes = (*SETTING, "falls", *Cause)
    body = [
        *markdown_table(HALF_HEADINGS, half_rows(curves)),
        "",
        *NOTES,
        "",
        f"![The severity at which half of the trials fall]({COMPARISON})",
        "",
        "## What came before the falls",
        "",
        *markdown_table(causes, cause_rows(curves)),
    ]
    for gait in dict.fromkeys(curve["gait"] for curve in curves):
        body += ["", f"![Falls of {gait}]({heat_map_name(gait)})"]
    body += ["", "## Every severity", ""]
    body += markdown_table(CELL_HEADINGS, cell_rows(curves))
    answer = list(stress_answer(curves))
    Report(QUESTION, answer, body, Origin.of_run(folder)).write(folder.path)


def stress_answer(curves: Sequence[Curve]) -> Iterator[str]:
    """Yield the answer of the page: a sentence for each robot, world and gait."""
    keys = dict.fromkeys(tuple(_setting(curve)[:3]) for curve in curves)
    for robot, world, gait in keys:
        own = [c for c in curves if tuple(_setting(c)[:3]) == (robot, world, gait)]
        where = "real world" if world == "real" else world
        rungs = [rung for curve in own for rung in curve["rungs"]]
        falls, trials = (sum(rung[k] for rung in rungs) for k in ("falls", "trials"))
        flat = next(c["rungs"][0] for c in own if c["family"] == FLAT)
        halves = ", ".join(
            f"{family_text(curve['family'])} {half_text(curve, interval=False)}"
            for curve in own
            if curve["half"] is not None
        )
        yield (
            f"In the {where}, {gait} ({robot}) falls in {falls} of {trials} trials, "
            f"{flat['falls']} of {flat['trials']} on flat ground. Half of the trials "
            f"fall at: {halves}."
        )


def _setting(curve: Curve) -> list[str]:
    names = short_name(curve["robot"]), curve["world"], curve["gait"]
    return [*names, family_text(curve["family"])]


def _counted(causes: Counter[str]) -> str:
    return ", ".join(f"{count} {cause}" for cause, count in causes.most_common()) or "-"
