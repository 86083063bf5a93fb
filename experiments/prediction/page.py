"""The page of a prediction: judgement, errors by channel and recording, pictures."""

from collections.abc import Sequence

from diagnosis.conclude.held_out_errors import SURPRISE
from diagnosis.conclude.held_out_series import HeldOutSeries, rms
from diagnosis.verdict import ChannelFit
from experiments.diagnosis_report.figures import overlay_figure
from experiments.diagnosis_report.numbers import error_unit, errors_text
from experiments.diagnosis_report.page import NOISE_FLOOR
from experiments.diagnosis_report.place_words import (
    at_words,
    channel_words,
    listing,
    sentence,
)
from experiments.prediction.judgement import exceptions, number
from experiments.prediction.result import Errors, PredictionResult
from experiments.reports.origin import Origin
from experiments.reports.report import Report, markdown_table, write_figure
from experiments.runs.folder import RunFolder

COLUMNS = (
    "errors", "sim", "corrected sim", "noise floor", "unit", "ratio", "95 % interval",
)  # fmt: skip
MOST_PICTURES = 8
"""Most channels that the page draws, those with the largest errors."""
MOST_ROWS = 12
"""Most channels in the table on the console."""


def rows_of(result: PredictionResult, most: int | None = None) -> list[tuple[str, ...]]:
    """Rows of the table `COLUMNS`: all channels, each of them, then recordings.

    With `most` no more channels than these have a row, those with large errors.
    """
    channels = by_size(result)
    rows = [_row("all channels", result.together)]
    rows += [_row(name, one) for name, one in channels[:most]]
    if most is not None and len(channels) > most:
        rows.append((f"{len(channels) - most} more in the report", *[""] * 6))
    for one in result.recordings:
        if one.together is None:
            rows.append((f"recording {one.name}: used, not counted", *[""] * 6))
        else:
            rows.append(_row(f"recording {one.name}", one.together))
    return rows


def by_size(result: PredictionResult) -> list[tuple[str, Errors]]:
    """Channels with their errors, those first whose error was the most noise floors."""
    every = result.channels.items()
    return sorted(every, key=lambda one: -one[1].nominal / one[1].floor)


def _row(name: str, errors: Errors) -> tuple[str, ...]:
    largest = max(errors.nominal, errors.corrected, errors.floor)
    factor, unit = error_unit(errors.unit, largest)
    three = errors.nominal, errors.corrected, errors.floor
    texts = errors_text(factor * one for one in three)
    ends = ""
    if errors.low is not None and errors.high is not None:
        ends = f"{number(errors.low)} to {number(errors.high)}"
    return (name, *texts, unit, number(errors.ratio), ends)


def promise_sentence(result: PredictionResult) -> str:
    """What the diagnosis measured on the recordings that it held out."""
    if result.promise is None:
        return "The diagnosis held no recordings out, so that it promised no number."
    return (
        "On the recordings that the diagnosis held out the sim's error was "
        f"{number(result.promise.ratio)} times the corrected sim's."
    )


def doubts_of(result: PredictionResult) -> list[str]:
    """Sentences on recordings that say otherwise, and if far more error is left.

    That is said from twice the error on the recordings that the diagnosis held out.
    """
    ratios = {one.name: one.together.ratio for one in result.recordings if one.together}
    other, left = exceptions(result.judgement, ratios), result.together.corrected
    said = [sentence(other)] if other else []
    usual = max(result.promise.corrected if result.promise else 1.0, 1.0)
    if left >= SURPRISE * usual:
        said.append(
            f"The corrected sim leaves {number(left)} times the noise floor here, "
            f"{number(left / usual)} times as much as the diagnosis led to expect: "
            "something is missing, or has changed, that its recordings hardly showed."
        )
    return said


def interval_sentence(result: PredictionResult) -> str:
    """How the interval was made, and what it therefore holds for."""
    of, units = result.interval.unit, result.interval.units
    holds = (
        "more time of motions like these"
        if of == "blocks of time"
        else "more recordings like these"
    )
    return f"The interval is drawn from {units} {of}: it holds for {holds}."


def write_page(
    folder: RunFolder, result: PredictionResult, series: Sequence[HeldOutSeries]
) -> None:
    """Write `result.md`, `report.html` and pictures of the worst channels."""
    question = (
        f"Does the corrected sim of {result.robot} predict new recordings better?"
    )
    effects = listing([at_words(one) for one in result.effects], "and")
    answer = [
        f"{sentence(result.sentence)}",
        f"The corrected sim has {effects}. {promise_sentence(result)}",
    ]
    if doubts := doubts_of(result):
        answer.insert(1, " ".join(doubts))
    body = [*_errors(result), *_pictures(folder, result, series), *_limits(result)]
    Report(question, answer, body, Origin.of_run(folder)).write(folder.path)


def _errors(result: PredictionResult) -> list[str]:
    """The table of errors, and what its numbers are."""
    rows = [tuple(text or "-" for text in row) for row in rows_of(result)]
    return [
        "## Errors before and after",
        "",
        *markdown_table(COLUMNS, rows),
        "",
        "Rms errors of both sims in the recordings that the diagnosis has not used; "
        "nothing was fitted to them. Those of all channels are in multiples of "
        "each channel's noise floor. The ratio is that of the sim's error to the "
        f"corrected sim's: above 1 the corrected sim is better. {NOISE_FLOOR} "
        + interval_sentence(result),
        "",
    ]


def _pictures(
    folder: RunFolder, result: PredictionResult, series: Sequence[HeldOutSeries]
) -> list[str]:
    """Lines of Markdown with a picture of each of the worst channels, which is written.

    Of a channel that recording is drawn in which the sim was most wrong.
    """
    worst = by_size(result)[:MOST_PICTURES]
    lines = ["## Over time", ""]
    for k, (name, errors) in enumerate(worst, 1):
        one = max(series, key=lambda own: _wrong(own, name))
        fit = ChannelFit(
            nominal=errors.nominal,
            corrected=errors.corrected,
            floor=errors.floor,
            unit=errors.unit,
        )
        figure = overlay_figure(one, name, fit, is_corrected=True)
        figure.patch.set(facecolor="white", alpha=1.0)
        file = f"channel_{k}.png"
        write_figure(figure, folder.path / file)
        lines += [f"![{_caption(name)} in recording {one.name}]({file})", ""]
    more = len(result.channels) - len(worst)
    return [
        *lines,
        "Above, one second in which the sim's error is large; below, the errors over "
        "the whole recording: that second is yellow, and the grey band is twice the "
        "noise floor to each side. Drawn errors include that of the start state, which "
        "is taken out of the numbers."
        + (f" {more} more channels are in the table." if more else ""),
        "",
    ]


def _wrong(series: HeldOutSeries, channel: str) -> float:
    """The sim's rms error in a channel of a recording."""
    own = series.channels[channel]
    return rms(own.real - own.sim)


def _caption(channel: str) -> str:
    words = channel_words(channel)
    return f"{words[:1].upper()}{words[1:]}"


def limits_of(result: PredictionResult) -> list[str]:
    """Sentences on what the result does not tell."""
    said = list(result.limits)
    if result.verdict == "unknown":
        said.insert(
            0,
            "The verdict of the diagnosis is unknown: the effects explain a part of "
            "the error, and none of them is established.",
        )
    if result.left_out:
        events = listing([at_words(one) for one in result.left_out], "and")
        said.append(
            f"Left out of the corrected sim, since of one recording only: {events}."
        )
    return said


def _limits(result: PredictionResult) -> list[str]:
    """Lines of Markdown with the limits; none if there are none."""
    said = [f"- {sentence(one)}" for one in limits_of(result)]
    return ["## Limits", "", *said] if said else []


def console_lines(result: PredictionResult) -> list[tuple[str, str]]:
    """The result in a few lines, each a label and a text."""
    used = [one.name for one in result.recordings if one.used]
    lines = [
        ("judgement", result.sentence),
        ("promised", promise_sentence(result).rstrip(".")),
        ("interval", interval_sentence(result).rstrip(".")),
    ]
    for k, doubt in enumerate(doubts_of(result)):
        lines.append(("" if k else "but", doubt.rstrip(".")))
    if used:
        were = "was" if len(used) == 1 else "were"
        lines.append(
            (
                "used",
                f"{listing(used, 'and')} {were} used by the diagnosis: not counted",
            )
        )
    if said := limits_of(result):
        more = f" (and {len(said) - 1} more)" if len(said) > 1 else ""
        lines.append(("limits", said[0].rstrip(".") + more))
    return lines
