"""How the values of an effect were checked: what recordings and other fits say."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from diagnosis.conclude.estimates import Z_80
from diagnosis.effects import effect as kind_of
from diagnosis.verdict import Estimate, Found
from experiments.diagnosis_report.numbers import DASH, estimate_text
from experiments.diagnosis_report.place_words import place_words
from groundwalk.distributions import chi2_sf

LEVEL = 0.01
"""Probability with which recordings that agree would be called different."""


def checked(effects: Sequence[Found]) -> list[dict[str, Any]]:
    """Rows of the report's table of how values were checked, a row for each value."""
    return [
        {
            "label": kind_of(one.name).words.label,
            "place": place_words(one.place, kind_of(one.name).words.place_kind),
            "value": name.replace("_", " "),
            "found": estimate_text(estimate),
            "nominal": _nominal(estimate),
            "alone": _alone(estimate),
            "starts": _starts(estimate),
            "recordings": [
                (recording, estimate_text(_of(estimate, own.value, own.low, own.high)))
                for recording, own in estimate.recordings.items()
            ],
        }
        for one in effects
        for name, estimate in one.parameters.items()
    ]


def agree(estimate: Estimate) -> bool | None:
    """Whether what recordings say alone differs by no more than their errors.

    By the chi-square test at the level 1 %; None if there are fewer than two. Distances
    are from the value of all, in errors that follow from each recording's interval. One
    whose interval has no width, since it lies beyond a bound of the value, is left out.
    """
    known = [one for one in estimate.recordings.values() if one.high > one.low]
    if len(known) < 2:
        return None
    total = 0.0
    for one in known:
        far = estimate.value - one.value
        towards = one.high - one.value if far > 0 else one.value - one.low
        width = towards or one.high - one.low
        total += (far * Z_80 / width) ** 2
    return chi2_sf(total, len(known) - 1) > LEVEL


def _alone(estimate: Estimate) -> str:
    """The span of what recordings say alone, and whether they agree."""
    alike = agree(estimate)
    if alike is None:
        return DASH
    values = [one.value for one in estimate.recordings.values()]
    word = "agree" if alike else "differ by more than their errors"
    return f"{_span(estimate, min(values), max(values))}: {len(values)} {word}"


def _starts(estimate: Estimate) -> str:
    return DASH if estimate.starts is None else _span(estimate, *estimate.starts)


def _nominal(estimate: Estimate) -> str:
    """The value at which nothing is missing, as text."""
    nominal = estimate.nominal
    if nominal is None:
        return DASH
    return estimate_text(_of(estimate, nominal, nominal, nominal))


def _span(estimate: Estimate, low: float, high: float) -> str:
    """Two values with their unit, such as "0.249 to 0.252 N m"; one if alike.

    They have as many digits as the estimate has with its interval.
    """
    first, last = (_rounded(estimate, value) for value in (low, high))
    if first == last:
        return first
    unit = last.partition(" ")[2]
    return (
        f"{first.removesuffix(f' {unit}')} to {last}" if unit else f"{first} to {last}"
    )


def _rounded(estimate: Estimate, value: float) -> str:
    width = estimate.high - estimate.low
    return estimate_text(_of(estimate, value, value, value + width)).partition(" (")[0]


def _of(estimate: Estimate, value: float, low: float, high: float) -> Estimate:
    return replace(estimate, value=value, low=low, high=high)
