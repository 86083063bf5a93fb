from pathlib import Path

import pytest

from diagnosis.verdict import Verdict
from experiments import concealed_run
from experiments.concealed_run import ConcealedRun, answer_all
from groundwalk.errors import BadValueError, RunFolderError

ANSWERS = "answers"


def noted(case: Path, seed: int) -> Verdict:
    """A verdict that says which case and seed it is of."""
    return Verdict(kind="not_identifiable", limits=(f"{case.name}, seed {seed}",))


def broken(case: Path, seed: int) -> Verdict:
    raise BadValueError(f"{case.name} is broken")


@pytest.fixture
def folder(tmp_path):
    for number in range(3):
        (tmp_path / "cases" / f"case_{number:03d}").mkdir(parents=True)
    return tmp_path


def answers(folder):
    return {
        path.stem: Verdict.from_json(path.read_text()).limits
        for path in sorted((folder / ANSWERS).glob("*.json"))
    }


def test_every_case_gets_its_own_answer(folder):
    answer_all(folder, ANSWERS, noted, seed=5, threads=2)
    assert answers(folder) == {
        f"case_{number:03d}": (f"case_{number:03d}, seed 5",) for number in range(3)
    }


def test_an_answer_that_is_there_is_kept(folder, in_this_process):
    in_this_process(concealed_run)
    answer_all(folder, ANSWERS, noted, seed=5, threads=1)
    (folder / ANSWERS / "case_001.json").unlink()
    answer_all(folder, ANSWERS, noted, seed=6, threads=1)
    assert [text[0][-1] for text in answers(folder).values()] == ["5", "6", "5"]


def test_a_failure_is_raised_and_loses_no_answer(folder, in_this_process, monkeypatch):
    in_this_process(concealed_run)
    answer_all(folder, ANSWERS, noted, seed=5, threads=1)
    monkeypatch.undo()  # the failure is one in a process of its own
    (folder / ANSWERS / "case_002.json").unlink()
    with pytest.raises(BadValueError, match="case_002 is broken"):
        answer_all(folder, ANSWERS, broken, seed=5, threads=1)
    assert len(answers(folder)) == 2


def test_a_folder_without_cases_is_refused(tmp_path):
    with pytest.raises(RunFolderError, match="holds no cases"):
        ConcealedRun(tmp_path)


def test_a_negative_seed_is_refused(folder):
    with pytest.raises(BadValueError, match="negative"):
        ConcealedRun(folder, seed=-1)
