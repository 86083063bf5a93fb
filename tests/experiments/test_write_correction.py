"""`groundwalk diagnose` leaves behind a sim that is right."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

import robots
import terrain
from diagnosis.corrected.sim import CorrectedSim
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.load import load_plant
from experiments.diagnose import write_correction
from experiments.runs.folder import RunFolder
from experiments.walking.evaluation import make_sim
from worlds import WorldOptions
from worlds.sim.world import SimWorld

WEAK = PlacedEffect("servo_gain", "LKneePitch", (0.5,))
PLAY = PlacedEffect("backlash", "LKneePitch", (0.03,))


def found(effects):
    """As much of a diagnosis as is written down."""
    plant = load_plant("nao", "fixed")
    return SimpleNamespace(
        verdict=SimpleNamespace(effects=effects),
        model=(PLAY, WEAK),
        given=(),
        nuisance=(),
        plant=plant,
        test=SimpleNamespace(traces=[SimpleNamespace(servo=plant.servo, unheld=False)]),
    )


def sim_of(correction):
    ground, seed = terrain.make("flat", seed=0), np.random.SeedSequence(0)
    options = WorldOptions(threads=1)
    return make_sim(robots.get("nao"), [ground], [seed], options, correction)


def test_what_was_found_is_written_and_can_be_walked_in(tmp_path):
    write_correction(RunFolder(tmp_path), found(["any"]))
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "corrected.xml"))
    nominal = load_plant("nao", "fixed").servo.kp_nm_rad
    gains = model.actuator_gainprm[:, 0] / nominal
    knee = model.actuator("LKneePitch").id
    assert gains[knee] == pytest.approx(0.5)
    assert np.delete(gains, knee) == pytest.approx(1.0)
    assert type(sim_of(tmp_path)) is CorrectedSim


def test_where_nothing_was_found_there_is_nothing_to_correct(tmp_path):
    write_correction(RunFolder(tmp_path), found([]))
    assert list(tmp_path.iterdir()) == []
    assert type(sim_of(None)) is SimWorld
