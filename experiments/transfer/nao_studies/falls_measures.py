"""Measures of the groundings' forward models, before gaits walk in grounded sims."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

import robots
from experiments.grounded_walks.data import ROBOT
from experiments.grounded_walks.models import (
    ENSEMBLE,
    GAT,
    NONE,
    SGAT,
    UNEVEN,
    WalkModels,
)
from groundwalk.arrays import FloatArray
from robots import biped
from sgat.grounding_report import grounding_report
from sgat.transformers.action_transformer import ActionTransformer
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
