"""The figures of a method's score: shares, means and medians with their intervals.

Each figure is a dict {"value", "n", "low", "high"} with a 95 % interval: Wilson's for
shares of right answers, otherwise by the bootstrap over test cases (Efron 1979). If
there is nothing to count, n is 0 and the others are None. Definitions:
docs/concealed.md.
"""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from experiments.concealed.scoring.marks import NAMED_KINDS, Mark, by_kind
from experiments.concealed.size_by_information import LEVELS
from experiments.reports.statistics import wilson

Figure = dict[str, float | int | None]
Statistic = Callable[[Sequence[Mark]], float]

NOTHING: Figure = {"value": None, "n": 0, "low": None, "high": None}
"""A figure for which there was nothing to count."""

RESAMPLES = 1000
"""Number of bootstrap samples, as usual for 95 % intervals."""
FAINT = ("L3", "L4")
"""Levels of difficulty whose effects count as small."""
BINS = 10
"""Number of equal bins of the stated probability, from 0 to 1."""


def measures(marks: Sequence[Mark], seed: int) -> dict[str, Any]:
    """Compute all figures of one method's score; the bootstrap uses the seed."""
    rng = np.random.default_rng(seed)
    hidden, single = by_kind(marks, *NAMED_KINDS), by_kind(marks, "single")
    several = by_kind(marks, "pair", "triple")
    certain = [each for each in marks if each.probability is not None]
    closed = ("closed", "wrong_place", "wrong_effect")
    return {
        "right": share(each.right for each in marks),
        "right_by_kind": {
            kind: share(each.right for each in by_kind(marks, kind))
            for kind in dict.fromkeys(each.case.kind for each in marks)
        },
        "top1": _by_level(single, lambda each: each.top1),
        "there": share(each.there for each in single),
        "in_set": _by_level(single, lambda each: each.in_set),
        "set_size": _mean([each for each in single if each.set_size], "set_size", rng),
        "place": share(right for each in hidden for right in each.places),
        "pairs_f1": _bootstrap(several, f1, rng),
        "compounds": _by_level(several, lambda each: each.right),
        "parameter_error_median": _bootstrap(
            [each for each in hidden if each.errors], median_error, rng
        ),
        "coverage80": _coverage(hidden),
        "coverage80_of": {
            "small": _coverage([each for each in single if each.level in FAINT]),
            "large": _coverage([each for each in single if each.level not in FAINT]),
            "several": _coverage(several),
        },
        "closed": {name: _mean(hidden, name, rng) for name in closed},
        "null_false_alarms": share(
            each.names_something or each.kind == "missing"
            for each in by_kind(marks, "none")
        ),
        "outside_named": share(
            each.names_something or each.kind == "missing"
            for each in by_kind(marks, "outside")
        ),
        "unexcited_right": share(
            each.kind in ("none", "not_identifiable")
            for each in by_kind(marks, "unexcited")
        ),
        "ece": _bootstrap(certain, calibration_error, rng),
        "reliability": reliability(certain),
        "brier": _bootstrap(certain, brier, rng),
        "brier_constant": _bootstrap(certain, brier_constant, rng),
        "brier_skill": _bootstrap(certain, brier_skill, rng),
        "verdicts": verdicts(marks),
    }


def share(right: Iterable[bool]) -> Figure:
    """Share of true values in `right`, as a figure with Wilson's 95 % interval."""
    values = list(right)
    if not values:
        return NOTHING
    low, high = wilson(sum(values), len(values))
    value = sum(values) / len(values)
    return {"value": value, "n": len(values), "low": low, "high": high}


def f1(marks: Sequence[Mark]) -> float:
    """F1 score of the effects in all answers: 2 hits / (2 hits + extra + missed)."""
    hits = sum(each.hits for each in marks)
    wrong = sum(each.extra + each.missed for each in marks)
    return 2 * hits / max(2 * hits + wrong, 1)


def median_error(marks: Sequence[Mark]) -> float:
    """Median relative error of the found effects that have true name and place."""
    return float(np.median([error for each in marks for error in each.errors]))


def calibration_error(marks: Sequence[Mark]) -> float:
    """Expected calibration error of the probabilities stated for the first effects.

    It is the mean gap between stated probability and share of right names over ten
    equal bins, weighted by their test cases (Guo et al. 2017, equation 3).
    """
    rows = reliability(marks)
    gaps = (row["n"] * abs(row["stated"] - row["right"]["value"]) for row in rows)
    return float(sum(gaps) / max(sum(row["n"] for row in rows), 1))


def brier(marks: Sequence[Mark]) -> float:
    """Mean squared difference of the stated probability and what is true, 1 or 0.

    Source: Brier 1950, "Verification of forecasts expressed in terms of probability".
    """
    pairs = [(each.probability or 0.0, float(each.top1)) for each in marks]
    return float(np.mean([(stated - right) ** 2 for stated, right in pairs]))


def brier_constant(marks: Sequence[Mark]) -> float:
    """Brier score of the best constant probability, the share of right names."""
    right = float(np.mean([each.top1 for each in marks]))
    return right * (1 - right)


def brier_skill(marks: Sequence[Mark]) -> float:
    """Brier score's improvement on the best constant, as a share of the constant's.

    It is 1 for certain and right statements and 0 for the constant; 0 also where all
    names, or none, are right, since there the constant is perfect.
    """
    constant = brier_constant(marks)
    return 1 - brier(marks) / constant if constant > 0 else 0.0


def reliability(marks: Sequence[Mark]) -> list[dict[str, Any]]:
    """Calibration by bins of stated probability; bins without test cases are left out.

    Each has the mean stated probability ("stated"), the number of cases ("n") and the
    share whose first effect has a true name ("right").
    """
    bins: dict[int, list[Mark]] = {}
    for each in marks:
        if each.probability is not None:
            number = min(int(each.probability * BINS), BINS - 1)
            bins.setdefault(number, []).append(each)
    return [
        {
            "stated": float(np.mean([each.probability for each in members])),
            "n": len(members),
            "right": share(each.top1 for each in members),
        }
        for _, members in sorted(bins.items())
    ]


def verdicts(marks: Sequence[Mark]) -> dict[str, dict[str, int]]:
    """Number of test cases by kind of case and kind of verdict."""
    table: dict[str, dict[str, int]] = {}
    for each in marks:
        row = table.setdefault(each.case.kind, {})
        row[each.kind] = row.get(each.kind, 0) + 1
    return table


def _coverage(marks: Sequence[Mark]) -> Figure:
    return share(inside for each in marks for inside in each.covered)


def _by_level(
    marks: Sequence[Mark], is_right: Callable[[Mark], bool]
) -> dict[str, Figure]:
    figures = {
        level: share(is_right(each) for each in marks if each.level == level)
        for level in LEVELS
    }
    return {**figures, "all": share(is_right(each) for each in marks)}


def _mean(marks: Sequence[Mark], name: str, rng: np.random.Generator) -> Figure:
    """Mean of an attribute of `Mark`, with interval; None values are left out."""
    there = [each for each in marks if getattr(each, name) is not None]

    def statistic(some: Sequence[Mark]) -> float:
        return float(np.mean([getattr(each, name) for each in some]))

    return _bootstrap(there, statistic, rng)


def _bootstrap(
    marks: Sequence[Mark], statistic: Statistic, rng: np.random.Generator
) -> Figure:
    """A statistic of cases, and its 2.5 % and 97.5 % quantiles over resampled cases.

    `scipy.stats.bootstrap` draws its resamples in another order, so that all published
    intervals would change; it also needs an array, and these cases are objects.
    """
    n = len(marks)
    if not n:
        return NOTHING
    draws = [
        statistic([marks[i] for i in rng.integers(n, size=n)]) for _ in range(RESAMPLES)
    ]
    low, high = np.quantile(draws, [0.025, 0.975])
    return {"value": statistic(marks), "n": n, "low": float(low), "high": float(high)}
