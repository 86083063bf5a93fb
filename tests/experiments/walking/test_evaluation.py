import json

import numpy as np
import pytest

import robots
from experiments.runs.folder import RunFolder
from experiments.walking.evaluation import Study, evaluate, keep, score
from experiments.walking.trials import TrialRules, Trials
from groundwalk.errors import BadValueError, UnknownNameError
from walk_engine import gaits
from worlds import End, read_recording

SHORT = TrialRules(limit_s=1.0, start_spread_rad=0.01)
TWO = {"start": gaits.get("start"), "fast": gaits.get("walk2014")}


def run(study, seed=1, gaits=TWO):
    return evaluate(study, robots.get("nao"), gaits, np.random.SeedSequence(seed))


@pytest.mark.parametrize("world", ["sim", "real"])
def test_gaits_walk_the_same_trials_and_repeat_bit_for_bit(world, tmp_path):
    study = Study(world, "lumps", trials=2, rules=SHORT)
    outcomes = run(study)
    alone = run(study, gaits={"fast": TWO["fast"]})
    np.testing.assert_array_equal(
        alone["fast"].trials.distance_m, outcomes["fast"].trials.distance_m
    )
    assert len(set(outcomes["start"].trials.distance_m)) == 2
    table = keep(RunFolder(tmp_path), world, outcomes)
    assert table["start"]["trials"] == 2
    recording = read_recording(tmp_path / "recordings" / f"{world}_start.parquet")
    assert recording.ticks == 100
    assert recording.metadata.world == world
    assert recording.metadata.terrain["name"] == "lumps"
    assert dict(recording.metadata.gait) == dict(TWO["start"])


def test_the_recording_is_the_first_trial():
    outcome = run(Study("sim", "flat", trials=2, rules=SHORT))["start"]
    x_m = outcome.recording.vector("base.position")[:, 0]
    last_m, distance_m = x_m[-1] - x_m[0], outcome.trials.distance_m[0]
    # the last row is what was measured before the last tick
    assert distance_m == pytest.approx(last_m, abs=0.01)
    assert distance_m != last_m


def test_another_seed_makes_other_trials():
    study = Study("sim", "flat", trials=1, rules=SHORT)
    first, second = run(study, 1), run(study, 2)
    assert first["start"].trials.distance_m != second["start"].trials.distance_m


def test_a_score_is_mean_spread_and_falls():
    trials = Trials(np.array([1.0, 2.0]), np.array([10.0, 10.0]), (End.NONE, End.FALL))
    summary = score(trials)
    assert summary.speed_cm_s == pytest.approx(15.0)
    assert summary.speed_std == pytest.approx(np.sqrt(50.0))  # n - 1
    assert (summary.falls, summary.trials) == (1, 2)


def test_impossible_studies_are_refused():
    with pytest.raises(UnknownNameError, match="did you mean 'real'"):
        Study("reel", "flat")
    with pytest.raises(BadValueError, match="trials is 0"):
        Study("sim", "flat", trials=0)


def test_a_study_in_a_corrected_sim_says_so(tmp_path):
    late = {"name": "command_latency", "place": "commands"}
    late["parameters"] = {"delay": 0.04}
    text = {"format": 1, "robot": "nao", "base": "fixed", "native": [late]}
    path = tmp_path / "corrected.json"
    path.write_text(json.dumps({**text, "per_tick": []}))
    found = run(Study("sim", "flat", 2, SHORT, correction=tmp_path))["start"]
    plain = run(Study("sim", "flat", 2, SHORT))["start"]
    assert found.score.speed_cm_s != plain.score.speed_cm_s
    assert found.recording.metadata.source.startswith("groundwalk, corrected sim world")
    assert plain.recording.metadata.source.startswith("groundwalk, sim world")
    with pytest.raises(BadValueError, match="only the sim can be corrected"):
        Study("real", "flat", correction=tmp_path)
