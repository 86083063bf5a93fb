"""Prints a diagnosis on the console in at most ten lines."""

import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from diagnosis import PlacedEffect, Verdict
from diagnosis.verdict import Fit, Found
from experiments.diagnosis_report.findings import (
    at_many,
    parameter_rows,
    pulse_sentences,
    told_together,
)
from experiments.diagnosis_report.numbers import (
    amount_text,
    errors_text,
    percent,
    sure_text,
)
from experiments.diagnosis_report.place_words import at_words, choice, listing
from experiments.diagnosis_report.text import badge, doubts, headline, next_step

_SHOWN_AMOUNTS = 3
"""Number of effects whose smallest detectable size the verdict "none" mentions."""
_MOST_FOUND = 3
"""Largest number of lines on findings (effects and pulses)."""
_MOST_UNSURE = 2
"""Largest number of effects whose doubts are printed."""


def print_verdict(
    verdict: Verdict, files: Sequence[Path], changed: bool = False
) -> None:
    """Print a verdict on standard output, on a terminal with bold and grey text.

    Args:
      verdict: the verdict of the diagnosis.
      files: the files that were written, the most useful first.
      changed: whether the question is what has changed since the reference recordings
        (healthy robot), not what physics the sim lacks.

    Example:
      >>> print_verdict(Verdict("not_identifiable", limits=("Nothing moved.",)), [])
      verdict     these data cannot tell
      limits      Nothing moved
    """
    lines = console_lines(verdict, files, changed)
    if not sys.stdout.isatty():
        print(*(f"{label:<12}{text}" for label, text in lines), sep="\n")
        return
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    table = Table.grid(padding=(0, 2))
    for row, (label, text) in enumerate(lines):
        shown = escape(text)
        table.add_row(f"[dim]{label}[/]", shown if row else f"[bold]{shown}[/]")
    Console().print(table)


def console_lines(
    verdict: Verdict, files: Sequence[Path], changed: bool = False
) -> list[tuple[str, str]]:
    """A diagnosis as at most ten lines, each a label such as "doubt" and a text.

    Args:
      verdict: the verdict of the diagnosis.
      files: the files that were written.
      changed: whether the question is what has changed since the reference recordings
        (healthy robot), not what physics the sim lacks.

    Example:
      >>> console_lines(Verdict("not_identifiable", limits=("Nothing moved.",)), [])[1]
      ('limits', 'Nothing moved')
    """
    lines = [
        ("verdict", _verdict(verdict, changed)),
        *_all_found(verdict),
        *_errors(verdict),
        ("doubt", _doubt(verdict)),
        ("next", next_step(verdict)),
        ("limits", _limits(verdict)),
        ("files", " ".join(map(str, files))),
    ]
    return [(label, text) for label, text in lines if text]


def _verdict(verdict: Verdict, changed: bool) -> str:
    """The kind of a verdict in words, with the numbers that belong to it."""
    kind, rest = badge(verdict, changed), verdict.unexplained
    if verdict.kind == "unknown" and rest is not None:
        return (
            f"{kind}: {percent(rest.share)} of the squared error above the noise is "
            f"left, most of it in {rest.channel}"
        )
    if verdict.kind == "none" and verdict.smallest_detectable:
        amounts = [
            f"{at_words(PlacedEffect.parse(key))} of {amount_text(amount)}"
            for key, amount in verdict.smallest_detectable.items()
        ]
        shown = listing(amounts[:_SHOWN_AMOUNTS], "or")
        return f"{kind} that would be as large as {shown}"
    return kind


def _all_found(verdict: Verdict) -> Iterator[tuple[str, str]]:
    """Yield lines on the first findings, and one on the number of findings left out."""
    groups = told_together(verdict.effects)
    found = [at_many(group) if len(group) > 1 else _found(group[0]) for group in groups]
    lines = [*found, *pulse_sentences(verdict.pulses)]
    more = len(lines) - _MOST_FOUND
    for line in lines[:_MOST_FOUND] if more <= 0 else lines[: _MOST_FOUND - 1]:
        yield "found", line
    if more > 0:
        yield "", f"and {more + 1} more: the report has them all"


def _found(effect: Found) -> str:
    """A text such as "play at ...: gap 0.030 rad (0.027 to 0.034); 97 % sure"."""
    values = ", ".join(f"{name} {value}" for name, value in parameter_rows(effect))
    return f"{at_words(effect)}: {values}; {sure_text(effect.probability)}"


def _errors(verdict: Verdict) -> Iterator[tuple[str, str]]:
    """Yield lines on held-out errors of the worst channel and of all channels."""
    fit, worst = verdict.fit, headline(verdict.fit)
    if fit is None or worst is None:
        return
    after = f" -> {worst.corrected}" if verdict.effects else ""
    course = f"{worst.nominal}{after} {worst.unit}, noise floor {worst.floor}"
    yield "held out", f"error in {worst.channel} {course}"
    if verdict.effects:
        yield "", _all_channels(fit)


def _all_channels(fit: Fit) -> str:
    """Errors of all channels together, compared with controls and a regression."""
    controls = {
        "the same effect at another place": fit.wrong_place,
        "another effect at this place": fit.wrong_effect,
        "a regression without physics": fit.ceiling,
    }
    known = {name: error for name, error in controls.items() if error is not None}
    errors = fit.nominal, fit.corrected, *known.values()
    nominal, corrected, *others = errors_text(errors)
    instead = [f"{name} {error}" for name, error in zip(known, others, strict=True)]
    text = f"all channels {nominal} -> {corrected} times the noise floor"
    return f"{text}; instead of it {', '.join(instead)}" if instead else text


def _doubt(verdict: Verdict) -> str:
    """Other answers that fit as well or, without any, doubts about unsure effects."""
    if verdict.alternatives:
        also = "" if verdict.kind == "not_identifiable" else "also "
        return f"the recordings {also}fit {choice(verdict.alternatives)}"
    unsure = tuple(effect for effect in verdict.effects if effect.confusable_with)
    if not unsure:
        return ""
    more = len(unsure) - _MOST_UNSURE
    shown = doubts(replace(verdict, effects=unsure[:_MOST_UNSURE]))
    return " ".join([*shown, f"And {more} more."] if more > 0 else shown)


def _limits(verdict: Verdict) -> str:
    """The first limit of the data, and the number of further limits."""
    if not verdict.limits:
        return ""
    more = len(verdict.limits) - 1
    return verdict.limits[0].rstrip(".") + (f" (and {more} more)" if more else "")
