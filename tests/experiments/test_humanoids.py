"""Other humanoids: what limits them, the page's words, and a tiny run."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

import robots
import terrain
import worlds
from experiments.humanoid_study.facts import reach, saturation, sole
from experiments.humanoid_study.page import answer, robot_rows, why
from experiments.humanoids import Humanoids, main
from experiments.runs.gait_files import short_name
from experiments.walking.trials import TrialRules, walk_trials
from groundwalk.errors import GroundwalkError
from walk_engine import gaits
from worlds import Recording, RecordingMetadata

GAIT = gaits.get("start")


def of(falls=0, place_m=0.0, tilt_rad=0.0, joint="", share=0.0, motor="knee"):
    """A robot's result as the study writes it."""
    score = {"speed_cm_s": 20.0, "speed_std": 1.0, "falls": falls, "trials": 30}
    return {
        "mass_kg": 30.0,
        "scale": {"length": 2.0, "time": 1.4, "weight": 6.0},
        "sim": {"start": score, "tuned": score},
        "real": {key: {**score, "trials": 10} for key in ("start", "tuned")},
        "sole": {"length": 0.4, "width": 0.3},
        "reach": {"place_m": place_m, "tilt_rad": tilt_rad, "joint": joint},
        "saturation": {"share": share, "joint": motor if share else ""},
    }


@pytest.mark.parametrize("name", ["nao", "g1", "icub"])
def test_legs_that_reach_what_the_gait_asks(name):
    found = reach(robots.get(name), GAIT)
    assert found["place_m"] < 1e-6
    assert found["tilt_rad"] < 1e-6
    assert found["joint"] == ""


def test_ranges_that_keep_a_sole_from_level():
    """The crouch needs the ankle at -0.47 rad: with an end at -0.3 the sole tilts."""
    nao = robots.get("nao")
    ankle = nao.joints.index("LAnklePitch")
    stiff = replace(nao.links[ankle], range_rad=(-0.3, 0.9))
    links = (*nao.links[:ankle], stiff, *nao.links[ankle + 1 :])
    found = reach(replace(nao, links=links), GAIT)
    assert found["joint"] == "LAnklePitch"
    assert 0.1 < found["tilt_rad"] < 0.4
    assert found["place_m"] < 1e-6  # the foot's joint is at the ankle


def test_a_file_with_ranges_that_no_leg_can_have():
    found = reach(robots.get("simple_humanoid_as_is"), GAIT)
    assert found["tilt_rad"] > math.radians(20)
    assert reach(robots.get("simple_humanoid"), GAIT)["tilt_rad"] < 1e-6


def test_soles_for_a_size():
    """G1: 170 x 60 mm at 2.78 times the NAO, whose soles are 150 x 89 mm."""
    assert sole(robots.get("nao")) == {"length": 1.0, "width": 1.0}
    small = sole(robots.get("g1"))
    assert small["length"] == pytest.approx(0.17 / (2.779 * 0.1501), rel=1e-2)
    assert small["width"] == pytest.approx(0.06 / (2.779 * 0.0888), rel=1e-2)


def recording(description, command_rad):
    """Joints that rest at zero while commands are given: (ticks, joints)."""
    columns = {"time": 0.01 * np.arange(len(command_rad))}
    for k, name in enumerate(description.joints):
        columns[f"position.{name}"] = np.zeros(len(command_rad))
        columns[f"velocity.{name}"] = np.zeros(len(command_rad))
        columns[f"command.{name}"] = command_rad[:, k]
    metadata = RecordingMetadata(robot="nao", base="floating", source="made up")
    return Recording(columns, metadata)


def test_saturation_counts_full_drive():
    """The NAO's boards give all they can at an error of 0.13 rad."""
    nao = robots.get("nao")
    command = np.zeros((10, len(nao.joints)))
    assert saturation(nao, recording(nao, command)) == {"share": 0.0, "joint": ""}
    knee = nao.joints.index("RKneePitch")
    command[:4, knee], command[4:, knee] = 0.14, 0.12
    assert saturation(nao, recording(nao, command)) == {
        "share": 0.4,
        "joint": "RKneePitch",
    }


def test_the_answer_names_causes_only_where_there_are_falls():
    result = {"a": of(), "b": of(falls=30, tilt_rad=0.5, joint="ankle", place_m=0.08)}
    first, second = answer(result)
    assert first.startswith("1 of 2 walk 5 s")
    assert first.endswith(": a.")
    assert "b falls in 30 of 30 walks" in second
    assert "the range of ankle keeps a foot 80 mm away" in second
    assert "29 degrees" in second


def test_causes_by_their_measures():
    assert "is at its limit for 75%" in why(of(falls=3, share=0.75))
    assert "Neither" in why(of(falls=3, share=0.25))
    assert "40% as long and 30% as wide" in why(of(falls=3))
    assert next(answer({"a": of(falls=1)})).startswith("None of 1")


def test_rows_fit_their_headings():
    columns, rows = robot_rows({"a": of(), "b": of(share=0.2)})
    assert all(len(row) == len(columns) for row in rows)
    assert rows[1][-1] == "knee 20%"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"robots": ()}, "at least one robot"),
        ({"robots": ("g1", "g1")}, "none of them twice"),
        ({"robots": ("g2",)}, "unknown robot"),
        ({"population": 2}, "population"),
        ({"generations": 0}, "generations"),
        ({"trials": 0}, "trials"),
        ({"ratings": 0}, "ratings"),
        ({"seed": -1}, "seed"),
    ],
)
def test_what_no_run_can_do(options, message):
    with pytest.raises(GroundwalkError, match=message):
        Humanoids(**options)


def test_folders_of_files():
    assert short_name("g1") == "g1"
    assert short_name("my/robot.urdf") == "robot"
    _, (row,) = robot_rows({"my/robot.urdf": of()})
    assert row[0] == "robot"


def walked(name, limit_s):
    """One walk in the sim, with a gait with which iCub walks untuned."""
    calm = GAIT.replace(max_forward=0.12, step_period=0.2, com_offset=0.015)
    ground = terrain.make("flat", seed=0)
    world = worlds.make("sim", robots.get(name), [ground], [np.random.SeedSequence(0)])
    return walk_trials(world, [calm], TrialRules(limit_s=limit_s))


def test_icub_walks():
    trials = walked("icub", 2.0)
    assert trials.ended == (worlds.End.NONE,)
    assert trials.distance_m[0] > 0.15


def test_ranges_that_no_leg_can_have_make_a_robot_fall():
    assert walked("simple_humanoid_as_is", 4.0).ended == (worlds.End.FALL,)


@pytest.mark.slow
def test_a_tiny_run(tmp_path, capsys, monkeypatch):
    """Walks that end soon: where they lead to does not matter."""
    for name in ("WALK", "SEARCHED"):
        monkeypatch.setattr(f"experiments.humanoids.{name}", TrialRules(limit_s=0.6))
    out = tmp_path / "run"
    sizes = {"population": 4, "generations": 1, "ratings": 1, "trials": 1}
    sizes["real_trials"] = 1
    main(Humanoids(robots=("icub",), threads=1, out=out, **sizes))
    assert "icub" in capsys.readouterr().out
    result = json.loads((out / "result.json").read_text())
    assert result["icub"]["sim"]["tuned"]["trials"] == 1
    assert set(result["icub"]["gait"]) == set(GAIT)
    for name in (
        "result.md",
        "humanoids.png",
        "icub/recordings/sim_tuned.parquet",
    ):
        assert (out / name).stat().st_size > 1000
