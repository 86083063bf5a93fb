"""Two methods' answers to the same test cases, compared case by case."""

from collections.abc import Callable, Mapping, Sequence

from experiments.concealed.scoring.marks import Mark

COMPARED: Mapping[str, tuple[tuple[str, ...], Callable[[Mark], bool]]] = {
    "right": ((), lambda each: each.right),
    "top1": (("single",), lambda each: each.top1),
    "null": (("none",), lambda each: not each.names_something and _answered(each)),
    "outside": (
        ("outside",),
        lambda each: not each.names_something and _answered(each),
    ),
}
"""What is compared: the kinds of cases (() for all), and when an answer is good."""


def _answered(mark: Mark) -> bool:
    return mark.kind != "missing"


def compared(
    ours: Sequence[Mark], theirs: Sequence[Mark]
) -> dict[str, dict[str, float]]:
    """Compare two methods on each of `COMPARED`; both answer the same cases in order.

    Each result holds the number of cases `n`, in how many only ours or only theirs is
    good, and the p value of `mcnemar`.
    """
    results = {}
    for name, (kinds, is_good) in COMPARED.items():
        pairs = [
            (is_good(one), is_good(other))
            for one, other in zip(ours, theirs, strict=True)
            if not kinds or one.case.kind in kinds
        ]
        only_ours = sum(one and not other for one, other in pairs)
        only_theirs = sum(other and not one for one, other in pairs)
        results[name] = {
            "n": len(pairs),
            "only_ours": only_ours,
            "only_theirs": only_theirs,
            "p": mcnemar(only_ours, only_theirs),
        }
    return results


def mcnemar(only_ours: int, only_theirs: int) -> float:
    """Exact two-sided p value of McNemar's test, from the cases that differ.

    If both methods were alike, either would win such a case with probability one half
    (McNemar 1947, "Note on the sampling error of the difference between correlated
    proportions"); 1 without such cases.

    Example:
      >>> mcnemar(8, 1)
      0.0390625
    """
    from scipy.stats import binomtest

    different = only_ours + only_theirs
    if not different:
        return 1.0
    return float(binomtest(only_ours, different).pvalue)
