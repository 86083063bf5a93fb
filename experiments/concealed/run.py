"""`groundwalk concealed run`: diagnose every test case, without reading its truth."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
import tyro

from diagnosis import Verdict, diagnose
from diagnosis.baselines import BASELINES
from diagnosis.residuals.data_sets import affordable
from diagnosis.traces.split import split
from experiments.command_line import run_verb
from experiments.concealed.reading import ANSWERS, BASELINE_ANSWERS, CASES, read_case
from experiments.concealed.scoring.answers import Answer
from experiments.runs.folder import PROVENANCE, RunFolder, provenance
from experiments.runs.options import REPEATABLE, check_at_least
from experiments.runs.processes import as_done, process_pool
from experiments.runs.progress import progress
from groundwalk.blas import one_blas_thread
from groundwalk.errors import BadRecordingError, RunFolderError
from groundwalk.files import write_text

VERB = "concealed-run"


@dataclass(frozen=True)
class ConcealedRun:
    """Diagnose the test cases of a set; cases with an answer are not diagnosed again.

    Attributes:
      folder: folder of the set of cases.
      by: the method that answers: the diagnosis, or a baseline to compare it with.
      seed: the random numbers of a case depend on this seed and the case's name only.
      threads: number of cases at a time, each in its own process; 0 for one per core.
    """

    if_interrupted: ClassVar[str] = REPEATABLE

    folder: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="DIR")]
    by: Literal["diagnosis", "sysid", "bic", "ebic", "sparse"] = "diagnosis"
    seed: int = 1
    threads: int = 0

    def __post_init__(self) -> None:
        """Refuse a folder without test cases, and negative numbers."""
        if not (self.folder / CASES).is_dir():
            raise RunFolderError(f"{self.folder} holds no {CASES}: make them first")
        check_at_least(self, seed=0, threads=0)


def main(config: ConcealedRun) -> None:
    """Answer all test cases without an answer, and store the version of the code."""
    kind: str = ANSWERS
    answer: Answerer = diagnosed
    if config.by != "diagnosis":
        kind = f"{BASELINE_ANSWERS}/{config.by}"
        answer = partial(by_baseline, config.by)
    _note_code(config, kind)
    answer_all(config.folder, kind, answer, config.seed, config.threads)


def _note_code(config: ConcealedRun, kind: str) -> None:
    """Store the version of the code that answers, beside the answers.

    If there are older answers without a stored version, nothing is written, because it
    would seem to apply to these, too.
    """
    answers = RunFolder(config.folder / kind)
    missing, cases = unanswered(config.folder, kind), cases_of(config.folder)
    if missing and answers.has(PROVENANCE):
        answers.note_resumed()
    elif missing == cases:
        answers.write_json(PROVENANCE, provenance(VERB, config))


def unanswered(folder: Path, kind: str) -> list[Path]:
    """Folders of test cases of a set without an answer in the subfolder `kind`."""
    return [case for case in cases_of(folder) if not _path(folder, kind, case).exists()]


def cases_of(folder: Path) -> list[Path]:
    """Folders of the test cases in the folder of a set, in the order of their names."""
    return sorted(path for path in (folder / CASES).iterdir() if path.is_dir())


Answerer = Callable[[Path, int], Verdict | Answer]
"""A function that returns an answer for the folder of a test case and a seed."""


def answer_all(
    folder: Path, kind: str, answer: Answerer, seed: int, threads: int
) -> None:
    """Write the missing answers; a test case that fails does not stop the others.

    `kind` is the subfolder for the answers, such as "baselines/bic". The error of the
    first case that failed is raised once all others are done.
    """
    missing = unanswered(folder, kind)
    total = len(cases_of(folder))
    with (
        progress("cases diagnosed", total, done=total - len(missing)) as bar,
        process_pool(threads, len(missing)) as pool,
    ):
        calls = {case: pool.submit(answer, case, seed) for case in missing}
        failures: dict[str, BaseException] = {}
        for case, call in as_done(calls):
            failure = call.exception()
            if failure is None:
                write_text(_path(folder, kind, case), call.result().to_json())
                bar.advance(case.name)
            else:
                failures[case.name] = failure
    for name, failure in failures.items():
        failure.add_note(f"in {name}; without an answer: {', '.join(failures)}")
        raise failure


def diagnosed(case: Path, seed: int) -> Verdict | Answer:
    """The verdict on a test case, or that it refuses a recording.

    The seed and the case's number together are the seed of the random numbers.
    """
    own = np.random.SeedSequence([seed, int(case.name.split("_")[-1])])
    try:
        plant, traces, reference = read_case(case)
        return diagnose(plant, traces, own, reference=reference).verdict
    except BadRecordingError as error:
        return Answer("refused", limits=(str(error),))


@one_blas_thread
def by_baseline(name: str, case: Path, seed: int) -> Verdict | Answer:
    """A baseline's verdict, from what a diagnosis learns from, and the reference.

    That is all of a test case's recordings but the held-out ones, if they are not long.
    `seed` is not used: baselines draw no random numbers.
    """
    try:
        plant, traces, reference = read_case(case)
        parts = affordable(plant, split(traces))
        return BASELINES[name](plant, [*parts.fit, *parts.select], reference)
    except BadRecordingError as error:
        return Answer("refused", limits=(str(error),))


def _path(folder: Path, kind: str, case: Path) -> Path:
    return folder / kind / f"{case.name}.json"


if __name__ == "__main__":
    run_verb(ConcealedRun, main)
