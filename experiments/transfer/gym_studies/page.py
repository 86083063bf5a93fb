"""Results of a Gymnasium study over all seeds: tables, claims, figure and page."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from experiments.reports.report import markdown_table
from experiments.runs.folder import RunFolder
from experiments.transfer.claims import Claim, write_transfer_page
from experiments.transfer.gym_studies.grounding import REAL_EXPLORATION, SIM_EXPLORATION
from experiments.transfer.gym_studies.study import (
    ANE,
    GAT,
    NONE,
    REAL,
    SGAT,
    SGAT_FULL,
    Cell,
    GymStudy,
)
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


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


NOTES = """
The sim is Gymnasium's {environment}. The real world is the same with noisy actions; in
the setting noisy-real, the mass and inertia of {heavy} are also {factor:.4g} times as
large. Noise is Gaussian; its standard deviation is given as a fraction of half of the
action's range, here {unit:g}. It is added to the action, and the sum is clipped to the
range. Where the reward charges for actions, it charges for the policy's own ones.

TRPO (sb3-contrib) first trains {timesteps} steps in the sim: "none". All others go on
from that policy for as many steps again, each in a world of its own: "gat" and "sgat"
in the sim after one grounding step, with the mean or a sampled next state, "ane" in the
sim with noise on actions, "real" in the real world. "real" is an upper bound only if
that many steps are enough; the claims say where they are not: a policy that falls at
once learns little from each step.
The paper's "sgat" samples every dimension of the next state independently, "sgat-full"
all of them with their covariance. The noise ratio shows the difference: it is the noise
on actions in the grounded sim, divided by the noise of those sim actions that would
reproduce held-out real transitions. One noisy force moves several dimensions together;
where the samples lack that correlation, the inverse model averages the noise out, and
the grounded sim is less noisy than the real world.
Grounding takes {real_steps} transitions of real and {sim_steps} of the sim, by the
stochastic policy with {real_exploration:.0%} and {sim_exploration:.0%} random actions.
ANE trains at the noise levels {envelopes} and takes the
one that returns most in {search_episodes} episodes on real; their steps are in the
table. Each policy is tried for {episodes} episodes on real, with its mean action
(deterministic) and with random ones (stochastic). Versions 5 of these environments pay
nothing for the step that fails, so a failed episode returns 1 less than in the paper.

TRPO: {trpo}. These are the values of the grounding papers' own later code where the
table of its domains has them; the batch and the trust region are the size's own.
Likelihoods are per dimension, in units of the state. Bias and spread are mean and
standard deviation of what the transformer adds to actions of real data, in the action's
unit.
"""


def write_gym_page(
    folder: RunFolder,
    figure: str,
    size: str,
    study: GymStudy,
    rows: Sequence[Row],
    claims: Sequence[Claim],
) -> None:
    """Write `result.md` and `report.html` into the run's folder.

    `figure` is the name of a file that is in the folder already, `size` the name of the
    study's size.
    """
    grid = f"{study.seeds} seeds, {len(study.noises)} noise values"
    body = [f"The grid is {size}: {grid}, {study.timesteps} steps in each training."]
    body += ["", f"![Returns on real]({figure})", ""]
    for way in WAYS:
        body += [f"Returns on real, {way} policies, mean ± standard error over seeds:"]
        body += ["", *markdown_table(*returns_table(rows, way)), ""]
    body += ["Cost and quality of each method (means over seeds):", ""]
    body += [*markdown_table(*measures_table(rows)), "", _notes(study)]
    write_transfer_page(folder, study.domain.title, claims, body)


def _notes(study: GymStudy) -> str:
    low, high = study.domain.bounds()
    return NOTES.format(
        environment=study.domain.environment,
        heavy=", ".join(study.domain.heavy_bodies) or "all bodies",
        factor=study.domain.mass_factor,
        unit=(high - low).max() / 2,
        timesteps=study.timesteps,
        real_steps=study.real_steps,
        sim_steps=study.sim_steps,
        real_exploration=REAL_EXPLORATION,
        sim_exploration=SIM_EXPLORATION,
        envelopes=", ".join(f"{level:g}" for level in study.envelopes),
        search_episodes=study.search_episodes,
        episodes=study.episodes,
        trpo=", ".join(f"{name} {value:g}" for name, value in study.trpo.items()),
    ).strip()


COLOURS = {
    NONE: "#7f8894",
    GAT: "#d55e00",
    SGAT: "#56b4e9",
    SGAT_FULL: "#0072b2",
    ANE: "#e69f00",
}
"""Colours of the methods, which colour-blind people can distinguish (Okabe and Ito)."""
OTHER_COLOUR = "#009e73"
LINE_COLOUR = "#b2182b"
GROUP_WIDTH = 0.8


def returns_figure(rows: Sequence[Row]) -> "Figure":
    """Bars for the methods over noise, dashed lines for training in the real world.

    There is at least one row of results; each setting has its own axes.
    """
    from matplotlib.figure import Figure

    settings = list(dict.fromkeys(row["setting"] for row in rows))
    figure = Figure(figsize=(6.4 * len(settings), 4), dpi=150, layout="constrained")
    every = figure.subplots(1, len(settings), squeeze=False)[0]
    for axes, setting in zip(every, settings, strict=True):
        _draw(axes, [row for row in rows if row["setting"] == setting])
        axes.set_title(setting)
    every[0].set_ylabel("return on real\n(mean and standard error over seeds)")
    return figure


def _draw(axes: "Axes", rows: Sequence[Row]) -> None:
    bars = [name for name in rows[0]["methods"] if name != REAL]
    width = GROUP_WIDTH / max(len(bars), 1)
    for column, name in enumerate(bars):
        found = [row["methods"][name]["deterministic"] for row in rows]
        aside = (column - (len(bars) - 1) / 2) * width
        axes.bar(
            [place + aside for place in range(len(rows))],
            [score["mean"] for score in found],
            width,
            yerr=[score["standard_error"] for score in found],
            color=COLOURS.get(name, OTHER_COLOUR),
            capsize=3,
            label=name,
        )
    for place, row in enumerate(rows):
        if REAL in row["methods"]:
            height = row["methods"][REAL]["deterministic"]["mean"]
            axes.plot(
                [place - GROUP_WIDTH / 2, place + GROUP_WIDTH / 2],
                [height, height],
                color=LINE_COLOUR,
                linestyle="--",
                label=None if place else "as many steps on real",
            )
    axes.set_xticks(range(len(rows)), [f"{row['noise']:g}" for row in rows])
    axes.set_xlabel("noise: standard deviation over half of the action's range")
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
