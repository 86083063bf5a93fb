"""Results of a Gymnasium study over all seeds: returns, tables and claims."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from experiments.transfer.claims import Claim
from experiments.transfer.gym_studies.study import GAT, REAL, SGAT, SGAT_FULL, Cell
from groundwalk.arrays import FloatArray

WAYS = ("deterministic", "stochastic")
"""How a policy is tried: with its mean action, or with random actions."""
NUMBERS = (
    "real_steps", "envelope", "forward_log_likelihood", "inverse_r_squared",
    "action_bias", "action_spread", "noise_ratio",
)  # fmt: skip

Row = dict[str, Any]
"""Results in one real world: its `setting` and `noise`, and the numbers of each method
under `methods`."""


def rows_of(cells: Sequence[Cell]) -> list[Row]:
    """A row for each setting and noise, in the order of the cells.

    A cell is the result of one method with one seed. A row has the mean return over
    seeds, its standard error, and each seed's return; all other numbers are averaged.
    """
    worlds = dict.fromkeys((cell["setting"], cell["noise"]) for cell in cells)
    rows = []
    for setting, noise in worlds:
        here = [c for c in cells if (c["setting"], c["noise"]) == (setting, noise)]
        methods = {
            name: _over_seeds([cell for cell in here if cell["method"] == name])
            for name in dict.fromkeys(cell["method"] for cell in here)
        }
        rows.append({"setting": setting, "noise": noise, "methods": methods})
    return rows


def _over_seeds(cells: Sequence[Cell]) -> dict[str, Any]:
    cells = sorted(cells, key=lambda cell: int(cell["seed"]))
    row: dict[str, Any] = {"seeds": len(cells)}
    for way in WAYS:
        returns = np.array([cell[way]["mean"] for cell in cells])
        row[way] = {**_mean(returns), "returns": returns.tolist()}
    for name in NUMBERS:
        if name in cells[0]:
            row[name] = float(np.mean([cell[name] for cell in cells]))
    return row


def _mean(values: FloatArray) -> dict[str, float]:
    """Mean and standard error of the mean."""
    error = values.std(ddof=1) / np.sqrt(len(values))
    return {"mean": float(values.mean()), "standard_error": float(error)}


def check_claims(rows: Sequence[Row]) -> list[Claim]:
    """The claims that these rows can decide, all about deterministic policies."""
    claims = []
    for setting in dict.fromkeys(row["setting"] for row in rows):
        row = max(
            (row for row in rows if row["setting"] == setting),
            key=lambda row: float(row["noise"]),
        )
        claims += [
            _more_than_gat(row, sampled)
            for sampled in (SGAT, SGAT_FULL)
            if {GAT, sampled} <= set(row["methods"])
        ]
    claims += [_below_real(row) for row in rows if REAL in row["methods"]]
    return claims


def _more_than_gat(row: Row, sampled: str) -> Claim:
    """The claim that `sampled`, a kind of SGAT, returns more than GAT."""
    sgat, gat = (row["methods"][name][WAYS[0]] for name in (sampled, GAT))
    more = _mean(np.subtract(sgat["returns"], gat["returns"]))
    return Claim(
        f"{row['setting']}, noise {row['noise']:g}: {sampled} returns more than {GAT}",
        sgat["mean"] > gat["mean"],
        f"{_text(sgat)} against {_text(gat)}; seed by seed {_text(more)} more",
    )


def _below_real(row: Row) -> Claim:
    """The claim that no method returns more than training on real, an upper bound."""
    found = {name: method[WAYS[0]] for name, method in row["methods"].items()}
    best = max(found, key=lambda name: float(found[name]["mean"]))
    return Claim(
        f"{row['setting']}, noise {row['noise']:g}: nothing returns more than as "
        "many steps of training on real",
        found[REAL]["mean"] >= found[best]["mean"],
        f"best is {best} with {_text(found[best])}, real has {_text(found[REAL])}",
    )


def returns_table(rows: Sequence[Row], way: str) -> tuple[list[str], list[list[str]]]:
    """Headings and rows of mean returns on real; `way` is one of `WAYS`."""
    names = list(rows[0]["methods"])
    texts = [
        [row["setting"], f"{row['noise']:g}"]
        + [_text(row["methods"][name][way]) for name in names]
        for row in rows
    ]
    return ["setting", "noise", *names], texts


def measures_table(rows: Sequence[Row]) -> tuple[list[str], list[list[str]]]:
    """Headings and rows of the cost and quality of each method's grounding."""
    texts = []
    for row in rows:
        for name, method in row["methods"].items():
            numbers = [f"{method[key]:.4g}" if key in method else "" for key in NUMBERS]
            texts.append([row["setting"], f"{row['noise']:g}", name, *numbers])
    headings = [name.replace("_", " ") for name in NUMBERS]
    return ["setting", "noise", "method", *headings], texts


def _text(returns: dict[str, float]) -> str:
    return f"{returns['mean']:.1f} ± {returns['standard_error']:.1f}"
