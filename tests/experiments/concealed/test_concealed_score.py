"""Tests `groundwalk concealed score` on made-up folders."""

import hashlib
import json

import pytest
from made_up_scores import DRY, KNEE, NOTHING, RIGHT, case, found, names

from experiments.concealed.score import ConcealedScore, main
from experiments.concealed.scoring.answers import Named
from experiments.concealed.scoring.oracle import Oracle, answer_key
from experiments.concealed.scoring.truth import read_truth
from groundwalk.errors import BadValueError, RunFolderError


def write_set(folder, cases, answers):
    truth = {
        "format": 1,
        "seed": 7,
        "cases": {
            one.name: {
                "plant": one.plant,
                "engine": one.engine,
                "kind": one.kind,
                "effects": [vars(effect) for effect in one.effects],
            }
            for one in cases
        },
    }
    content = json.dumps(truth)
    (folder / "sealed").mkdir(parents=True)
    (folder / "sealed" / "truth.json").write_text(content)
    digest = hashlib.sha256(content.encode()).hexdigest()
    (folder / "sealed.sha256").write_text(f"{digest}  sealed/truth.json\n")
    for where, verdicts in answers.items():
        (folder / where).mkdir(parents=True)
        for name, verdict in verdicts.items():
            (folder / where / f"{name}.json").write_text(verdict.to_json())
    return digest


CASES = (case(0, "single", DRY), case(1, "none"), case(2, "outside", DRY))


def keep_oracle(folder, name, **answers):
    kept = Oracle(
        250.0,
        5.0,
        1.0,
        {f"coulomb_friction@{KNEE}": {"torque": 0.0}},
        {method: (answer_key(v.effects), rms) for method, (v, rms) in answers.items()},
    )
    (folder / "oracle").mkdir()
    (folder / "oracle" / f"{name}.json").write_text(kept.to_json())


def test_a_set_is_scored_with_its_baselines_and_oracles_are_not_computed_twice(
    tmp_path, capsys
):
    ours, theirs = names(RIGHT), names(found("backlash", KNEE))
    digest = write_set(
        tmp_path,
        CASES,
        {
            "answers": {"case_000": ours, "case_001": NOTHING},
            "baselines/bic": {"case_000": theirs, "case_001": ours},
        },
    )
    keep_oracle(tmp_path, "case_000", diagnosis=(ours, 1.0), bic=(theirs, 5.0))
    code = {"commit": "abc", "changed": "", "python": "3", "packages": {}}
    code |= {"command": "groundwalk concealed run set"}
    (tmp_path / "answers" / "provenance.json").write_text(json.dumps(code))
    main(ConcealedScore(tmp_path, threads=1))  # there are no cases to compute it from
    score = json.loads((tmp_path / "score.json").read_text())
    assert score["truth_sha256"] == digest
    assert score["missing"] == ["case_002"]
    assert score["top1"]["L1"]["value"] == 1
    assert score["closed"]["closed"]["value"] == 1
    assert score["null_false_alarms"]["value"] == 0
    bic = score["baselines"]["bic"]
    assert (bic["top1"]["L1"]["value"], bic["null_false_alarms"]["value"]) == (0, 1)
    assert bic["closed"]["closed"]["value"] == 0
    assert (tmp_path / "score.png").stat().st_size > 1000
    page = (tmp_path / "score.md").read_text()
    assert "| right effect first, L1 | at least 0.9 | yes | 1.00" in page
    assert digest in page
    assert "seed 7" in page
    assert "diagnosed at commit abc" in page
    assert "unanswered by diagnosis (counted as wrong): case_002" in page
    assert "case_002" in capsys.readouterr().out


@pytest.mark.slow
def test_an_oracle_for_other_answers_is_not_believed(tmp_path):
    write_set(tmp_path, CASES, {"answers": {"case_000": names(RIGHT)}})
    keep_oracle(tmp_path, "case_000", diagnosis=(NOTHING, 1.0))
    with pytest.raises(RunFolderError, match=r"holds no case"):
        main(ConcealedScore(tmp_path, threads=1))


@pytest.mark.parametrize("change", [b'{"seed": 8}', b""])
def test_a_truth_that_was_changed_is_refused_in_one_line(tmp_path, change):
    write_set(tmp_path, CASES, {})
    assert read_truth(tmp_path).seed == 7
    (tmp_path / "sealed" / "truth.json").write_bytes(change)
    with pytest.raises(RunFolderError, match="is not what was sealed") as error:
        read_truth(tmp_path)
    assert "\n" not in str(error.value)


def test_folders_without_truth_hash_or_answers_are_refused(tmp_path):
    with pytest.raises(RunFolderError, match="concealed make"):
        read_truth(tmp_path)
    write_set(tmp_path / "set", CASES, {})
    with pytest.raises(RunFolderError, match="concealed run"):
        main(ConcealedScore(tmp_path / "set"))
    (tmp_path / "set" / "sealed.sha256").write_text("")
    with pytest.raises(RunFolderError, match="says nothing"):
        read_truth(tmp_path / "set")


def test_an_answer_that_cannot_be_read_is_named(tmp_path):
    write_set(tmp_path, CASES, {"answers": {}})
    (tmp_path / "answers" / "case_000.json").write_text("{")
    with pytest.raises(RunFolderError, match=r"case_000\.json: answer is not JSON"):
        main(ConcealedScore(tmp_path))


def test_other_tools_are_scored_beside_the_diagnosis(tmp_path, capsys):
    """An answer with nothing but what is asked for (docs/concealed_answers.md)."""
    theirs = names(found("backlash", KNEE))
    write_set(tmp_path / "set", CASES, {"answers": {"case_000": names(RIGHT)}})
    other = tmp_path / "their_tool"
    other.mkdir()
    plain = {
        "format": 1,
        "kind": "effects",
        "effects": [{"name": "backlash", "place": KNEE, "note": "ours"}],
        "version": "1.0",
    }
    (other / "case_000.json").write_text(json.dumps(plain))
    (other / "case_001.json").write_text('{"format": 1, "kind": "none"}')
    (other / "case_002.json").write_text('{"format": 1, "kind": "unknown"}')
    sides = {"diagnosis": (names(RIGHT), 1.0), "their_tool": (theirs, 5.0)}
    keep_oracle(tmp_path / "set", "case_000", **sides)
    path = tmp_path / "set" / "oracle" / "case_000.json"
    stored = json.loads(path.read_text())
    stored["answered"]["their_tool"][0] = answer_key([Named("backlash", KNEE)])
    path.write_text(json.dumps(stored))
    main(ConcealedScore(tmp_path / "set", answers=(other,), threads=1))
    score = json.loads((tmp_path / "set" / "score.json").read_text())
    them = score["baselines"]["their_tool"]
    assert them["missing"] == []
    assert them["right"]["value"] == pytest.approx(2 / 3)
    assert score["right"]["value"] == pytest.approx(1 / 3)
    paired = score["paired"]["their_tool"]["right"]
    assert (paired["n"], paired["only_ours"], paired["only_theirs"]) == (3, 1, 2)
    assert paired["p"] == 1.0
    page = (tmp_path / "set" / "score.md").read_text()
    assert "| their_tool | right as a whole, all cases | 3 | 1 | 2 | 1 |" in page
    with pytest.raises(RunFolderError, match="nowhere"):
        main(ConcealedScore(tmp_path / "set", answers=(tmp_path / "nowhere",)))


@pytest.mark.parametrize("folders", [("a/x", "b/x"), ("diagnosis",)])
def test_answers_of_one_name_are_refused(tmp_path, folders):
    with pytest.raises(BadValueError, match="must differ"):
        ConcealedScore(tmp_path, answers=tuple(tmp_path / one for one in folders))


def test_fewer_threads_than_none_are_refused(tmp_path):
    with pytest.raises(BadValueError, match="threads is -1"):
        ConcealedScore(tmp_path, threads=-1)
    assert ConcealedScore(tmp_path, threads=1).threads == 1
