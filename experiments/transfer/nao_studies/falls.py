"""How well sims predict real falls and speeds of gaits: numbers, figures and page.

Before gaits walk in grounded sims, the groundings' forward models are measured.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

import robots
from experiments.grounded_walks.models import (
    ENSEMBLE,
    GAT,
    NONE,
    SGAT,
    UNEVEN,
    WalkModels,
)
from experiments.grounded_walks.walks import ROBOT
from experiments.reports.report import markdown_table
from experiments.reports.statistics import NORMAL_95
from experiments.runs.folder import RunFolder
from experiments.transfer.claims import Claim, write_transfer_page
from groundwalk.arrays import FloatArray
from robots import biped
from sgat.grounding_report import grounding_report
from sgat.transformers.action_transformer import ActionTransformer
from sgat.transformers.catalogue import grounding
from sgat.transitions import Transitions
from sgat.walks.walk_senses import leg_senses

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MEASURES_FIGURE = "transfer_nao_falls_measures.png"
GROUNDINGS = (NONE, GAT, SGAT, ENSEMBLE, UNEVEN)
"""Sims whose predictions of falls are compared, by the titles of their groundings."""

MEASURED = (SGAT, ENSEMBLE)
"""Groundings whose forward models are measured: those that predict a distribution."""

ROWS = 500
"""Largest number of states at which transformed actions are examined."""

TICK_MS = 10
"""Control tick [ms]."""

MEASURE_HEADINGS = (
    "grounding", "R² joints", "R² gyroscope", "R² tilt",
    "10 ticks ahead, joints [mrad]", "log-likelihood", "within 90 %",
    "lag-1 correlation", "excess kurtosis", "action shift [mrad]",
    "action spread [mrad]",
)  # fmt: skip

Measures = Mapping[str, Mapping[str, Any]]


def measures_of(
    models: WalkModels, unseen: Transitions, seed: np.random.SeedSequence
) -> dict[str, dict[str, Any]]:
    """Measure the models of the groundings `MEASURED` on real walks they have not seen.

    The seed is that of the transformers' noise. The result has, for each grounding, the
    measures of `grounding_report`, and the mean and standard deviation of what its
    transformer adds to each joint's command [rad].
    """
    senses = leg_senses(robots.get(ROBOT))
    found = {}
    for name in MEASURED:
        transformer = models.grounded(name).transformer
        assert isinstance(transformer, ActionTransformer)
        forward = transformer.forward

        def advance(state: FloatArray, action: FloatArray) -> FloatArray:
            outcome = forward.predict(state, action)  # noqa: B023
            return senses.advanced(state, action, outcome)

        added = _added(transformer, unseen, seed)
        found[name] = grounding_report(forward, unseen, advance) | added
    return found


def _added(
    transformer: ActionTransformer, unseen: Transitions, seed: np.random.SeedSequence
) -> dict[str, list[float]]:
    """Mean and standard deviation of a transformer's addition to each command [rad]."""
    rows = np.random.default_rng(seed).choice(unseen.n, min(ROWS, unseen.n), False)
    transformer.reset(np.random.SeedSequence(seed.entropy).spawn(len(rows)))
    action = unseen.action[rows]
    added = transformer(unseen.state[rows], action) - action
    return {
        "action_shift_rad": added.mean(axis=0).tolist(),
        "action_spread_rad": added.std(axis=0).tolist(),
    }


def measure_rows(measures: Measures) -> list[list[str]]:
    """A row of texts for each grounding: medians over joints or a state's columns."""
    joints = len(leg_senses(robots.get(ROBOT)).joints)
    rows = []
    for name, found in measures.items():
        share = np.array(found["one_step_r_squared"], float)
        ahead = np.array(found["multi_step_error"], float)[-1, :joints]
        level = found["levels"].index(0.9)
        rows.append(
            [
                name,
                *(
                    f"{np.nanmedian(part):.2f}"
                    for part in (share[:joints], share[joints:-2], share[-2:])
                ),
                f"{1e3 * np.median(ahead):.0f}",
                f"{found['log_likelihood']:.2f}",
                f"{np.median(found['coverage'][level]):.0%}",
                f"{np.nanmedian(np.array(found['autocorrelation'][0], float)):.2f}",
                f"{np.nanmedian(np.array(found['excess_kurtosis'], float)):.1f}",
                f"{1e3 * np.median(np.abs(found['action_shift_rad'])):.1f}",
                f"{1e3 * np.median(found['action_spread_rad']):.1f}",
            ]
        )
    return rows


def measures_figure(measures: Measures) -> "Figure":
    """Four panels on how well the forward models of each grounding predict."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 3.4), dpi=160, layout="constrained")
    shares, growth, calibration, memory = figure.subplots(1, 4)
    legs = biped(description := robots.get(ROBOT))
    joints = [description.joints[i] for i in (*legs.left_leg, *legs.right_leg)]
    names = [*joints, "gyro x", "gyro y", "gyro z", "tilt x", "tilt y"]
    for k, (name, found) in enumerate(measures.items()):
        share = np.array(found["one_step_r_squared"], float)
        shares.barh(np.arange(len(share)) + 0.4 * k, share, 0.4, label=name)
        ahead = 1e3 * np.array(found["multi_step_error"], float)[:, : len(joints)]
        ticks = TICK_MS * np.arange(1, len(ahead) + 1)
        growth.plot(ticks, np.median(ahead, axis=1), marker=".")
        within = np.median(np.array(found["coverage"], float), axis=1)
        calibration.plot(found["levels"], within, marker="o")
        lags = np.array(found["autocorrelation"], float)
        memory.plot(TICK_MS * np.arange(1, len(lags) + 1), np.nanmedian(lags, axis=1))
    shares.set_yticks(np.arange(len(names)) + 0.2, names, fontsize=5)
    shares.set(xlabel="R² of one tick's change", xlim=(0, 1))
    shares.legend(fontsize=7, frameon=False)
    calibration.plot([0.5, 1], [0.5, 1], color="0.7", linewidth=1)
    growth.set(xlabel="ahead [ms]", ylabel="median joint error [mrad]", ylim=(0, None))
    calibration.set(xlabel="interval", ylabel="residuals within it")
    memory.axhline(0, color="0.7", linewidth=1)
    memory.set(xlabel="lag [ms]", ylabel="correlation of residuals")
    for panel in (shares, growth, calibration, memory):
        panel.spines[["top", "right"]].set_visible(False)
    return figure


FIGURE = "transfer_nao_falls.png"

PANELS = (("fall_rate", "fall rate", 1.0), ("speed_cm_s", "speed [cm/s]", 40.0))
"""For each row of panels: key of the results, label, and upper end of the axes."""


def falls_figure(state: Mapping[str, Any]) -> "Figure":
    """A column for each grounding: fall rates above, speeds below.

    `state` has the fall rates and speeds [cm/s] of the gaits, in the real world
    ("real") and as each grounding's sim predicts them.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 5.4), dpi=160, layout="constrained")
    axes = figure.subplots(2, len(GROUNDINGS), sharex="row", sharey="row")
    for column, name in enumerate(GROUNDINGS):
        for row, (key, label, largest) in enumerate(PANELS):
            panel = axes[row, column]
            panel.plot([0, largest], [0, largest], color="0.75", linewidth=1)
            panel.scatter(state["real"][key], state[name][key], s=22, color="#0072b2")
            panel.set(xlabel=f"real {label}", aspect="equal")
            panel.spines[["top", "right"]].set_visible(False)
            if column == 0:
                panel.set_ylabel(f"predicted {label}")
        axes[0, column].set_title(name)
    return figure


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
