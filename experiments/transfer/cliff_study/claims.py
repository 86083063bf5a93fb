"""The SGAT paper's claims on cliff walking, checked against the returns."""

from collections.abc import Sequence

from experiments.transfer.claims import Claim
from experiments.transfer.cliff_study.study import GAT, OPTIMUM, SGAT, Row

ROUNDING = 1e-9
"""Largest difference of two returns that counts as rounding."""


def check_claims(rows: Sequence[Row]) -> list[Claim]:
    """The claims that these noise values can decide, with the numbers that decide."""
    ends = [row for row in rows if row["noise"] in (0, 1)]
    between = [row for row in rows if row["noise"] not in (0, 1)]
    claims = []
    if ends:
        claims.append(_equal(ends))
    if between:
        claims.append(_at_least(between))
    return [*claims, _optimal(rows)]


def _equal(rows: Sequence[Row]) -> Claim:
    apart = max(
        abs(_more(row, SGAT, GAT, value)) for row in rows for value in ("exact", "mean")
    )
    return Claim(
        "at noise 0 and 1 GAT and SGAT return the same",
        apart <= ROUNDING,
        f"at most {apart:.3g} apart",
    )


def _at_least(rows: Sequence[Row]) -> Claim:
    more = min(
        _more(row, SGAT, GAT, value) for row in rows for value in ("exact", "mean")
    )
    return Claim(
        "in between SGAT returns at least as much as GAT",
        more >= -ROUNDING,
        f"at least {more:.3g} more",
    )


def _optimal(rows: Sequence[Row]) -> Claim:
    losses = [_more(row, OPTIMUM, SGAT, "exact") for row in rows]
    errors = [row["methods"][SGAT]["standard_error"] for row in rows]
    beyond = [
        loss > error + ROUNDING for loss, error in zip(losses, errors, strict=True)
    ]
    _, loss, error, worst = max(
        zip(beyond, losses, errors, [row["noise"] for row in rows], strict=True)
    )
    return Claim(
        "SGAT's policy is within its standard error of the optimum",
        not any(beyond),
        f"it loses {loss:.3g} with a standard error of {error:.3g} at noise {worst:g}",
    )


def _more(row: Row, method: str, other: str, value: str) -> float:
    """Return of one method minus that of another; `value` is "mean" or "exact"."""
    methods = row["methods"]
    return float(methods[method][value] - methods[other][value])
