"""Cases of set 2 as they are made: what they tell, and what their truth explains."""

import json
from dataclasses import replace

import numpy as np
import pytest
from made_once import made_once

from experiments.concealed import sets
from experiments.concealed.reading import read_case
from experiments.concealed.second import case as second
from experiments.concealed.second import motion as second_motion
from experiments.concealed.second.case import second_case
from experiments.concealed.second.plan import CasePlan
from experiments.concealed.size_by_information import level_of
from groundwalk.errors import GroundwalkError
from worlds import read_recording
from worlds.hidden import Hidden
from worlds.hidden.limbs import limb_plant
from worlds.hidden.run import Clock, run_hidden

SINGLE = CasePlan("single", "two_dof", 50, "servos", 2, True, "mujoco")
PLANS = {
    "single": SINGLE,
    "pair": replace(SINGLE, kind="pair", gains=1, reference=False),
    "none": replace(SINGLE, kind="none", drive="torques", reference=False),
}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A set of three short cases, as `make_case` writes them."""

    def make(folder):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(second_motion, "DURATION_S", (2.5, 3.0))
            patch.setattr(second, "planned", lambda seed, count: tuple(PLANS.values()))
            for number in range(3):
                sets.make_case(2, folder / "cases", folder / "truths", 5, number, 3)

    return made_once(tmp_path_factory, "second", make)


def truth_of(made, kind):
    number = list(PLANS).index(kind)
    path = made / "truths" / f"case_{number:03d}.json"
    return json.loads(path.read_text()), made / "cases" / f"case_{number:03d}"


@pytest.mark.slow
def test_the_truth_says_what_is_hidden_how_clearly_and_what_else_is_wrong(made):
    for kind, count in (("single", 1), ("pair", 2), ("none", 0)):
        truth, _ = truth_of(made, kind)
        assert truth["kind"] == kind
        assert len(truth["effects"]) == len(truth["nats"]) == count
        assert all(level_of(nats) and nats > 0 for nats in truth["nats"])
        names = [one["name"] for one in truth["nuisance"]]
        assert "time_jitter" in names
        assert "payload_mass" in names
        hidden = {(one["name"], one["place"]) for one in truth["effects"]}
        assert not hidden & {(one["name"], one["place"]) for one in truth["nuisance"]}


def test_recorded_times_are_even_and_two_gains_are_known(made):
    _, folder = truth_of(made, "single")
    paths = sorted((folder / "recordings").iterdir())
    gains = set()
    for path in paths:
        recording = read_recording(path)
        assert np.diff(recording.columns["time"]) == pytest.approx(0.02)
        gains.add(recording.metadata.servo["J1"].kp)
        told = recording.metadata.to_json()
        assert "payload" not in told
    assert max(gains) == pytest.approx(2 * min(gains))
    assert len(list((folder / "reference").iterdir())) == 2
    plant, traces, reference = read_case(folder)
    assert (len(traces), len(reference.traces)) == (4, 2)
    assert plant.joints == ("J1", "J2")


@pytest.mark.slow
def test_an_unknown_controller_leaves_positions_and_torques_only(made):
    _, folder = truth_of(made, "none")
    for path in sorted((folder / "recordings").iterdir()):
        recording = read_recording(path)
        assert set(recording.columns) == {
            *("time", "position.J1", "position.J2", "torque.J1", "torque.J2")
        }
        assert recording.metadata.servo == {}
    _, traces, _ = read_case(folder)
    assert all(trace.unheld for trace in traces)


@pytest.mark.parametrize("kind", ["single", "pair"])
def test_the_truth_alone_explains_the_recordings(made, kind):
    """A simulation of what the sealed file says follows the recordings, up to noise."""
    truth, folder = truth_of(made, kind)
    hidden = [Hidden(**one) for one in truth["effects"]]
    small = [one for one in truth["nuisance"] if one["name"] != "time_jitter"]
    masses = {
        one["place"]: one["parameters"]["mass"]
        for one in small
        if one["name"] == "payload_mass"
    }
    rest = [Hidden(**one) for one in small if one["name"] != "payload_mass"]
    for path in sorted((folder / "recordings").iterdir()):
        recording = read_recording(path)
        names = limb_plant(truth["plant"]).joints

        def table(quantity, names=names, recording=recording):
            columns = [recording.columns[f"{quantity}.{name}"] for name in names]
            return np.stack(columns, axis=1)

        command, read = table("command"), table("position")
        plant = limb_plant(truth["plant"])
        servo = recording.metadata.servo
        kp = np.array([servo[name].kp for name in names])
        kd = np.array([servo[name].kd for name in names])
        plant = replace(plant, kp_nm_rad=kp, kd_nm_s_rad=kd)
        ticks = np.arange(len(command)) * 80
        clock, nobody = Clock(0.00025, ticks, 0), np.random.SeedSequence(0)
        feed = lambda row, sense, command=command: command[row]  # noqa: E731

        def off(plant, effects, clock=clock, feed=feed, read=read, nobody=nobody):
            run = run_hidden(plant, effects, "mujoco", clock, feed, read[0], nobody)
            return np.sqrt(np.mean((run.encoder_rad - read)[25:] ** 2, axis=0))

        nominal = off(plant, [])
        fitted = off(plant.with_masses(masses), [*rest, *hidden])
        assert (fitted < 0.002).all()  # noise, resolution and jitter of the ticks
        assert fitted.sum() < 0.5 * nominal.sum()


def test_a_case_that_cannot_be_made_is_told(monkeypatch):
    monkeypatch.setattr(second._Maker, "run", lambda self: False)
    with pytest.raises(GroundwalkError, match="case 1 of seed 3"):
        second_case(3, 1, 5)
