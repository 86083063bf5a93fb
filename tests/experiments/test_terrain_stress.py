import dataclasses
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from made_once import made_once

import robots
import terrain
import worlds
from experiments.runs.folder import HISTORY, RESULT, RunFolder
from experiments.stress.families import (
    FAMILIES,
    FLAT,
    Place,
    leg_length_m,
)
from experiments.stress.walks import rules_of, walk_at
from experiments.terrain_stress import TerrainStress, main
from groundwalk.errors import BadValueError, UnknownNameError
from walk_engine import gaits

SMOKE = {
    "gaits": ("start",), "worlds": ("sim",), "families": ("stairs", "friction"),
    "rungs": 2, "trials": 2, "worst": 1, "threads": 1,
}  # fmt: skip
FILES = {
    HISTORY, RESULT, "result.md", "report.html", "terrain_stress.png",
    "terrain_stress_start.png", "worst_nao_sim_start.rrd",
}  # fmt: skip


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A small run that was not stopped."""

    def run(folder):
        main(TerrainStress(**SMOKE, out=folder / "whole", json=True))

    return RunFolder(made_once(tmp_path_factory, "stress", run) / "whole")


def test_a_small_run_writes_everything(whole):
    assert {path.name for path in whole.path.iterdir()} >= FILES
    curves = whole.read_json(RESULT)["curves"]
    assert [curve["family"] for curve in curves] == [FLAT, "stairs", "friction"]
    falls = [[rung["falls"] for rung in curve["rungs"]] for curve in curves]
    assert falls[0] == [0]
    assert falls[1] == [0, 2]
    half = curves[1]["half"]
    low, high = (rung["severity"] for rung in curves[1]["rungs"])
    assert half["beyond"] == ""
    assert half["severity"] == pytest.approx(np.sqrt(low * high), rel=0.02)
    assert curves[1]["rungs"][1]["causes"] == {"trip": 2}


def copy_of(folder, path):
    """A run's folder with nothing but what it was asked."""
    copy = RunFolder(path)
    for name in ("config.json", "provenance.json"):
        copy.write_json(name, folder.read_json(name))
    return copy


def test_a_run_does_not_go_on_with_another_gait(whole, tmp_path):
    other = copy_of(whole, tmp_path / "other")
    gait = dict(gaits.get("walk2014"))
    other.write_json(HISTORY, {"gaits": {"start": gait}, "cells": []})
    with pytest.raises(BadValueError, match="has changed"):
        main(TerrainStress(resume=other.path))


@pytest.mark.slow
def test_a_run_that_was_killed_goes_on_to_the_same_bits(whole, tmp_path):
    done = whole.read_json(HISTORY)
    killed = copy_of(whole, tmp_path / "killed")
    killed.write_json(HISTORY, {**done, "cells": done["cells"][:2]})
    main(TerrainStress(resume=killed.path, json=True, threads=2))
    assert killed.read_json(HISTORY) == done
    assert killed.read_json(RESULT) == whole.read_json(RESULT)


def test_the_worst_rollout_has_the_bits_of_its_trial(whole):
    worst = whole.read_json(RESULT)["worst"][0]
    cells = whole.read_json(HISTORY)["cells"]
    (path,) = (whole.path / "recordings").iterdir()
    recording = worlds.read_recording(path)
    assert recording.metadata.end == worst["end"] == "fall"
    assert recording.ticks == round(worst["time_s"] / worlds.TICK_S)
    trials = [trial for cell in cells for trial in cell["trials"]]
    assert {k: v for k, v in worst.items() if k not in ("file", "place")} in trials


def test_the_output_is_the_result_and_nothing_else(whole, tmp_path, capsys):
    again = shutil.copytree(whole.path, tmp_path / "again")
    main(TerrainStress(resume=again, json=True))
    assert json.loads(capsys.readouterr().out) == whole.read_json(RESULT)


@pytest.mark.slow
def test_trials_in_the_real_world_are_alone_as_together(monkeypatch):
    """Walks of 4 s lead a little beyond the flat start."""
    monkeypatch.setattr("experiments.stress.walks.LIMIT_PENDULUMS", 25.0)
    leg_m = leg_length_m(robots.get("nao"))
    place = Place("nao", "real", "lumps", 0.02 * leg_m)
    both, rows = {"start": gaits.get("start")}, [("start", 0), ("start", 1)]
    together = [trial for trial, _ in walk_at(place, both, rows, seed=3)]
    ((alone, _),) = walk_at(place, both, rows[1:], seed=3, threads=1)
    assert together[1] == alone


# Families


@pytest.mark.parametrize("name", FAMILIES)
def test_ladders_grow_with_the_leg_where_they_are_lengths(name):
    family = FAMILIES[name]
    ladder = family.severities(4, leg_m=0.25)
    assert len(ladder) == 4
    ratios = ladder[1:] / ladder[:-1]
    np.testing.assert_allclose(ratios, ratios[0])
    factor = 2.0 if family.unit == "m" else 1.0
    np.testing.assert_allclose(family.severities(4, leg_m=0.5), factor * ladder)


@pytest.mark.parametrize("name", FAMILIES)
def test_each_rung_is_ground_or_physics_that_differs(name):
    leg_m = 0.25
    usual = worlds.WorldOptions()
    mild, hard = (
        Place("nao", "sim", name, float(value))
        for value in FAMILIES[name].severities(2, leg_m)
    )
    grounds = [place.ground(leg_m, 1.0, seed=4).make() for place in (mild, hard)]
    if grounds[0].is_flat:
        assert mild.options(usual) != hard.options(usual) != usual
    else:
        assert mild.options(usual) == usual
        assert np.ptp(grounds[0].heights_m) < np.ptp(grounds[1].heights_m)
    for ground in grounds:
        assert ground.height_at(0.9 * leg_m, 0.0) == 0


def test_slopes_lead_where_they_say():
    leg_m, x_m, y_m = 0.25, 1.5, 0.5
    angle = 0.1
    for name, rise in (("slope_up", 1), ("slope_down", -1)):
        ground = Place("nao", "sim", name, angle).ground(leg_m, 1.0, 1).make()
        ahead = float(ground.height_at(x_m, 0.0) - ground.height_at(x_m - 0.5, 0.0))
        assert ahead == pytest.approx(rise * 0.5 * np.tan(angle), rel=1e-3)
    side = Place("nao", "sim", "slope_side", angle).ground(leg_m, 1.0, 1).make()
    assert side.height_at(x_m, y_m) == pytest.approx(y_m * np.tan(angle), rel=1e-3)


def test_softness_and_friction_reach_the_world():
    usual = worlds.WorldOptions()
    soft = Place("nao", "sim", "softness", 0.005).options(usual)
    assert soft == dataclasses.replace(usual, sinkage_m=0.005)
    icy = Place("nao", "sim", "friction", 0.1).options(usual)
    assert icy == dataclasses.replace(usual, friction=0.1)


def test_a_leg_is_from_hip_to_sole():
    # NAO H25: thigh 100 mm, tibia 102.9 mm, foot height 45.19 mm (Aldebaran)
    assert leg_length_m(robots.get("nao")) == pytest.approx(0.248, abs=2e-4)
    rules = rules_of(robots.get("nao"))
    assert rules.course_m == pytest.approx(1.984, abs=2e-3)
    assert rules.limit_s == pytest.approx(7.95, abs=0.02)


def test_grounds_of_a_place_are_terrain_that_recordings_can_name():
    spec = Place("nao", "sim", "lumps", 0.004).ground(0.25, 1.2, seed=9)
    again = terrain.TerrainSpec.from_json(spec.to_json()).make()
    np.testing.assert_array_equal(again.heights_m, spec.make().heights_m)


# What is refused


@pytest.mark.parametrize(
    "change",
    [
        {"gaits": ()}, {"worlds": ()}, {"families": ("lumps", "lumps")}, {"rungs": 1},
        {"trials": 0}, {"worst": -1}, {"seed": -1}, {"threads": -1},
    ],
)  # fmt: skip
def test_impossible_studies_are_refused(change):
    with pytest.raises(BadValueError):
        TerrainStress(**{"gaits": ("start",), **change})


@pytest.mark.parametrize(
    "change",
    [
        {"gaits": ("strat",)}, {"worlds": ("simm",)}, {"robots": ("noa",)},
        {"families": ("lump",)},
    ],
)  # fmt: skip
def test_unknown_names_are_refused(change):
    with pytest.raises(UnknownNameError):
        TerrainStress(**{"gaits": ("start",), **change})


def test_a_place_on_no_family_is_refused():
    with pytest.raises(UnknownNameError, match="lumps"):
        Place("nao", "sim", "lump", 0.01)


def test_the_documented_ladders_are_those_that_are_climbed():
    page = (Path(__file__).parents[2] / "docs" / "terrain_stress.md").read_text()
    rows = re.findall(r"^\| (`.*?`) \| .*? \| (.*?) \|", page, re.MULTILINE)
    told = {
        name: ladder for names, ladder in rows for name in re.findall("`(.*?)`", names)
    }
    assert set(told) == {*FAMILIES, FLAT}
    for name, family in FAMILIES.items():
        ends = np.array([float(n) for n in re.findall(r"\d+\.?\d*", told[name])])
        share = {"%": 0.01, "°": np.pi / 180}.get(
            re.sub(r"[\d. to]", "", told[name])[:1]
        )
        expected = family.mildest, family.hardest
        np.testing.assert_allclose(ends * (share or 1), expected, rtol=0.05)
