import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis.plant.servo import Servo
from diagnosis.traces.split import split
from diagnosis.traces.trace import Trace
from diagnosis.verdict import Verdict
from experiments.concealed import run as concealed_run
from experiments.concealed.run import ConcealedRun, answer_all, main
from experiments.concealed.scoring.answers import read_answer
from experiments.concealed.scoring.truth import read_baselines
from groundwalk.errors import BadRecordingError, BadValueError, RunFolderError

ANSWERS = "answers"


def noted(case: Path, seed: int) -> Verdict:
    """A verdict whose text names its case and seed."""
    return Verdict(kind="not_identifiable", limits=(f"{case.name}, seed {seed}",))


def broken(case: Path, seed: int) -> Verdict:
    if case.name == "case_001":
        raise BadValueError(f"{case.name} is broken")
    return noted(case, seed)


def made_up_trace(name: str) -> Trace:
    time_s = np.arange(0.0, 4.0, 0.02)
    return Trace(name, time_s, np.sin(time_s)[:, None], Servo.ideal(1))


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
    answer_all(folder, ANSWERS, noted, seed=5, threads=1)
    (folder / ANSWERS / "case_001.json").unlink()
    answer_all(folder, ANSWERS, noted, seed=6, threads=1)
    assert [text[0][-1] for text in answers(folder).values()] == ["5", "6", "5"]


def test_a_failure_is_raised_and_loses_no_answer(folder):
    with pytest.raises(BadValueError, match="case_001 is broken") as raised:
        answer_all(folder, ANSWERS, broken, seed=5, threads=1)
    assert list(answers(folder)) == ["case_000", "case_002"]
    assert "without an answer: case_001" in str(raised.value.__notes__)


def test_a_baseline_answers_beside_the_diagnosis(folder, in_this_process, monkeypatch):
    """A baseline does not see the held-out recordings."""
    traces = [made_up_trace(name) for name in "abcdef"]
    healthy, plant = [made_up_trace("healthy")], SimpleNamespace(base="fixed")
    case = plant, traces, healthy
    monkeypatch.setattr(concealed_run, "read_case", lambda folder: case)
    seen = []

    def answer(plant, some, reference):
        assert reference == healthy
        seen.append(sorted(trace.name for trace in some))
        return Verdict("none")

    monkeypatch.setattr(concealed_run, "BASELINES", {"sparse": answer})
    main(ConcealedRun(folder, by="sparse", threads=1))
    parts = split(traces)
    learned = sorted(one.name for one in (*parts.fit, *parts.select))
    assert len(learned) < len(traces)
    assert seen == 3 * [learned]
    names = [f"case_{number:03d}" for number in range(3)]
    assert set(read_baselines(folder, names)["sparse"]) == set(names)
    assert not (folder / ANSWERS).exists()
    noted_code = json.loads((folder / "baselines/sparse/provenance.json").read_text())
    assert noted_code["packages"]["mujoco"] == "4.0.0"


@pytest.mark.parametrize("left", [0, 1])
def test_code_is_not_noted_beside_answers_of_unknown_code(
    folder, in_this_process, monkeypatch, left
):
    monkeypatch.setattr(concealed_run, "diagnosed", noted)
    answer_all(folder, ANSWERS, noted, seed=5, threads=1)
    for path in list((folder / ANSWERS).iterdir())[:left]:
        path.unlink()
    main(ConcealedRun(folder, threads=1))
    assert len(answers(folder)) == 3
    assert not (folder / ANSWERS / "provenance.json").exists()


def test_other_code_that_goes_on_is_noted_too(folder, in_this_process, monkeypatch):
    monkeypatch.setattr(concealed_run, "diagnosed", noted)
    main(ConcealedRun(folder, threads=1))
    path = folder / ANSWERS / "provenance.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"commit": "earlier"}))
    (folder / ANSWERS / "case_001.json").unlink()
    main(ConcealedRun(folder, threads=1))
    told = json.loads(path.read_text())
    assert told["commit"] == "earlier"
    assert len(told["resumed"]) == 1


@pytest.mark.parametrize("by", ["diagnosis", "bic"])
def test_recordings_that_are_refused_are_not_an_open_answer(
    folder, in_this_process, monkeypatch, by
):
    def refuse(case):
        raise BadRecordingError("the clock runs backwards")

    monkeypatch.setattr(concealed_run, "read_case", refuse)
    main(ConcealedRun(folder, by=by, threads=1))
    kind = "answers" if by == "diagnosis" else f"baselines/{by}"
    answer = read_answer((folder / kind / "case_000.json").read_text())
    assert answer.kind == "refused"
    assert answer.limits == ("the clock runs backwards",)


def test_a_folder_without_cases_is_refused(tmp_path):
    with pytest.raises(RunFolderError, match="holds no cases"):
        ConcealedRun(tmp_path)


def test_a_negative_seed_is_refused(folder):
    with pytest.raises(BadValueError, match="seed is -1"):
        ConcealedRun(folder, seed=-1)
