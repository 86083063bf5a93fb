"""A diagnosis as one HTML page that needs nothing else: plain words, then evidence."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from diagnosis.conclude.held_out_series import HeldOutSeries, by_error
from diagnosis.verdict.verdict import Errors, Fit, Found, Verdict
from experiments.diagnosis_report.figures import (
    View,
    bars_figure,
    overlay_figure,
    unexplained_figure,
)
from experiments.diagnosis_report.mismatch_map import mismatch_figure, worst_cells
from experiments.diagnosis_report.numbers import (
    DASH,
    amount_text,
    error_unit,
    errors_text,
    percent,
)
from experiments.diagnosis_report.place_words import place_words
from experiments.diagnosis_report.run_facts import ReportFacts
from experiments.diagnosis_report.svg import inline_svg
from experiments.diagnosis_report.text import (
    answer,
    badge,
    doubts,
    next_step,
    parameter_rows,
    question,
)
from experiments.diagnosis_report.words import effect_words
from experiments.reports.html import render
from groundwalk.files import write_text

TEMPLATE = "diagnosis_report.html.jinja"
MOST_PICTURES, SHOWN_ROWS = 4, 13
_OFF = 1.05
"""Times the noise: what is nearer to it has nothing to close."""
_COLUMNS = ("nominal", "corrected", "floor", "ceiling", "wrong_place", "wrong_effect")
_USES = {"fit": "fitted on", "select": "chosen on", "test": "kept out"}


def write_report(
    path: Path, verdict: Verdict, series: Sequence[HeldOutSeries], facts: ReportFacts
) -> None:
    """Write the page, the file at once.

    Args:
      path: the `.html` file.
      verdict: what the diagnosis says.
      series: held-out recordings with what both sims make of them, the most telling
        first; may be empty.
      facts: where this comes from.

    Raises:
      UnknownNameError: the verdict names an effect that has no words.
    """
    parts = _words(verdict, facts) | _shown(verdict, series) | _made(verdict, facts)
    write_text(path, render(TEMPLATE, **parts))


def _words(verdict: Verdict, facts: ReportFacts) -> dict[str, Any]:
    """What the page says in words and small tables."""
    return {
        "verdict": verdict,
        "title": f"Diagnosis: {facts.robot}",
        "question": question(facts.robot, facts.changed),
        "badge": badge(verdict, facts.changed),
        "answer": answer(verdict, facts.changed),
        "doubts": doubts(verdict),
        "next_step": next_step(verdict),
        "effects": [_effect_row(effect) for effect in verdict.effects],
        "smallest": [
            {**_label_and_place(*key.split("@", 1)), "amount": amount_text(amount)}
            for key, amount in sorted(verdict.smallest_detectable.items())
        ],
        "fit_rows": _fit_rows(verdict.fit) if verdict.fit else [],
        "shown_rows": SHOWN_ROWS,
    }


def _made(verdict: Verdict, facts: ReportFacts) -> dict[str, Any]:
    """What the page says of how it was made."""
    recordings = [
        (_USES[use], ", ".join(names))
        for use, names in vars(verdict.recordings).items()
        if names
    ]
    return {
        "command": facts.command,
        "made": [
            ("robot", f"{facts.robot}, {facts.base} base"),
            *recordings,
            *facts.settings.items(),
            *facts.versions.items(),
            ("took", f"{verdict.seconds:.0f} s"),
        ],
        "files": facts.files,
    }


def _shown(verdict: Verdict, series: Sequence[HeldOutSeries]) -> dict[str, Any]:
    """What the page shows in figures."""
    rest, cells = verdict.unexplained, worst_cells(verdict.mismatch)
    return {
        "unexplained": rest
        and {
            "rest": rest,
            "svg": inline_svg(
                unexplained_figure(rest), "unexplained", "error that is left"
            ),
        },
        "map": cells
        and {
            "svg": inline_svg(mismatch_figure(cells), "map", "mismatch by channel"),
            "regimes": any(cell.regimes for cell in cells),
            "bursts": any(cell.bursts for cell in cells),
            "left_out": len(verdict.mismatch) - len(cells),
        },
        "bars": verdict.fit
        and inline_svg(
            bars_figure(verdict.fit, bool(verdict.effects)), "bars", "errors"
        ),
        "pictures": [
            _picture(one, verdict, f"picture{index}")
            for index, one in enumerate(series[:MOST_PICTURES])
        ],
        "left_out_pictures": max(0, len(series) - MOST_PICTURES),
    }


def _picture(series: HeldOutSeries, verdict: Verdict, name: str) -> dict[str, Any]:
    """The worst channel of a held-out recording."""
    channel = by_error(series, verdict.fit)[0]
    scored = verdict.fit.channels.get(channel) if verdict.fit else None
    view = View(
        unit=scored.unit if scored else "SI unit",
        floor=scored.floor if scored else None,
        is_corrected=bool(verdict.effects),
    )
    figure = overlay_figure(series, channel, view)
    return {
        "name": series.name,
        "svg": inline_svg(figure, name, f"{channel} of {series.name}: real and sim"),
    }


def _effect_row(effect: Found) -> dict[str, Any]:
    course = effect.when
    times = (
        "all the time"
        if course.kind == "always"
        else f"{course.kind}, {course.start_s:.3g} to {course.end_s:.3g} s"
    )
    return {
        **_label_and_place(effect.name, effect.place),
        "parameters": parameter_rows(effect),
        "sure": percent(effect.probability),
        "when": times,
        "meaning": effect_words(effect.name).meaning,
        "native": effect.native,
    }


def _label_and_place(name: str, place: str) -> dict[str, str]:
    words = effect_words(name)
    return {"label": words.label, "place": place_words(place, words.place_kind)}


def _fit_rows(fit: Fit) -> list[dict[str, Any]]:
    """The errors in all, then channel by channel, the worst one first."""
    channels = sorted(fit.channels.items(), key=lambda item: -item[1].excess)
    return [
        _fit_row("all channels", "noise", fit),
        *(_fit_row(name, one.unit, one) for name, one in channels),
    ]


def _fit_row(name: str, unit: str, fit: Errors) -> dict[str, Any]:
    errors = [getattr(fit, column) for column in _COLUMNS]
    factor, unit = error_unit(unit, max(filter(None, errors), default=0.0))
    texts = errors_text(error and factor * error for error in errors)
    off = fit.nominal > _OFF * fit.floor
    closed = fit.closed(fit.corrected) if off else None
    return {
        "channel": name,
        **dict(zip(_COLUMNS, texts, strict=True)),
        "unit": unit,
        "closed": DASH if closed is None else percent(max(0.0, closed)),
        "is_all": isinstance(fit, Fit),
    }
