"""The report page with the speeds and falls of a run's gaits."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from experiments.reports.origin import Origin
from experiments.reports.report import Report, markdown_table
from experiments.reports.statistics import wilson
from experiments.reports.tables import Scores, score_rows
from experiments.runs.folder import RESULT, RunFolder
from experiments.seeing.run_pictures import SEARCH_PICTURE, WALK_PICTURE
from walk_engine import PARAMETERS, Gait

PICTURES = {
    WALK_PICTURE: "The first trial of each gait in each world",
    SEARCH_PICTURE: "The search: reward and falls over the generations",
}
COLUMNS = ("world", "gait", "speed [cm/s] ± s.d.", "falls", "fall rate, 95 % interval")
MOST_NAMED = 3
"""Most gaits that the answer on a page describes; of a longer list only the best."""


def write_page(
    folder: RunFolder,
    title: str,
    scores: Scores,
    start: Mapping[str, Gait] | None = None,
) -> None:
    """Write the report page of a run whose result and pictures are written.

    The title is the question; `start` is the gait (and its name) that the run's search
    started from.
    """
    result = folder.read_json(RESULT)
    body = score_lines(scores)
    for picture, words in PICTURES.items():
        if folder.has(picture):
            body += ["", f"![{words}]({picture})"]
    if start is not None:
        table = gait_lines([*start.items(), ("tuned", result["gait"])])
        body += ["", "## The tuned gait", "", *table]
    answer = list(score_answer(scores))
    Report(title, answer, body, Origin.of_run(folder)).write(folder.path)


def score_answer(scores: Scores) -> Iterator[str]:
    """Yield for each world a sentence on the gaits' speeds and falls."""
    for world, gaits in scores.items():
        where = "real world" if world == "real" else world
        if len(gaits) <= MOST_NAMED:
            said = ", ".join(f"{name} walks {_went(gaits[name])}" for name in gaits)
        else:
            share = {n: one["falls"] / one["trials"] for n, one in gaits.items()}
            best = min(gaits, key=lambda n: (share[n], -gaits[n]["speed_cm_s"]))
            said = (
                f"the one of {len(gaits)} gaits that falls least is {best}: "
                f"{_went(gaits[best])}"
            )
        yield f"In the {where}, {said}."


def _went(score: Mapping[str, Any]) -> str:
    falls, trials = score["falls"], score["trials"]
    often = f"falls in {falls} of {trials} trials" if falls else "never falls"
    return f"{score['speed_cm_s']:.1f} cm/s and {often}"


def score_lines(scores: Scores) -> list[str]:
    """Markdown table of speeds with s.d. and of falls with Wilson's 95 % interval."""
    rows = []
    for world, gait, *texts in score_rows(scores):
        score = scores[world][gait]
        low, high = wilson(score["falls"], score["trials"])
        rows.append([world, gait, *texts, f"{low:.0%} to {high:.0%}"])
    return markdown_table(COLUMNS, rows)


def gait_lines(gaits: Sequence[tuple[str, Mapping[str, float]]]) -> list[str]:
    """Markdown table of the 16 gait parameters, with a column for each (name, gait)."""
    rows = [
        [p.name, p.unit, *(f"{gait[p.name]:.4g}" for _, gait in gaits)]
        for p in PARAMETERS
    ]
    return markdown_table(["parameter", "unit", *(name for name, _ in gaits)], rows)
