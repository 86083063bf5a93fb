"""The page of a check of recordings, and the files of the motions to record next."""

from diagnosis.check.result import Check
from experiments.check_report.words import (
    CAREFUL,
    NOISE,
    RECORDINGS,
    finding_lines,
    lost_sentences,
    noise_rows,
    proposed_lines,
    recording_rows,
    size_tables,
    verdict_sentence,
    without_empty,
)
from experiments.diagnosis_report.place_words import sentence
from experiments.reports.origin import Origin
from experiments.reports.report import Report, markdown_table
from experiments.runs.folder import RunFolder

MEANING = (
    "Each size is the smallest at which a diagnosis of these recordings would name the "
    "effect, if the model were right otherwise but for the usual small mismatch of "
    "masses, gains and friction. They are computed, not tried, and a factor of two is "
    "a lot. Where more is wrong with the model, sizes are larger. A value after < is "
    "one below which a limit or a stiffness must be. A dash: no possible size is told."
)


def write_page(folder: RunFolder, found: Check) -> None:
    """Write `result.md` and `report.html` into a run's folder."""
    answer = [verdict_sentence(found)]
    body = [
        *_findings(found),
        "## The recordings",
        "",
        *markdown_table(RECORDINGS, recording_rows(found)),
        "",
    ]
    if found.noise:
        body += ["## Noise", "", *markdown_table(NOISE, noise_rows(found)), ""]
    if found.sizes:
        body += ["## The smallest sizes that would be told", "", MEANING, ""]
        for columns, rows in size_tables(found):
            body += [*markdown_table(*without_empty(columns, rows)), ""]
    body += _list("What cannot be told", lost_sentences(found))
    body += _list("What to record next", proposed_lines(found))
    body += [CAREFUL, ""] if found.proposed else []
    question = "What can these recordings show, and what should be recorded next?"
    Report(question, answer, body, Origin.of_run(folder)).write(folder.path)


def _findings(found: Check) -> list[str]:
    said = [f"{severity}: {sentence(text)}" for severity, text in finding_lines(found)]
    return _list("What is suspicious, or limits conclusions", said)


def _list(title: str, said: list[str]) -> list[str]:
    """Lines of Markdown with a list; none without items."""
    return [f"## {title}", "", *(f"- {one}" for one in said), ""] if said else []
