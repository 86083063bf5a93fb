"""A diagnosis as one self-contained HTML page: first plain words, then evidence."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from diagnosis import Verdict
from diagnosis.conclude.held_out_series import HeldOutSeries, by_error
from diagnosis.effects import effect as kind_of
from diagnosis.residuals.channels import LEAST_TORQUE
from diagnosis.seen import Seen
from diagnosis.traces.time_line import Stretch
from diagnosis.verdict import Errors, Fit, Found
from experiments.diagnosis_report.advice import advised
from experiments.diagnosis_report.agreement import checked
from experiments.diagnosis_report.corrected_files import how_simulated
from experiments.diagnosis_report.figure_style import inline_svg
from experiments.diagnosis_report.figures import (
    bars_figure,
    mismatch_figure,
    overlay_figure,
    unexplained_figure,
    worst_cells,
)
from experiments.diagnosis_report.findings import parameter_rows
from experiments.diagnosis_report.joints_shown import joints_shown
from experiments.diagnosis_report.numbers import (
    DASH,
    amount_text,
    error_unit,
    errors_text,
    percent,
    sure_text,
)
from experiments.diagnosis_report.place_words import at_words, place_words
from experiments.diagnosis_report.text import answer, badge, doubts, next_step, question
from experiments.diagnosis_report.time_line_figure import time_line_shown
from experiments.reports.report import render
from groundwalk.files import write_text

TEMPLATE = "diagnosis_report.html.jinja"
MOST_PICTURES = 4
"""Largest number of held-out recordings that the page draws; the tables use all."""
SHOWN_ROWS = 13
"""Number of rows of the table of errors that are visible; the rest can be unfolded."""
_OFF = 1.05
"""Multiple of the noise floor; where the nominal sim's error is below it, the page does
not say which share of the error a correction removes."""
_COLUMNS = ("nominal", "corrected", "floor", "ceiling", "wrong_place", "wrong_effect")
_USES = {"fit": "fitted on", "select": "selected on", "test": "held out"}
NOISE_FLOOR = (
    "The noise floor of a channel is the noise measured in these recordings "
    f"(audit.json) and the error of the simulation itself, for measured torques at "
    f"least {100 * LEAST_TORQUE:.0f} % of them, the accuracy of motor constants."
)
"""The page's explanation of the words "noise floor"."""


@dataclass(frozen=True)
class ReportFacts:
    """Facts on the origin of a diagnosis for its report page.

    Attributes:
      robot: name of the robot, or its model file.
      base: "fixed" or "floating".
      command: the command line that makes this report again.
      settings: the options of the run, by name.
      versions: versions of groundwalk and the packages it uses, by name.
      files: descriptions of the run's other files, by their paths relative to the
        report.
      changed: whether reference recordings of the healthy robot were given, so that the
        question is what has changed since then.

    Example:
      >>> ReportFacts("nao", "fixed", command="groundwalk diagnose a.parquet ...")
    """

    robot: str
    base: str
    command: str
    settings: Mapping[str, str] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    files: Mapping[str, str] = field(default_factory=dict)
    changed: bool = False


def write_report(
    path: Path,
    verdict: Verdict,
    series: Sequence[HeldOutSeries],
    facts: ReportFacts,
    seen: Seen | None = None,
    time_line: Sequence[Stretch] = (),
) -> None:
    """Write the page; after an error no partial file remains.

    Args:
      path: the `.html` file.
      verdict: the verdict of the diagnosis.
      series: held-out recordings, the most important first; may be empty.
      facts: origin of the diagnosis.
      seen: what each joint shows before any effect is named; None leaves it out.
      time_line: uses and events of the recordings; may be empty.

    Raises:
      UnknownNameError: the verdict names an unknown effect.

    Example:
      >>> facts = ReportFacts("nao", "fixed", command="groundwalk diagnose ...")
      >>> write_report(Path("report.html"), found.verdict, found.held_out(), facts)
    """
    parts = _words(verdict, facts) | _shown(verdict, series)
    parts["joints"] = None if seen is None else joints_shown(seen, verdict)
    parts["time_line"] = time_line_shown(time_line) if time_line else None
    write_text(path, render(TEMPLATE, **parts))


def _words(verdict: Verdict, facts: ReportFacts) -> dict[str, Any]:
    """Sentences and small tables of the page, by their names in the Jinja template."""
    used = vars(verdict.recordings).items()
    return {
        "verdict": verdict,
        "title": f"Diagnosis: {facts.robot}",
        "question": question(facts.robot, facts.changed),
        "badge": badge(verdict, facts.changed),
        "answer": answer(verdict, facts.changed),
        "advice": list(advised(verdict)),
        "doubts": doubts(verdict),
        "next_step": next_step(verdict),
        "effects": [_effect_row(effect) for effect in verdict.effects],
        "checked": checked(verdict.effects),
        "smallest": [
            {**_label_and_place(*key.split("@", 1)), "amount": amount_text(amount)}
            for key, amount in sorted(verdict.smallest_detectable.items())
        ],
        "fit_rows": _fit_rows(verdict.fit) if verdict.fit else [],
        "shown_rows": SHOWN_ROWS,
        "noise_floor": NOISE_FLOOR,
        "dash": DASH,
        "command": facts.command,
        "made": [
            ("robot", f"{facts.robot}, {facts.base} base"),
            *((_USES[use], ", ".join(names)) for use, names in used if names),
            *facts.settings.items(),
            *facts.versions.items(),
            ("took", f"{verdict.seconds:.0f} s"),
        ],
        "files": facts.files,
    }


def _shown(verdict: Verdict, series: Sequence[HeldOutSeries]) -> dict[str, Any]:
    """Figures of the page, by their names in the Jinja template."""
    shown: dict[str, Any] = {"unexplained": None, "map": [], "bars": None}
    rest, cells, fit = verdict.unexplained, worst_cells(verdict.mismatch), verdict.fit
    if rest:
        svg = inline_svg(unexplained_figure(rest), "unexplained", "unexplained error")
        shown["unexplained"] = {"rest": rest, "svg": svg}
    if cells:
        shown["map"] = {
            "svg": inline_svg(mismatch_figure(cells), "map", "mismatch by channel"),
            "regimes": any(cell.regimes for cell in cells),
            "bursts": any(cell.bursts for cell in cells),
            "left_out": len(verdict.mismatch) - len(cells),
        }
    if fit:
        figure = bars_figure(fit, bool(verdict.effects))
        shown["bars"] = inline_svg(figure, "bars", "errors")
    shown["pictures"] = [
        _picture(one, verdict, f"picture{index}")
        for index, one in enumerate(series[:MOST_PICTURES])
    ]
    shown["left_out_pictures"] = max(0, len(series) - MOST_PICTURES)
    return shown


def _picture(series: HeldOutSeries, verdict: Verdict, name: str) -> dict[str, Any]:
    """Name of a held-out recording, and a figure of its worst channel over time."""
    channel = by_error(series, verdict.fit)[0]
    errors = verdict.fit.channels.get(channel) if verdict.fit else None
    figure = overlay_figure(series, channel, errors, bool(verdict.effects))
    alternative = f"{channel} of {series.name}: real and sim"
    return {"name": series.name, "svg": inline_svg(figure, name, alternative)}


def _effect_row(effect: Found) -> dict[str, Any]:
    course, times = effect.when, "all the time"
    if course.kind != "always":
        times = f"{course.kind}, {course.start_s:.3g} to {course.end_s:.3g} s"
        times += f" of {course.recording}" if course.recording else ""
    return {
        **_label_and_place(effect.name, effect.place),
        "parameters": parameter_rows(effect),
        "sure": sure_text(effect.probability),
        "when": times,
        "instead": ", ".join(map(at_words, effect.confusable_with)) or DASH,
        "meaning": kind_of(effect.name).words.meaning,
        "how": how_simulated(effect),
    }


def _label_and_place(name: str, place: str) -> dict[str, str]:
    words = kind_of(name).words
    return {"label": words.label, "place": place_words(place, words.place_kind)}


def _fit_rows(fit: Fit) -> list[dict[str, Any]]:
    """Rows of the table of errors: all channels together, then each, worst first."""
    channels = sorted(fit.channels.items(), key=lambda item: -item[1].excess)
    return [
        _fit_row("all channels", "noise floors", fit),
        *(_fit_row(name, one.unit, one) for name, one in channels),
    ]


def _fit_row(name: str, unit: str, fit: Errors) -> dict[str, Any]:
    """A row of the table of errors: texts with a unit, and the share that was removed.

    That share of the error above the noise floor is limited to 100 %.
    """
    errors = [getattr(fit, column) for column in _COLUMNS]
    factor, unit = error_unit(unit, max(filter(None, errors), default=0.0))
    texts = errors_text(error and factor * error for error in errors)
    off = fit.nominal > _OFF * fit.floor
    closed = fit.closed(fit.corrected) if off else None
    return {
        "channel": name,
        **dict(zip(_COLUMNS, texts, strict=True)),
        "unit": unit,
        "closed": DASH if closed is None else percent(min(max(0.0, closed), 1.0)),
        "is_all": isinstance(fit, Fit),
    }
