"""The figure and the page of a Gymnasium study."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from experiments.reports.report import markdown_table
from experiments.runs.folder import RunFolder
from experiments.transfer.claims import Claim, write_transfer_page
from experiments.transfer.gym_studies.grounding import REAL_EXPLORATION, SIM_EXPLORATION
from experiments.transfer.gym_studies.rows import (
    WAYS,
    Row,
    measures_table,
    returns_table,
)
from experiments.transfer.gym_studies.study import (
    ANE,
    GAT,
    NONE,
    REAL,
    SGAT,
    SGAT_FULL,
    GymStudy,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

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
