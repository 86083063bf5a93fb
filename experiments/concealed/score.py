"""`groundwalk concealed score`: open the sealed truth and score the answers."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar

import tyro

from diagnosis.effects import all_effects
from experiments.command_line import run_verb
from experiments.concealed.reading import ANSWERS, CASES
from experiments.concealed.scoring.answers import Answer, Named
from experiments.concealed.scoring.marks import NAMED_KINDS, case_level, mark
from experiments.concealed.scoring.measures import measures
from experiments.concealed.scoring.oracle import Oracle, answer_key, consult
from experiments.concealed.scoring.page import draw_score, score_report, score_rows
from experiments.concealed.scoring.paired import compared
from experiments.concealed.scoring.truth import (
    TrueCase,
    Truth,
    read_answers,
    read_baselines,
    read_truth,
)
from experiments.reports.origin import Origin
from experiments.reports.tables import print_table
from experiments.runs.extras import extra
from experiments.runs.folder import PROVENANCE, RunFolder, provenance
from experiments.runs.options import REPEATABLE, check_at_least
from experiments.runs.processes import as_done, process_pool
from experiments.runs.progress import progress
from groundwalk.errors import BadValueError
from groundwalk.files import write_text

VERB = "concealed-score"
FORMAT = 1
DIAGNOSIS = "diagnosis"
ORACLE, SCORE, PAGE, FIGURE = "oracle", "score.json", "score.md", "score.png"
Answers = Mapping[str, Mapping[str, Answer]]
"""Answers by method and name of the test case; methods are "diagnosis", the names of
baselines, and those of folders of other tools' answers."""


@dataclass(frozen=True)
class ConcealedScore:
    """Open the sealed truth of a set of test cases and score all answers to it.

    Attributes:
      folder: folder of the set of cases, with answers. The results are written there:
        score.json, score.md, score.png and report.html.
      answers: folders of answers by other tools (docs/concealed_answers.md), which are
        scored beside the diagnosis, under the names of the folders.
      threads: number of processes that fit the true effects; 0 for one per core.
    """

    if_interrupted: ClassVar[str] = REPEATABLE

    folder: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="DIR")]
    answers: tuple[Path, ...] = ()
    threads: int = 0

    def __post_init__(self) -> None:
        """Refuse a negative number of threads, and two folders of one name."""
        check_at_least(self, threads=0)
        names = [folder.resolve().name for folder in self.answers]
        if len({DIAGNOSIS, *names}) <= len(names):
            raise BadValueError(
                f"answers are named by their folders: {', '.join(names)} and "
                f"{DIAGNOSIS} must differ"
            )


def main(config: ConcealedScore) -> None:
    """Score the answers of the diagnosis and of every baseline that answered."""
    folder = config.folder
    truth = read_truth(folder)
    answers = {
        DIAGNOSIS: read_answers(folder / ANSWERS, list(truth.cases)),
        **read_baselines(folder, list(truth.cases)),
        **{
            others.resolve().name: read_answers(others, list(truth.cases))
            for others in config.answers
        },
    }
    oracles = consult_all(folder, truth.cases, answers, config.threads)
    score = score_of(truth, answers, oracles)
    score["provenance"] = provenance(VERB, config)
    answered = RunFolder(folder / ANSWERS)
    known = answered.has(PROVENANCE)
    by = Origin.of(answered.read_json(PROVENANCE), {}).commit if known else None
    score["answered_by"] = by
    write_text(folder / SCORE, json.dumps(score, indent=1) + "\n")
    with extra(FIGURE):
        draw_score(score, folder / FIGURE)
    score_report(score, FIGURE).write(folder, PAGE)
    print_table(*score_rows(score))
    if score["missing"]:
        print(f"Unanswered (counted as wrong): {', '.join(score['missing'])}")


def score_of(
    truth: Truth, answers: Answers, oracles: Mapping[str, Oracle]
) -> dict[str, Any]:
    """The scores of all methods, in the form of score.json.

    `answers` are by method and test case, "diagnosis" is one of the methods;
    `oracles` are fits of the true effects, by the names of the cases in which an effect
    that the diagnosis knows is hidden.
    """
    marks = {
        method: [
            mark(case, own.get(name), oracles.get(name), method)
            for name, case in truth.cases.items()
        ]
        for method, own in answers.items()
    }
    figures = {}
    for method, own in answers.items():
        missing = [name for name in truth.cases if name not in own]
        figures[method] = {"missing": missing, **measures(marks[method], truth.seed)}
    levels = {
        name: case_level(case, oracles.get(name)) for name, case in truth.cases.items()
    }
    return {
        "format": FORMAT,
        "set": truth.set,
        "seed": truth.seed,
        "truth_sha256": truth.sha256,
        "cases": len(truth.cases),
        "levels": {name: level for name, level in levels.items() if level},
        **figures.pop(DIAGNOSIS),
        "baselines": figures,
        "paired": {name: compared(marks[DIAGNOSIS], marks[name]) for name in figures},
    }


def consult_all(
    folder: Path, cases: Mapping[str, TrueCase], answers: Answers, threads: int
) -> dict[str, Oracle]:
    """Fits of the true effects (oracles) of all test cases with known hidden effects.

    None are made of effects that this version of the diagnosis does not know, or that
    replays do not show.
    Each is stored in the set's folder, and only computed again if an answer changed.
    The effects of all `answers` are replayed on the held-out recordings.
    """
    known = {name for name, kind in all_effects().items() if kind.replayed}
    named = {
        name: case
        for name, case in cases.items()
        if case.kind in NAMED_KINDS and all(one.name in known for one in case.effects)
    }
    found = {
        name: {m: each[name].effects for m, each in answers.items() if name in each}
        for name in named
    }
    kept = {name: _kept(folder, name, found[name]) for name in named}
    oracles = {name: oracle for name, oracle in kept.items() if oracle}
    missing = [name for name in named if name not in oracles]
    if not missing:
        return oracles
    with (
        progress("true structures", len(named), len(oracles)) as task,
        process_pool(threads, len(missing)) as pool,
    ):
        calls = {
            name: pool.submit(_consult, folder, named[name], found[name])
            for name in missing
        }
        for name, call in as_done(calls):
            oracles[name] = call.result()
            task.advance(oracles[name].level)
    return oracles


def _consult(
    folder: Path, case: TrueCase, found: Mapping[str, Sequence[Named]]
) -> Oracle:
    """Fit the true effects of a test case, and store the result at once."""
    oracle = consult(folder / CASES / case.name, case, found)
    write_text(_path(folder, case.name), oracle.to_json())
    return oracle


def _path(folder: Path, name: str) -> Path:
    return folder / ORACLE / f"{name}.json"


def _kept(
    folder: Path, name: str, asked: Mapping[str, Sequence[Named]]
) -> Oracle | None:
    """The stored oracle of a test case; None if there is none for the same answers."""
    path = _path(folder, name)
    if not path.is_file():
        return None
    oracle = Oracle.from_json(path.read_text())
    known = {method: key for method, (key, _) in oracle.answered.items()}
    same = all(known.get(m) == answer_key(found) for m, found in asked.items())
    return oracle if same else None


if __name__ == "__main__":
    run_verb(ConcealedScore, main)
