"""How well sims predict real falls and speeds of gaits: numbers, table and page."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from experiments.grounded_walks.models import ENSEMBLE, SGAT, UNEVEN
from experiments.reports.report import markdown_table
from experiments.reports.statistics import NORMAL_95
from experiments.runs.folder import RunFolder
from experiments.transfer.claims import Claim, write_transfer_page
from experiments.transfer.nao_studies.falls_figure import FIGURE
from experiments.transfer.nao_studies.falls_measures import (
    GROUNDINGS,
    MEASURE_HEADINGS,
    MEASURES_FIGURE,
    measure_rows,
)
from groundwalk.arrays import FloatArray
from sgat.transformers.catalogue import grounding

GOAL = 0.7
"""Correlation of predicted and real fall rates with which a sim counts as good."""
MEASURES = "measures"
"""Key of the models' measures in the run's results."""
HEADINGS = (
    "grounding", "falls: correlation", "rmse", "mean rate", "speed: correlation",
    "rmse [cm/s]",
)  # fmt: skip

Row = dict[str, Any]
"""Numbers of a grounding: its name, and how well it predicts fall rates and speeds."""


def prediction_rows(state: Mapping[str, Any]) -> list[Row]:
    """How well each grounding in `state` predicts the real fall rates and speeds."""
    real = {name: np.array(values) for name, values in state["real"].items()}
    rows: list[Row] = []
    for name in GROUNDINGS:
        predicted = {key: np.array(values) for key, values in state[name].items()}
        row: Row = {"grounding": name}
        for key in ("fall_rate", "speed_cm_s"):
            row[key] = {
                "correlation": correlation(predicted[key], real[key]),
                "rmse": float(np.sqrt(np.mean((predicted[key] - real[key]) ** 2))),
                "predicted_mean": float(predicted[key].mean()),
                "real_mean": float(real[key].mean()),
            }
        rows.append(row)
    return rows


def correlation(predicted: FloatArray, real: FloatArray) -> float | None:
    """Pearson's correlation of two arrays (gaits,); None if one of them is constant."""
    if predicted.std() == 0 or real.std() == 0:
        return None
    return float(np.corrcoef(predicted, real)[0, 1])


def table_of(rows: Sequence[Row]) -> list[list[str]]:
    """A row of texts for each grounding, under `HEADINGS`."""
    return [
        [
            row["grounding"],
            _number(row["fall_rate"]["correlation"]),
            "{rmse:.2f}".format(**row["fall_rate"]),
            "{predicted_mean:.2f} (real {real_mean:.2f})".format(**row["fall_rate"]),
            _number(row["speed_cm_s"]["correlation"]),
            "{rmse:.1f}".format(**row["speed_cm_s"]),
        ]
        for row in rows
    ]


def correlation_interval(r: float, pairs: int) -> tuple[float, float]:
    """95 % interval of a correlation (Fisher 1921).

    If the correlation r is computed from a number of pairs, atanh(r) is nearly normal
    with the standard deviation 1 / sqrt(pairs - 3).
    """
    if pairs <= 3:
        return -1.0, 1.0
    half = NORMAL_95 / np.sqrt(pairs - 3)
    middle = np.arctanh(np.clip(r, -1 + 1e-12, 1 - 1e-12))
    return float(np.tanh(middle - half)), float(np.tanh(middle + half))


def write_falls_page(
    folder: RunFolder, rows: Sequence[Row], state: Mapping[str, Any], trials: int
) -> None:
    """Write `result.md` and `report.html` of the study of falls into the run's folder.

    `prediction_rows` made the rows from `state`; `trials` are real walks of each gait.
    """
    count = len(state["real"]["fall_rate"])
    by_name = {row["grounding"]: row["fall_rate"]["correlation"] or 0.0 for row in rows}
    best = max(by_name, key=lambda name: by_name[name])
    low, high = correlation_interval(by_name[best], count)
    claims = [
        Claim(
            f"the best grounding's fall rates correlate with the real ones by {GOAL}",
            by_name[best] >= GOAL,
            f"{best}: {by_name[best]:.2f}, 95 % interval {low:.2f} to {high:.2f}",
        ),
        Claim(
            "an uneven sim predicts falls better than SGAT on the flat",
            by_name[UNEVEN] > by_name[SGAT],
            f"{by_name[UNEVEN]:.2f} against {by_name[SGAT]:.2f}",
        ),
    ]
    body = [
        f"{count} gaits that no grounding has seen, each on {trials} real grounds.",
        *(line for name in (ENSEMBLE, UNEVEN) for line in grounding(name).means),
        "",
        f"![Predicted against real]({FIGURE})",
        "",
        *markdown_table(HEADINGS, table_of(rows)),
        "",
        "## How good the groundings are, before any gait is tried in them",
        "",
        f"On {count} real walks of the held-out gaits; medians over joints or",
        "dimensions. Residuals are standardised: a correct Gaussian model has 90 % of",
        "them within its 90 % interval, no correlation and no excess kurtosis. Shift",
        "and spread are of what the transformer adds to a command.",
        "",
        f"![What the models predict]({MEASURES_FIGURE})",
        "",
        *markdown_table(MEASURE_HEADINGS, measure_rows(state[MEASURES])),
    ]
    title = "Does the grounded sim know which gaits fall?"
    know = "Yes" if by_name[best] >= GOAL else "Not well enough"
    answer = (
        f"{know}: of {len(by_name)} sims, {best} predicts best how often a gait falls "
        f"on real ground, with a correlation of {by_name[best]:.2f} "
        f"(95 % interval {low:.2f} to {high:.2f}); {GOAL} is asked for."
    )
    write_transfer_page(folder, title, claims, body, [answer])


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"
