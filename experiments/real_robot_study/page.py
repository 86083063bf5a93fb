"""The report page of a real robot's diagnosis; claims on it, and whether they hold."""

from collections.abc import Iterator, Sequence

from diagnosis import PlacedEffect, Verdict
from diagnosis.effects import keys_within
from diagnosis.verdict import Errors, Found, Pulse
from experiments.diagnosis_report.findings import pulse_sentences
from experiments.diagnosis_report.numbers import estimate_text, percent, sure_text
from experiments.diagnosis_report.text import answer, badge, next_step
from experiments.real_robot_study.cases import RealRobot
from experiments.reports.report import markdown_table
from experiments.runs.folder import RunFolder
from experiments.transfer.claims import Claim, write_transfer_page

MUCH = 2.0
"""Error of the corrected sim, in multiples of the noise floor, above which the page
mentions it as a doubt."""

NOTES = """
Intervals hold 80 %. Errors are rms errors of the sim on recordings, or parts of them,
that neither the fit nor the choice of effects has seen; "regression" is the error that
a flexible regression without physics reaches there. "Same effect, other place" and
"other effect, same place" are controls that replace the main effect only. How often the
stated probabilities are right was measured on [concealed cases](concealed.md) and on
[doctored recordings of real robots](concealed_real.md). This is one run and one way to
divide the recordings, and rules for robots far from their models were made with these
robots in sight: another robot's figures are likely to be worse.
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
            sure = sure_text(effect.probability)
            text = estimate_text(value)
            rows.append([effect.place, effect.name, name, text, sure, bounds])
    if not rows:
        return ["Nothing was named."]
    columns = ["place", "effect", "parameter", "value", "sure", "possible"]
    count = f"Different values that were fitted: {number_of_values(effects)}."
    return [*markdown_table(columns, rows), "", count]


def number_of_values(effects: Sequence[Found]) -> int:
    """Number of values that were fitted; those that places share count once."""
    groups = {
        (one.name, frozenset([one.place, *one.shared_with])): len(one.parameters)
        for one in effects
    }
    return sum(groups.values())


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


TWICE = 2.0
"""Least factor by which the effects found must reduce held-out errors, as claimed."""


def claims_of(robot: RealRobot, verdict: Verdict) -> list[Claim]:
    """All claims about a robot's diagnosis, each with whether it holds.

    Example:
      >>> claims_of(ROBOTS["emps"], verdict)[0].holds
      True
    """
    claims = list(_published(robot, verdict))
    if robot.pulses:
        claims.append(_pulses_claim(robot.pulses, verdict.pulses))
    if robot.twice:
        claims.append(_twice(verdict))
    if robot.sane:
        claims.append(_sane(robot, verdict))
    return claims


def sane_bounds(robot: RealRobot, effect: str, parameter: str) -> str:
    """The plausible range of a parameter as text; "" if none is known."""
    bounds = (robot.sane or {}).get(f"{effect}.{parameter}")
    return f"{bounds.low:g} to {bounds.high:g}: {bounds.why}" if bounds else ""


def _published(robot: RealRobot, verdict: Verdict) -> Iterator[Claim]:
    """Yield for each published value the claim that the verdict's interval holds it.

    Of a more general form of the effect it is the part that the form begins with, such
    as dry friction in the middle of the range of friction that varies over it.
    """
    for known in robot.published:
        own = [
            one.parameters
            for one in verdict.effects
            if f"{known.effect}@{one.place}" in keys_within([_valued(one)])
        ]
        found = next(
            (one[known.parameter] for one in own if known.parameter in one), None
        )
        text = f"{known.text}: the 80 % interval holds the published {known.value:g}"
        holds = found is not None and found.low <= known.value <= found.high
        yield Claim(text, holds, estimate_text(found) if found else "not found")


def _valued(found: Found) -> PlacedEffect:
    values = tuple(one.value for one in found.parameters.values())
    return PlacedEffect(found.name, found.place, values)


def _pulses_claim(count: int, pulses: tuple[Pulse, ...]) -> Claim:
    """The claim that `count` pulses were found, all at the actuator's input."""
    text = f"all {count} pulses are located and attributed to the actuator's input"
    right = [pulse for pulse in pulses if pulse.source == "actuator input"]
    found = "; ".join(pulse_sentences(pulses)) or "none found"
    return Claim(text, len(right) == len(pulses) == count, found)


def _twice(verdict: Verdict) -> Claim:
    """The claim that the effects found at least halve the error at every joint."""
    text = "held-out motions of every joint are predicted at least twice as well"
    if verdict.fit is None:
        return Claim(text, False, "nothing was held out")
    fit = verdict.fit
    ratios = {
        name.partition(".")[2]: one.nominal / one.corrected
        for name, one in fit.channels.items()
    }
    joints = ", ".join(f"{name} {ratio:.1f}" for name, ratio in ratios.items())
    ratio, holds = fit.nominal / fit.corrected, min(ratios.values()) >= TWICE
    return Claim(text, holds, f"{ratio:.1f} times in all; {joints}")


def _sane(robot: RealRobot, verdict: Verdict) -> Claim:
    """The claim that each joint has an effect, and that all values are plausible."""
    text = "an effect is named at each joint, and all values are possible"
    joints = [
        name.partition(".")[2]
        for name in (verdict.fit.channels if verdict.fit else ())
        if name.startswith("position.")
    ]
    places = {effect.place for effect in verdict.effects}
    wrong = [f"nothing at {joint}" for joint in joints if joint not in places]
    for effect in verdict.effects:
        for name, value in effect.parameters.items():
            bounds = (robot.sane or {}).get(f"{effect.name}.{name}")
            if bounds and not bounds.low <= value.value <= bounds.high:
                wrong.append(f"{effect.name}@{effect.place} {value.value:.3g}")
    count = len(verdict.effects)
    return Claim(text, not wrong, "; ".join(wrong) or f"{count} effects, all possible")
