"""The report page of a real robot's diagnosis."""

from collections.abc import Sequence

from diagnosis import PlacedEffect, Verdict
from diagnosis.verdict import Errors, Found
from experiments.diagnosis_report.numbers import estimate_text, percent
from experiments.diagnosis_report.text import answer, badge, next_step
from experiments.real_robot_study.cases import RealRobot
from experiments.real_robot_study.claims import claims_of, sane_bounds
from experiments.reports.report import markdown_table
from experiments.runs.folder import RunFolder
from experiments.transfer.claims import write_transfer_page

MUCH = 2.0
"""Error of the corrected sim, in multiples of the noise floor, above which the page
mentions it as a doubt."""

NOTES = """
Intervals hold 80 %. Errors are rms errors of the sim on recordings, or parts of them,
that neither the fit nor the choice of effects has seen; "regression" is the error that
a flexible regression without physics reaches there. "Same effect, other place" and
"other effect, same place" are controls that replace the main effect only. How often the
stated probabilities are right was measured on [concealed cases](concealed.md), on no
real robot.
"""


def write_real_page(folder: RunFolder, robot: RealRobot, verdict: Verdict) -> None:
    """Write a diagnosis' page, `result.md` and `report.html`, into the run's folder."""
    body = [" ".join(robot.about.split()), "", f"## Verdict: {badge(verdict)}"]
    body += ["", *_effects(robot, verdict.effects), "", *_doubts(verdict)]
    body += ["", "## Errors of the sim on held-out recordings", "", *_fit(verdict)]
    body += _pulses(verdict)
    body += ["", "## What was used for what", "", *_recordings(verdict), NOTES.rstrip()]
    claims = claims_of(robot, verdict)
    write_transfer_page(folder, robot.title, claims, body, answer(verdict))


def _effects(robot: RealRobot, effects: Sequence[Found]) -> list[str]:
    """Markdown table of the effects found, with a row for each of their parameters."""
    rows = []
    for effect in sorted(effects, key=lambda one: (one.place, one.name)):
        for name, value in effect.parameters.items():
            if name in ("start", "duration") and effect.when.kind == "always":
                continue
            bounds = sane_bounds(robot, effect.name, name)
            sure = percent(effect.probability)
            text = estimate_text(value)
            rows.append([effect.place, effect.name, name, text, sure, bounds])
    if not rows:
        return ["Nothing was named."]
    columns = ["place", "effect", "parameter", "value", "sure", "possible"]
    return markdown_table(columns, rows)


def _doubts(verdict: Verdict) -> list[str]:
    """Markdown list of the doubts: other answers, limits of the data, error left."""
    lines = []
    for effect in verdict.effects:
        others = ", ".join(map(_at, effect.confusable_with))
        if others:
            lines.append(f"- instead of {_at(effect)} it may be {others}")
    for effects in verdict.alternatives:
        together = " with ".join(map(_at, effects))
        lines.append(f"- another answer that fits as well: {together}")
    lines += _rest_of_fit(verdict)
    unsure = [
        _at(effect)
        for effect in verdict.effects
        if (first := next(iter(effect.parameters.values()))).low <= 0 <= first.high
    ]
    lines += [f"- may be nothing: {', '.join(unsure)}"] if unsure else []
    rest = verdict.unexplained
    if rest is not None:
        lines.append(
            f"- {percent(rest.share)} of the squared error above the noise is left "
            f"unexplained, most of it in {rest.channel}, ordered by {rest.against}"
        )
    lines += [f"- {limit}" for limit in verdict.limits]
    step = next_step(verdict)
    lines += [f"- next: {step}"] if step else []
    return ["Doubts:", "", *(lines or ["- none"])]


def _at(effect: Found | PlacedEffect) -> str:
    return f"{effect.name} at {effect.place}"


def _rest_of_fit(verdict: Verdict) -> list[str]:
    """Markdown lines on the error of the corrected sim, if it is large."""
    fit = verdict.fit
    if fit is None or fit.corrected <= MUCH * fit.floor:
        return []
    left = f"- {fit.corrected:.1f} times the noise is left"
    if fit.ceiling is not None and fit.ceiling < fit.corrected:
        left += (
            f", and a regression without physics leaves {fit.ceiling:.1f}: there is "
            "something else that these effects do not describe"
        )
    parts = [name.partition("[")[0] for name in verdict.recordings.test]
    known = {name.partition("[")[0] for name in verdict.recordings.fit}
    if known >= set(parts):
        return [left, "- the held-out data are parts of recordings that were fitted"]
    return [left]


def _fit(verdict: Verdict) -> list[str]:
    """Markdown table of held-out errors by channel, and of all channels together."""
    fit = verdict.fit
    if fit is None:
        return ["Nothing was held out."]
    columns = ["channel", "unit", "sim", "corrected", "noise floor", "regression"]
    columns += ["same effect, other place", "other effect, same place"]
    every: dict[str, tuple[Errors, str]] = {
        name: (one, one.unit) for name, one in fit.channels.items()
    }
    every["all"] = fit, "noise"
    rows = []
    for name, (one, unit) in every.items():
        errors = [one.nominal, one.corrected, one.floor, one.ceiling]
        errors += [one.wrong_place, one.wrong_effect]
        texts = ["-" if value is None else f"{value:.3g}" for value in errors]
        rows.append([name, unit, *texts])
    return markdown_table(columns, rows)


def _pulses(verdict: Verdict) -> list[str]:
    """Markdown table of the force pulses found; no lines if there are none."""
    if not verdict.pulses:
        return []
    columns = ["recording", "joint", "from [s]", "to [s]", "size", "came in at"]
    rows = [
        [
            *(one.recording, one.joint, f"{one.start_s:.3f}", f"{one.end_s:.3f}"),
            *(f"{one.torque:.1f} {one.unit}", one.source),
        ]
        for one in verdict.pulses
    ]
    return ["", "## Pulses", "", *markdown_table(columns, rows)]


def _recordings(verdict: Verdict) -> list[str]:
    used = verdict.recordings
    return [
        f"- fitted: {', '.join(used.fit)}",
        f"- to select effects: {', '.join(used.select)}",
        f"- held out: {', '.join(used.test)}",
        f"- {verdict.seconds:.0f} s",
    ]
